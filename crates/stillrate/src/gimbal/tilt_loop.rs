//! Second loop of the two-loop filter: attitude and gyro coefficients from the tilt of the found specific force.
//!
//! The norm loop gives f_e; its east and north components after turning it back, R^T (f_e - R f^n), are the tilt error (the
//! vertical one carries none). Prediction 0, H = rows N, E of R^T [f x]; R_i = Rv + 5 (g tr P_phiphi)^2 + 30 [R^T D P_A D^T R]_ii, the last
//! term for the uncertainty of the norm loop in the cascade. The two-stage form runs the norm loop over the whole record first and leaves that term
//! out. 9 + 21 states in place of 30, and about twice the error of the joint filter. Source: our
//! reconstruction of DOI 10.3873/j.issn.1000-1328.2017.06.009.

use nalgebra::{Matrix3, Vector3};

use super::carried::Carried;
use super::coefficients::{COUNT, Coefficients, FORCE_BIAS};
use super::estimator::Estimator;
use super::factor::Factor;
use super::geometry::Geometry;
use super::joint::SECOND_ORDER;
use super::model::Model;
use super::norm_loop::{NormLoop, NormState};
use super::record::{Measurement, Record};
use super::rotation::{exponential, product};
use super::selection::Selection;
use super::window::commanded;
use crate::error::ConfigError;
use crate::real::Real;

/// How many numbers the tilt loop has: three angles and eighteen gyro coefficients.
pub const TILT_COUNT: usize = 21;
/// Weight of the norm loop's uncertainty in the cascade.
const CASCADE: f64 = 30.0;

/// The two-loop filter: norm loop and tilt loop.
///
/// # Example
/// ```
/// use stillrate::gimbal::{COUNT, DEFAULT_SCALE, Model, Record, TwoLoop};
/// let two = TwoLoop::<f64>::new(Model::new(9.8, 0.7)?, &DEFAULT_SCALE)?.with_plain_windows();
/// let (command, samples) = ([[0.01, 0.0, 0.0]; 8], [[0.0, 9.8, 0.0]; 41]);
/// let record = Record::new(&command, &samples, 0.25, 1e-6)?;
/// let mut epochs = 0;
/// let (_, on_line) = two.cascade(&record, &[0.0; COUNT], |k, _| epochs = k);
/// let (_, afterwards) = two.two_stage(&record, &[0.0; COUNT], |_, _| {});
/// assert_eq!(epochs, 8);
/// assert!(afterwards[3] < on_line[3]); // the cascade doubts what the norm loop has not yet found
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoLoop<T> {
    /// Loop for the accelerometers.
    norm: NormLoop<T>,
    /// Scales and selection of the tilt loop.
    tilt: Estimator<T, TILT_COUNT>,
}

/// State of the tilt loop.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TiltState<T> {
    /// R = C_np.
    rotation: Matrix3<f64>,
    /// Where the command alone would have turned the platform.
    commanded: Matrix3<f64>,
    /// Coefficients; this loop changes those of the gyros.
    coefficients: Coefficients,
    /// Scaled square root of the covariance of attitude at the start and coefficients.
    factor: Factor<T, TILT_COUNT>,
    /// What became of errors of the start.
    carried: Carried<TILT_COUNT>,
}

impl<T: Real> TwoLoop<T> {
    /// Both loops with the same prior standard deviations.
    ///
    /// # Errors
    /// [`ConfigError`] if a scale is not positive.
    pub fn new(model: Model, scale: &Coefficients) -> Result<Self, ConfigError> {
        let mut keep = [false; COUNT];
        keep.iter_mut().take(FORCE_BIAS).for_each(|k| *k = true);
        let tilt = Estimator::new(model, Selection::of(&keep)?, scale, 0.0)?;
        Ok(Self { norm: NormLoop::new(model, scale)?, tilt })
    }

    /// The same with plain least squares in the windows.
    #[must_use]
    pub const fn with_plain_windows(mut self) -> Self {
        self.tilt = self.tilt.with_plain_windows();
        self
    }

    fn start(&self, prior: &Coefficients) -> TiltState<T> {
        TiltState {
            rotation: exponential(&Vector3::new(-prior[0], -prior[1], -prior[2])),
            commanded: Matrix3::identity(),
            coefficients: *prior,
            factor: self.tilt.prior(),
            carried: Carried::unit(),
        }
    }

    /// One interval of the tilt loop's motion; returns the measurement at its end.
    fn advance(&self, state: &mut TiltState<T>, record: &Record<'_>, k: usize) -> Measurement {
        let model = &self.tilt.model;
        let dt_s = record.interval_s();
        let geometry = Geometry::new(model, &state.coefficients);
        let command = Vector3::from(record.command(k));
        let step = geometry.step(model, &state.rotation, &command, dt_s);
        let turning = geometry.turning(model, &step, &command, dt_s);
        self.tilt.carry(&mut state.factor, &mut state.carried, &step.transition, &turning, dt_s);
        state.rotation = step.rotation;
        state.commanded = model.commanded_step(&state.commanded, &command, &geometry.earth_rate, dt_s);
        commanded(model, record, k + 1, &state.commanded, &geometry.earth_rate, self.tilt.robust)
    }

    /// Takes in the tilt of a found specific force whose own covariance (weighted) is `doubt`.
    fn correct(&self, state: &mut TiltState<T>, found: &Vector3<f64>, variance: f64, doubt: &Matrix3<f64>) {
        let model = &self.tilt.model;
        let back = state.rotation.transpose();
        let force = model.force(&state.rotation);
        let residual = back * (found - force);
        let slope = back * force.cross_matrix();
        let doubt = back * doubt * state.rotation;
        let [x, y, z] = self.tilt.attitude_variance(&state.factor, &state.carried);
        let second = model.gravity_m_s2 * (x + y + z);
        let mut correction = [0.0; TILT_COUNT];
        for component in [0, 2] {
            let mut row = [0.0; COUNT];
            for c in 0..3 {
                row[c] = slope[(component, c)];
            }
            let noise = variance + SECOND_ORDER * second * second + doubt[(component, component)];
            if noise.finite() && residual[component].finite() {
                let weight = 1.0 / noise.root();
                let row = self.tilt.row(&state.carried, &row, 0, weight);
                Estimator::absorb(&mut state.factor, &row, residual[component] * weight, &mut correction);
            }
        }
        let psi = self.tilt.attitude(&state.carried, &correction);
        state.rotation = product(&exponential(&-psi), &state.rotation);
        self.tilt.add_to(&mut state.coefficients, &correction);
    }

    /// Both loops side by side, on line; returns coefficients and their standard deviations, SI.
    /// `observe(epochs, coefficients)` is called after every epoch.
    pub fn cascade(
        &self,
        record: &Record<'_>,
        prior: &Coefficients,
        mut observe: impl FnMut(usize, &Coefficients),
    ) -> (Coefficients, Coefficients) {
        let mut norm = NormState::at(prior);
        let mut tilt = self.start(prior);
        for k in 0..record.epochs() {
            let measurement = self.advance(&mut tilt, record, k);
            if let Some(before) = self.norm.step(&mut norm, &measurement) {
                let doubt = norm.force_covariance(&before.derivative) * CASCADE;
                let found = self.norm.found(&norm.coefficients, &measurement.value);
                self.correct(&mut tilt, &found.force, measurement.variance[0], &doubt);
            }
            observe(k + 1, &together(&norm.coefficients, &tilt.coefficients));
        }
        self.finish(&norm, &tilt)
    }

    /// The norm loop over the whole record, then the tilt loop over it with the result. `observe(epochs, coefficients)` sees the
    /// norm loop's coefficients of the same epoch beside the tilt loop's.
    pub fn two_stage(
        &self,
        record: &Record<'_>,
        prior: &Coefficients,
        mut observe: impl FnMut(usize, &Coefficients),
    ) -> (Coefficients, Coefficients) {
        let model = &self.tilt.model;
        let earth_rate = model.earth_rate();
        let mut norm = NormState::at(prior);
        let mut frame = Matrix3::identity();
        for k in 0..record.epochs() {
            frame = model.commanded_step(&frame, &Vector3::from(record.command(k)), &earth_rate, record.interval_s());
            let measurement = commanded(model, record, k + 1, &frame, &earth_rate, self.tilt.robust);
            self.norm.step(&mut norm, &measurement);
        }
        let mut tilt = self.start(prior);
        let mut shown = NormState::at(prior);
        for k in 0..record.epochs() {
            let measurement = self.advance(&mut tilt, record, k);
            self.norm.step(&mut shown, &measurement);
            if measurement.variance.iter().all(|r| r.finite()) {
                let found = self.norm.found(&norm.coefficients, &measurement.value);
                self.correct(&mut tilt, &found.force, measurement.variance[0], &Matrix3::zeros());
            }
            observe(k + 1, &together(&shown.coefficients, &tilt.coefficients));
        }
        self.finish(&norm, &tilt)
    }

    fn finish(&self, norm: &NormState<T>, tilt: &TiltState<T>) -> (Coefficients, Coefficients) {
        let mut deviation = self.norm.standard_deviation(norm);
        let by_tilt = self.tilt.standard_deviation_now(&tilt.factor, &tilt.carried);
        deviation[..FORCE_BIAS].copy_from_slice(&by_tilt[..FORCE_BIAS]);
        (together(&norm.coefficients, &tilt.coefficients), deviation)
    }
}

/// Accelerometers from one loop, gyros from the other, no attitude.
fn together(norm: &Coefficients, tilt: &Coefficients) -> Coefficients {
    let mut all = *norm;
    all[3..FORCE_BIAS].copy_from_slice(&tilt[3..FORCE_BIAS]);
    all[..3].copy_from_slice(&[0.0; 3]);
    all
}
