//! Baseline: the published single loop, one extended Kalman filter on the first-order model.
//!
//! phi' = -w x phi + eps(f) - M w and z = f + (1 + ka1).*(f x phi) + ka0 + ka1.*f + tho_i f_{i+1} - thp_i f_{i+2} with
//! f = C_nc f^n of the commanded motion, M_{i,i+1} = ds_i, M_{i,i+2} = -do_i. Discrete: phi <- exp(-[wT x]) phi + T exp(-[wT/2 x])(eps - M w)
//! with f at mid-step. The model is off by 3e-5 m/s^2 after 900 s, thirty times the noise, which alone makes the coefficients wrong by
//! per cents: kept to be compared with, not to be used. Cyclic triads only.

use nalgebra::{Matrix3, Vector3};

use super::carried::Carried;
use super::coefficients::{
    COUNT, Coefficients, FORCE_ABOUT_OUTPUT, FORCE_ABOUT_PENDULOUS, FORCE_BIAS, FORCE_SCALE, G_INPUT, G_OUTPUT, G_SPIN,
    GYRO_ABOUT_OUTPUT, GYRO_ABOUT_SPIN, GYRO_BIAS,
};
use super::estimator::{Estimator, Innovation};
use super::factor::Factor;
use super::record::Record;
use super::rotation::{apply, cross, exponential};
use super::window::commanded;
use crate::real::Real;

/// The first-order single loop.
///
/// # Example
/// ```
/// use stillrate::gimbal::{COUNT, DEFAULT_SCALE, Estimator, FirstOrder, Gauge, Model, Options, Record, Selection};
/// let selection = Selection::<30>::new(Gauge::Accelerometer, Options::default())?;
/// let estimator = Estimator::<f64, 30>::new(Model::new(9.8, 0.7)?, selection, &DEFAULT_SCALE, 0.0)?;
/// let filter = FirstOrder { estimator };
/// let (command, samples) = ([[0.01, 0.0, 0.0]; 8], [[0.0, 9.8, 0.0]; 41]);
/// let record = Record::new(&command, &samples, 0.25, 1e-6)?;
/// let mut state = filter.start(&[0.0; COUNT]);
/// let before = filter.standard_deviation(&state)[0];
/// let innovations = filter.epoch(&mut state, &record, 0);
/// assert!(innovations[2].value != 0.0); // told to tumble, it stood still: z should have felt gravity
/// assert!(filter.standard_deviation(&state)[0] < before); // and the tilt about x is known better
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstOrder<T, const N: usize> {
    /// Coefficients, scales and windows.
    pub estimator: Estimator<T, N>,
}

/// State of the first-order single loop: plain data, and a copy of it is another filter.
///
/// # Example
/// ```
/// # use stillrate::gimbal::{COUNT, DEFAULT_SCALE, Estimator, FirstOrder, Gauge, Model, Options, Selection};
/// # let selection = Selection::<30>::new(Gauge::Accelerometer, Options::default())?;
/// # let estimator = Estimator::<f64, 30>::new(Model::new(9.8, 0.7)?, selection, &DEFAULT_SCALE, 0.0)?;
/// let mut known = [0.0; COUNT];
/// known[21] = 1e-3; // an accelerometer bias from the data sheet
/// let state = FirstOrder { estimator }.start(&known);
/// assert_eq!((state.coefficients, state.commanded), (known, nalgebra::Matrix3::identity()));
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstOrderState<T, const N: usize> {
    /// Where the command alone would have turned the platform.
    pub commanded: Matrix3<f64>,
    /// Attitude error now and all coefficients.
    pub coefficients: Coefficients,
    /// Scaled square root of the covariance of attitude error at the start and coefficients.
    pub factor: Factor<T, N>,
    /// What became of errors of the start.
    pub carried: Carried<N>,
}

impl<T: Real, const N: usize> FirstOrder<T, N> {
    /// State before the first step.
    #[must_use]
    pub fn start(&self, prior: &Coefficients) -> FirstOrderState<T, N> {
        FirstOrderState {
            commanded: Matrix3::identity(),
            coefficients: *prior,
            factor: self.estimator.prior(),
            carried: Carried::unit(),
        }
    }

    /// Interval `k` (from 0) of a record and the measurement at its end; returns the innovations, m/s^2.
    pub fn epoch(&self, state: &mut FirstOrderState<T, N>, record: &Record<'_>, k: usize) -> [Innovation; 3] {
        let model = &self.estimator.model;
        let earth_rate = model.earth_rate();
        let dt_s = record.interval_s();
        let command = Vector3::from(record.command(k));
        self.advance(state, &command, dt_s);
        state.commanded = model.commanded_step(&state.commanded, &command, &earth_rate, dt_s);
        let measurement = commanded(model, record, k + 1, &state.commanded, &earth_rate, self.estimator.robust);
        let force = model.force(&state.commanded);
        if self.estimator.cuts(&force) {
            return [Innovation::default(); 3];
        }
        let x = state.coefficients;
        let tilt = cross(&force, &Vector3::new(x[0], x[1], x[2]));
        let skew = force.cross_matrix();
        let mut correction = [0.0; N];
        let mut innovations = [Innovation::default(); 3];
        for i in 0..3 {
            let (p, o) = (force[(i + 1) % 3], force[(i + 2) % 3]);
            let slope = 1.0 + x[FORCE_SCALE + i];
            let predicted = force[i]
                + slope * tilt[i]
                + x[FORCE_BIAS + i]
                + x[FORCE_SCALE + i] * force[i]
                + x[FORCE_ABOUT_OUTPUT + i] * p
                - x[FORCE_ABOUT_PENDULOUS + i] * o;
            let mut row = [0.0; COUNT];
            for c in 0..3 {
                row[c] = slope * skew[(i, c)];
            }
            row[FORCE_BIAS + i] = 1.0;
            row[FORCE_SCALE + i] = force[i] + tilt[i];
            row[FORCE_ABOUT_OUTPUT + i] = p;
            row[FORCE_ABOUT_PENDULOUS + i] = -o;
            let (residual, noise) = (measurement.value[i] - predicted, measurement.variance[i]);
            if noise.finite() && residual.finite() {
                let weight = 1.0 / noise.root();
                let row = self.estimator.row(&state.carried, &row, i, weight);
                let (value, variance) = Estimator::absorb(&mut state.factor, &row, residual * weight, &mut correction);
                innovations[i] = Innovation { value: value / weight, variance: variance * noise };
            }
        }
        let phi = self.estimator.attitude(&state.carried, &correction);
        for (x, phi) in state.coefficients.iter_mut().zip(&phi) {
            *x += phi;
        }
        self.estimator.add_to(&mut state.coefficients, &correction);
        innovations
    }

    fn advance(&self, state: &mut FirstOrderState<T, N>, command: &Vector3<f64>, dt_s: f64) {
        let model = &self.estimator.model;
        let transition = exponential(&(command * -dt_s));
        let half = exponential(&(command * (-0.5 * dt_s)));
        let force = apply(&half, &model.force(&state.commanded)) / model.gravity_m_s2;
        let weight = half * dt_s;
        let mut turning = [[0.0; 3]; COUNT];
        for i in 0..3 {
            let (o, s) = ((i + 1) % 3, (i + 2) % 3);
            let column = weight.data.0[i];
            let times = |factor: f64| column.map(|c| c * factor);
            turning[GYRO_BIAS + i] = column;
            turning[G_INPUT + i] = times(force[i]);
            turning[G_OUTPUT + i] = times(force[o]);
            turning[G_SPIN + i] = times(force[s]);
            turning[GYRO_ABOUT_OUTPUT + i] = times(command[s]);
            turning[GYRO_ABOUT_SPIN + i] = times(-command[o]);
        }
        let x = &mut state.coefficients;
        let mut phi = apply(&transition, &Vector3::new(x[0], x[1], x[2]));
        for (column, value) in turning.iter().zip(x.iter()).take(FORCE_BIAS).skip(GYRO_BIAS) {
            phi += Vector3::from(*column) * *value;
        }
        x[..3].copy_from_slice(phi.as_slice());
        self.estimator.carry(&mut state.factor, &mut state.carried, &transition, &turning, dt_s);
    }

    /// Standard deviations of attitude now and coefficients, SI; 0 where not estimated.
    #[must_use]
    pub fn standard_deviation(&self, state: &FirstOrderState<T, N>) -> Coefficients {
        self.estimator.standard_deviation_now(&state.factor, &state.carried)
    }
}
