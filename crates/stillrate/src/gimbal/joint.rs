//! Joint on-line filter: attitude and all coefficients in one error-state Kalman filter on the exact model.
//!
//! Each epoch is linearised once, about the prediction; the three accelerometers are taken in one after the other with the residual and row of
//! that prediction, and the correction is applied once: R <- exp(-[dpsi x]) R, coefficients by addition. The bilinear terms that a
//! linearisation leaves out act as noise of about g tr P_psipsi; inflating R_k = R + c2 (g tr P_psipsi)^2 with c2 = 5 keeps the filter
//! honest while it is still far off (c2 = 0: errors up to 38 times the bound). Source: our reconstruction of
//! DOI 10.3873/j.issn.1000-1328.2017.06.009.

use nalgebra::{Matrix3, Vector3};

use super::carried::Carried;
use super::coefficients::Coefficients;
use super::estimator::{Estimator, Innovation};
use super::factor::Factor;
use super::geometry::Geometry;
use super::record::{Measurement, Record};
use super::rotation::{exponential, logarithm, product};
use super::window::{Reference, against_model, commanded, sampled_attitude};
use crate::error::{ConfigError, not_negative, positive};
use crate::filter::Flags;
use crate::real::Real;

/// Default weight c2 of the second-order terms.
pub const SECOND_ORDER: f64 = 5.0;
/// Default limit of a believable command, rad/s; nobody means more in a calibration.
pub const COMMAND_MAX_RAD_S: f64 = 10.0;
/// While the command is not known the attitude may turn away by this rate, rad/s.
const LOST_COMMAND_RAD_S: f64 = 1e-3;

/// Settings of the on-line filter.
///
/// # Example
/// As the samples come:
/// ```
/// use stillrate::Flags;
/// use stillrate::gimbal::{COUNT, DEFAULT_SCALE, Estimator, Gauge, JointFilter, Measurement, Model, Options, SECOND_ORDER, Selection};
/// let selection = Selection::<30>::new(Gauge::Accelerometer, Options::default())?;
/// let estimator = Estimator::<f64, 30>::new(Model::new(9.8, 0.7)?, selection, &DEFAULT_SCALE, 0.0)?;
/// let filter = JointFilter::new(estimator, SECOND_ORDER)?.with_command_max(0.1)?;
/// let mut state = filter.start(&[0.0; COUNT]);
/// assert_eq!(filter.advance(&mut state, [0.0175, 0.0, 0.0], 0.25), Flags::NONE);
/// assert_eq!(filter.advance(&mut state, [1e9, 0.0, 0.0], 0.25), Flags::OUT_OF_RANGE); // the last good command goes on
/// filter.correct(&mut state, &Measurement { value: [0.01, 9.8, -0.085], variance: [2e-13; 3] });
/// assert!(filter.attitude_and_coefficients(&state)[0].abs() < filter.standard_deviation(&state)[0] * 5.0);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
/// From a record, with lines through the samples around each epoch:
/// ```
/// # use stillrate::gimbal::{COUNT, DEFAULT_SCALE, Estimator, Gauge, JointFilter, Model, Options, Record, Reference, Selection};
/// # let selection = Selection::<30>::new(Gauge::Accelerometer, Options::default())?;
/// # let estimator = Estimator::<f64, 30>::new(Model::new(9.8, 0.7)?, selection, &DEFAULT_SCALE, 0.0)?;
/// # let filter = JointFilter::new(estimator, 5.0)?;
/// # let mut state = filter.start(&[0.0; COUNT]);
/// let (command, samples) = ([[0.0; 3]; 8], [[0.0, 9.8, 0.0]; 41]);
/// let record = Record::new(&command, &samples, 0.25, 1e-6)?;
/// for k in 0..record.epochs() {
///     filter.epoch(&mut state, &record, k, Reference::Model);
/// }
/// assert_eq!(state.time_s, 2.0);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFilter<T, const N: usize> {
    /// Coefficients, scales and windows.
    pub estimator: Estimator<T, N>,
    /// Weight c2 of the second-order terms in the measurement noise.
    second_order: f64,
    /// A command beyond this is not believed, rad/s.
    command_max_rad_s: f64,
}

/// State of the on-line filter: plain data, and a copy of it goes on with the same bits.
///
/// # Example
/// ```
/// # use stillrate::gimbal::{COUNT, DEFAULT_SCALE, Estimator, Gauge, JointFilter, Model, Options, Selection};
/// # let selection = Selection::<30>::new(Gauge::Accelerometer, Options::default())?;
/// # let estimator = Estimator::<f32, 30>::new(Model::new(9.8, 0.7)?, selection, &DEFAULT_SCALE, 0.0)?;
/// # let filter = JointFilter::new(estimator, 5.0)?;
/// let mut state = filter.start(&[0.0; COUNT]);
/// let mut saved = state;
/// filter.advance(&mut state, [0.02, 0.0, 0.0], 0.25);
/// filter.advance(&mut saved, [0.02, 0.0, 0.0], 0.25);
/// assert_eq!(state, saved);
/// assert!((state.rate[0] - 0.02).abs() < 1e-15); // no drift is known, so the platform turns as told
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointState<T, const N: usize> {
    /// R = C_np now.
    pub rotation: Matrix3<f64>,
    /// Where the command alone would have turned the platform.
    pub commanded: Matrix3<f64>,
    /// All coefficients; the attitude entries are not used.
    pub coefficients: Coefficients,
    /// Scaled square root of the covariance of attitude at the start and coefficients.
    pub factor: Factor<T, N>,
    /// What became of errors of the start.
    pub carried: Carried<N>,
    /// Last believed command, rad/s.
    pub command: Vector3<f64>,
    /// Platform rate of the last step, rad/s.
    pub rate: Vector3<f64>,
    /// Time since the start, s.
    pub time_s: f64,
}

impl<T: Real, const N: usize> JointFilter<T, N> {
    /// Filter with the given weight of the second-order terms (5 is the best of those tried, 0 the plain extended filter).
    ///
    /// # Errors
    /// [`ConfigError`] if it is negative.
    pub fn new(estimator: Estimator<T, N>, second_order: f64) -> Result<Self, ConfigError> {
        not_negative("second_order", second_order, "")?;
        Ok(Self { estimator, second_order, command_max_rad_s: COMMAND_MAX_RAD_S })
    }

    /// The same with another limit of a believable command.
    ///
    /// # Errors
    /// [`ConfigError`] if it is not positive.
    pub fn with_command_max(mut self, limit_rad_s: f64) -> Result<Self, ConfigError> {
        self.command_max_rad_s = positive("command_max_rad_s", limit_rad_s, "rad/s")?;
        Ok(self)
    }

    /// State before the first step: attitude exp(-[phi x]) and the prior coefficients.
    #[must_use]
    pub fn start(&self, prior: &Coefficients) -> JointState<T, N> {
        JointState {
            rotation: exponential(&Vector3::new(-prior[0], -prior[1], -prior[2])),
            commanded: Matrix3::identity(),
            coefficients: *prior,
            factor: self.estimator.prior(),
            carried: Carried::unit(),
            command: Vector3::zeros(),
            rate: Vector3::zeros(),
            time_s: 0.0,
        }
    }

    /// Carries the state over `dt_s` seconds under a command (rad/s). A command that is not finite or beyond the limit is replaced by the last
    /// good one and the attitude is believed less; an unusable time step passes no time.
    pub fn advance(&self, state: &mut JointState<T, N>, command: [f64; 3], dt_s: f64) -> Flags {
        let geometry = Geometry::new(&self.estimator.model, &state.coefficients);
        self.advance_by(state, &geometry, command, dt_s)
    }

    #[inline(always)]
    fn advance_by(&self, state: &mut JointState<T, N>, geometry: &Geometry, command: [f64; 3], dt_s: f64) -> Flags {
        if !(dt_s.finite() && dt_s > 0.0) {
            return Flags::BAD_TIME;
        }
        let finite = command.iter().all(|w| w.finite());
        let known = command.iter().all(|w| w.magnitude() <= self.command_max_rad_s);
        if known {
            state.command = Vector3::from(command);
        }
        let estimator = &self.estimator;
        let step = geometry.step(&estimator.model, &state.rotation, &state.command, dt_s);
        let turning = geometry.turning(&estimator.model, &step, &state.command, dt_s);
        estimator.carry(&mut state.factor, &mut state.carried, &step.transition, &turning, dt_s);
        if !known {
            estimator.spread(&mut state.factor, LOST_COMMAND_RAD_S * dt_s);
        }
        state.commanded = estimator.model.commanded_step(&state.commanded, &state.command, &geometry.earth_rate, dt_s);
        state.rotation = step.rotation;
        state.rate = step.rate;
        state.time_s += dt_s;
        Flags::MISSING.when(!finite).with(Flags::OUT_OF_RANGE.when(finite && !known))
    }

    /// Takes in one measurement of the outputs (m/s^2); an axis that is not finite or beyond twice gravity is left out.
    pub fn correct(&self, state: &mut JointState<T, N>, measurement: &Measurement) -> [Innovation; 3] {
        let geometry = Geometry::new(&self.estimator.model, &state.coefficients);
        let limit = 2.0 * self.estimator.model.gravity_m_s2;
        let mut believed = *measurement;
        for (value, variance) in believed.value.iter().zip(&mut believed.variance) {
            if !(value.magnitude() <= limit) {
                *variance = f64::INFINITY;
            }
        }
        self.correct_by(state, &geometry, &believed, false)
    }

    #[inline(always)]
    fn correct_by(
        &self,
        state: &mut JointState<T, N>,
        geometry: &Geometry,
        measurement: &Measurement,
        is_residual: bool,
    ) -> [Innovation; 3] {
        let estimator = &self.estimator;
        let model = &estimator.model;
        let attitude = sampled_attitude(geometry, model, &state.rotation, &state.command);
        let force = model.force(&attitude);
        if estimator.cuts(&force) {
            return [Innovation::default(); 3];
        }
        let force_rate = geometry.force_rate(model, &attitude, &state.rate);
        let [x, y, z] = estimator.attitude_variance(&state.factor, &state.carried);
        let second = model.gravity_m_s2 * (x + y + z);
        let inflation = self.second_order * second * second;
        let mut correction = [0.0; N];
        let mut innovations = [Innovation::default(); 3];
        for axis in 0..3 {
            let (predicted, row) = geometry.output_row(axis, &force, &force_rate);
            let residual = measurement.value[axis] - if is_residual { 0.0 } else { predicted };
            let noise = measurement.variance[axis] + inflation;
            if noise > 0.0 && noise.finite() && residual.finite() {
                let weight = 1.0 / noise.root();
                let row = estimator.row(&state.carried, &row, axis, weight);
                let (value, variance) = Estimator::absorb(&mut state.factor, &row, residual * weight, &mut correction);
                innovations[axis] = Innovation { value: value / weight, variance: variance * noise };
            }
        }
        self.apply(state, &correction);
        innovations
    }

    /// Attitude by rotation, coefficients by addition; a correction that is not finite is refused.
    #[inline(always)]
    fn apply(&self, state: &mut JointState<T, N>, correction: &[f64; N]) {
        let estimator = &self.estimator;
        if !correction.iter().all(|c| c.finite()) {
            state.factor = estimator.prior();
            state.carried = Carried::unit();
            return;
        }
        let psi = estimator.attitude(&state.carried, correction);
        state.rotation = product(&exponential(&-psi), &state.rotation);
        estimator.add_to(&mut state.coefficients, correction);
    }

    /// Standard deviations of attitude now and coefficients, SI; 0 where not estimated.
    #[must_use]
    pub fn standard_deviation(&self, state: &JointState<T, N>) -> Coefficients {
        self.estimator.standard_deviation_now(&state.factor, &state.carried)
    }

    /// The coefficients with the attitude filled in: rotation from the commanded to the true platform frame, rad.
    #[must_use]
    pub fn attitude_and_coefficients(&self, state: &JointState<T, N>) -> Coefficients {
        let mut all = state.coefficients;
        let phi = -logarithm(&product(&state.rotation, &state.commanded.transpose()));
        all[..3].copy_from_slice(phi.as_slice());
        all
    }

    /// Interval `k` of a record and the measurement at its end, with the chosen reference inside the window. With windows the result
    /// of epoch k + 1 is known half a window after it.
    #[inline(always)]
    pub fn epoch(
        &self,
        state: &mut JointState<T, N>,
        record: &Record<'_>,
        k: usize,
        reference: Reference,
    ) -> [Innovation; 3] {
        let estimator = &self.estimator;
        // Prediction leaves the coefficients as they are: one geometry serves both halves of the epoch.
        let geometry = Geometry::new(&estimator.model, &state.coefficients);
        let _ = self.advance_by(state, &geometry, record.command(k), record.interval_s());
        match reference {
            Reference::Commanded => {
                let measurement = commanded(
                    &estimator.model,
                    record,
                    k + 1,
                    &state.commanded,
                    &geometry.earth_rate,
                    estimator.robust,
                );
                self.correct_by(state, &geometry, &measurement, false)
            }
            Reference::Model => {
                let residual =
                    against_model(&geometry, &estimator.model, record, k + 1, &state.rotation, estimator.robust);
                self.correct_by(state, &geometry, &residual, true)
            }
        }
    }
}
