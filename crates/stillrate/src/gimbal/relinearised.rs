//! Recursive Gauss-Newton: a linear Kalman filter about a fixed trajectory, restarted from the beginning with what it learned.
//!
//! About a linearisation (R_0, theta) the deviation d = (phi_0, theta - theta_lin) is constant and r = z - h(x_lin) - H d with
//! H = h_psi [Phi_t, B_t] + h_theta ([`Carried`]); its prior mean is always x_0 - x_lin: restarting uses no sample twice. After a pass
//! over the first t seconds the linearisation takes the estimate. Passes over 15, 30, 60, ... s, the whole record, and the whole record
//! again reach the Gauss-Newton solution. With angle random walk the same passes run with process noise: the deterministic path is
//! then only the point of linearisation, off by the walk (1e-6 rad), whose square is negligible. Source: our reconstruction of
//! DOI 10.3873/j.issn.1000-1328.2017.06.009.
//!
//! The last pass does not take d from the recursion, which carries it from x_0 - x_lin (of order one) to about zero and keeps the
//! rounding of the square root on the way (2.7e-4 of a prior deviation in `f32`, by the ratio of 4e3 between what the record determines
//! best and worst). It sums the gradient g = x_0 - x_lin + sum H^T r / R in double precision and takes d = P g: g is nearly zero, so the
//! rounding of P does not matter (4e-8 in `f32`).

use nalgebra::{Matrix3, Vector3};

use super::carried::Carried;
use super::coefficients::Coefficients;
use super::estimator::{Estimator, Innovation};
use super::factor::Factor;
use super::geometry::Geometry;
use super::linearisation::Linearisation;
use super::record::{Measurement, Record};
use super::rotation::{exponential, logarithm, product};
use super::window::{Reference, against_model, commanded, sampled_attitude};
use crate::real::Real;

/// In the last pass a residual beyond this many deviations is a window that too many spikes have spoilt, and is left out: the
/// trajectory is then so close that residuals are the noise alone.
pub const SPOILT_SIGMA: f64 = 6.0;
/// First pass, s; every further one is twice as long.
const FIRST_PASS_S: f64 = 15.0;

/// A pass under way: everything after `epoch` intervals. [`Relinearised::estimate`] says what it believes in.
///
/// # Example
/// ```
/// # use stillrate::gimbal::{COUNT, DEFAULT_SCALE, Estimator, Gauge, Model, Options, Record, Relinearised, Selection};
/// # let selection = Selection::<30>::new(Gauge::Accelerometer, Options::default())?;
/// # let method = Relinearised::new(Estimator::<f64, 30>::new(Model::new(9.8, 0.7)?, selection, &DEFAULT_SCALE, 0.0)?);
/// let (command, samples) = ([[0.0; 3]; 80], [[0.0, 9.8, 0.0]; 401]);
/// let record = Record::new(&command, &samples, 0.25, 1e-6)?;
/// let mut last = Vec::new();
/// method.run(&record, &[0.0; COUNT], |number, pass, _| {
///     last.resize(number + 1, 0);
///     last[number] = pass.epoch;
/// });
/// assert_eq!(last, [60, 80, 80]); // 15 s, the whole record, and the whole record again
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass<T, const N: usize> {
    /// The trajectory's attitude now.
    rotation: Matrix3<f64>,
    /// Where the command alone would have turned the platform.
    commanded: Matrix3<f64>,
    /// The point of linearisation, ready for use.
    geometry: Geometry,
    /// d in scaled numbers.
    deviation: [f64; N],
    /// Gradient in scaled numbers: prior mean and all residuals, each times its derivatives over its variance.
    gradient: [f64; N],
    /// Scaled square root of the covariance.
    factor: Factor<T, N>,
    /// What became of errors of the start.
    carried: Carried<N>,
    /// Intervals so far.
    pub epoch: usize,
    /// Residuals beyond this many deviations are left out.
    gate_sigma: f64,
    /// Take the estimate from the gradient.
    refined: bool,
}

/// Recursive Gauss-Newton.
///
/// # Example
/// ```
/// use stillrate::gimbal::{COUNT, DEFAULT_SCALE, Estimator, Gauge, Model, Options, Record, Relinearised, Selection};
/// let selection = Selection::<30>::new(Gauge::Accelerometer, Options::default())?;
/// let estimator = Estimator::<f64, 30>::new(Model::new(9.8, 0.7)?, selection, &DEFAULT_SCALE, 0.0)?;
/// let method = Relinearised::new(estimator);
/// let (command, samples) = ([[0.0; 3]; 60], [[0.0, 9.8, 0.0]; 301]);
/// let record = Record::new(&command, &samples, 0.25, 1e-6)?;
/// let mut drift = Vec::new();
/// let solution = method.run(&record, &[0.0; COUNT], |_, pass, _| {
///     drift.push((method.estimate(pass)[3], method.standard_deviation(pass)[3]));
/// });
/// // Told to stand still it stood still, to the last digit: against the turning Earth that takes a drift of gyro x.
/// assert!(drift[0].1 > drift[59].1 && solution.coefficients[3] == drift[drift.len() - 1].0);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relinearised<T, const N: usize> {
    /// Coefficients, scales and windows.
    pub estimator: Estimator<T, N>,
    /// Reference inside the windows after the first pass (the first always uses the commanded motion).
    pub reference: Reference,
}

/// Result of [`Relinearised::run`].
///
/// # Example
/// ```
/// # use stillrate::gimbal::{COUNT, DEFAULT_SCALE, Estimator, Gauge, Model, NAMES, Options, Record, Relinearised, Selection};
/// # let selection = Selection::<30>::new(Gauge::Accelerometer, Options::default())?;
/// # let method = Relinearised::new(Estimator::<f64, 30>::new(Model::new(9.8, 0.7)?, selection, &DEFAULT_SCALE, 0.0)?);
/// # let (command, samples) = ([[0.0; 3]; 60], [[0.0, 9.8, 0.0]; 301]);
/// let record = Record::new(&command, &samples, 0.25, 1e-6)?;
/// let solution = method.run(&record, &[0.0; COUNT], |_, _, _| {});
/// let held: Vec<_> = (0..33).filter(|&i| solution.deviation[i] == 0.0).map(|i| NAMES[i]).collect();
/// assert_eq!(held, ["thp_x", "tho_x", "tho_y"]); // by the gauge
/// assert!(!solution.diverged);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// All coefficients; attitude at the start of the record.
    pub coefficients: Coefficients,
    /// Their standard deviations, the attitude's at the start too; 0 where not estimated.
    pub deviation: Coefficients,
    /// Attitude deviation at the end of the last pass, rad.
    pub last_attitude: [f64; 3],
    /// Whether a pass lost its numbers; the coefficients are then those before it.
    pub diverged: bool,
}

impl<T: Real, const N: usize> Relinearised<T, N> {
    /// The recommended form: windows about the model from the second pass on.
    #[must_use]
    pub const fn new(estimator: Estimator<T, N>) -> Self {
        Self { estimator, reference: Reference::Model }
    }

    /// Deviation of the prior from a point of linearisation, and everything else a pass starts with.
    fn begin(&self, point: &Linearisation, prior: &Coefficients) -> Pass<T, N> {
        let estimator = &self.estimator;
        let scaled = estimator.scaled();
        let from = Linearisation::of(prior).rotation;
        let phi = -logarithm(&product(&from, &point.rotation.transpose()));
        let mut deviation = [0.0; N];
        for ((slot, &index), scale) in deviation.iter_mut().zip(estimator.selection.indices()).zip(scaled) {
            let difference = if index < 3 { phi[index] } else { prior[index] - point.coefficients[index] };
            *slot = difference / scale;
        }
        Pass {
            rotation: point.rotation,
            commanded: Matrix3::identity(),
            geometry: Geometry::new(&estimator.model, &point.coefficients),
            deviation,
            gradient: deviation,
            factor: estimator.prior(),
            carried: Carried::unit(),
            epoch: 0,
            gate_sigma: f64::INFINITY,
            refined: false,
        }
    }

    /// One interval of a pass and the measurement at its end.
    #[inline(always)]
    fn step(&self, pass: &mut Pass<T, N>, record: &Record<'_>, reference: Reference) -> [Innovation; 3] {
        let estimator = &self.estimator;
        let model = &estimator.model;
        let (k, dt_s) = (pass.epoch, record.interval_s());
        let command = Vector3::from(record.command(k));
        let step = pass.geometry.step(model, &pass.rotation, &command, dt_s);
        let turning = pass.geometry.turning(model, &step, &command, dt_s);
        estimator.carry(&mut pass.factor, &mut pass.carried, &step.transition, &turning, dt_s);
        pass.rotation = step.rotation;
        pass.epoch = k + 1;

        let attitude = sampled_attitude(&pass.geometry, model, &pass.rotation, &command);
        let force = model.force(&attitude);
        let force_rate = pass.geometry.force_rate(model, &attitude, &step.rate);
        let measured = match reference {
            Reference::Model => against_model(&pass.geometry, model, record, k + 1, &pass.rotation, estimator.robust),
            Reference::Commanded => {
                let earth_rate = pass.geometry.earth_rate;
                pass.commanded = model.commanded_step(&pass.commanded, &command, &earth_rate, dt_s);
                commanded(model, record, k + 1, &pass.commanded, &earth_rate, estimator.robust)
            }
        };
        let measured = if estimator.cuts(&force) { Measurement::NONE } else { measured };
        let mut innovations = [Innovation::default(); 3];
        for axis in 0..3 {
            let (predicted, row) = pass.geometry.output_row(axis, &force, &force_rate);
            let known = if reference == Reference::Model { 0.0 } else { predicted };
            let residual = measured.value[axis] - known;
            let noise = measured.variance[axis];
            let spoilt = residual * residual > pass.gate_sigma * pass.gate_sigma * noise;
            if noise > 0.0 && noise.finite() && residual.finite() && !spoilt {
                let weight = 1.0 / noise.root();
                let row = estimator.row(&pass.carried, &row, axis, weight);
                for (g, h) in pass.gradient.iter_mut().zip(&row) {
                    *g += h * (residual * weight);
                }
                let (value, variance) =
                    Estimator::absorb(&mut pass.factor, &row, residual * weight, &mut pass.deviation);
                innovations[axis] = Innovation { value: value / weight, variance: variance * noise };
            }
        }
        innovations
    }

    /// The deviation that a pass believes in now.
    fn found(pass: &Pass<T, N>) -> [f64; N] {
        if pass.refined { pass.factor.weigh(&pass.gradient) } else { pass.deviation }
    }

    /// Coefficients that a pass believes in now, SI; the attitude entries hold the deviation from the trajectory, rad.
    #[must_use]
    pub fn estimate(&self, pass: &Pass<T, N>) -> Coefficients {
        let mut estimate = pass.geometry.coefficients;
        let found = Self::found(pass);
        self.estimator.add_to(&mut estimate, &found);
        estimate[..3].copy_from_slice(self.estimator.attitude(&pass.carried, &found).as_slice());
        estimate
    }

    /// Standard deviations of the attitude now and of the coefficients, SI; 0 where not estimated.
    #[must_use]
    pub fn standard_deviation(&self, pass: &Pass<T, N>) -> Coefficients {
        self.estimator.standard_deviation_now(&pass.factor, &pass.carried)
    }

    /// The next point of linearisation after a pass that started at `point`.
    fn relinearise(&self, point: &Linearisation, pass: &Pass<T, N>) -> Linearisation {
        let scaled = self.estimator.scaled();
        let found = Self::found(pass);
        let start = Vector3::new(found[0] * scaled[0], found[1] * scaled[1], found[2] * scaled[2]);
        let mut coefficients = self.estimate(pass);
        coefficients[..3].copy_from_slice(&[0.0; 3]);
        Linearisation { rotation: product(&exponential(&-start), &point.rotation), coefficients }
    }

    /// All passes over a record. `observe(pass number, pass, innovations)` is called after every epoch.
    #[inline(always)]
    pub fn run(
        &self,
        record: &Record<'_>,
        prior: &Coefficients,
        mut observe: impl FnMut(usize, &Pass<T, N>, &[Innovation; 3]),
    ) -> Solution {
        let total = record.epochs();
        let mut point = Linearisation::of(prior);
        let mut solution = Solution {
            coefficients: *prior,
            deviation: self.estimator.standard_deviation(&self.estimator.prior()),
            last_attitude: [0.0; 3],
            diverged: false,
        };
        let mut until_s = FIRST_PASS_S;
        let mut number = 0;
        let mut whole = 0;
        while whole < 2 {
            let wanted = (until_s / record.interval_s() + 0.5) as usize;
            let until = if wanted < total { wanted.max(1) } else { total };
            whole += usize::from(until == total);
            let reference = if number == 0 { Reference::Commanded } else { self.reference };
            let mut pass = self.begin(&point, prior);
            // With angle random walk the residuals against one fixed trajectory are not the noise alone, and the gradient no plain sum.
            if whole == 2 && self.estimator.attitude_walk == 0.0 {
                pass.refined = true;
                if self.estimator.robust && reference == Reference::Model {
                    pass.gate_sigma = SPOILT_SIGMA;
                }
            }
            while pass.epoch < until {
                let innovations = self.step(&mut pass, record, reference);
                observe(number, &pass, &innovations);
            }
            if !(pass.factor.finite() && pass.deviation.iter().chain(&pass.gradient).all(|d| d.finite())) {
                solution.diverged = true;
                break;
            }
            point = self.relinearise(&point, &pass);
            solution.coefficients = point.coefficients();
            solution.deviation = self.estimator.standard_deviation(&pass.factor);
            let found = self.estimate(&pass);
            solution.last_attitude = [found[0], found[1], found[2]];
            until_s *= 2.0;
            number += 1;
        }
        solution
    }
}
