//! What a calibration found and how: estimates on the way, residual tests, and whether it lost itself.

use stillrate::gimbal::{COUNT, Coefficients, Innovation, Record};

use super::residuals::{ResidualTests, Residuals};
use super::settings::{Method, Settings};

/// How the estimate grew.
///
/// # Example
/// ```
/// # use stillrate::gimbal::{DEFAULT_SCALE, Model, Record};
/// # use stillrate_lab::gimbal::{Disturbance, Method, Settings, Trajectory, calibrate, disturb, draw, outputs};
/// # let model = Model::new(9.8, 0.7)?;
/// # let commands = Trajectory::default().commands(&model)?[..400].to_vec();
/// # let clean = outputs(&model, &draw(&DEFAULT_SCALE, 1.0, 1), &commands, 0.25, 5, 1, 0.0, 1);
/// # let samples = disturb(&clean, &Disturbance::default(), 2)?;
/// let record = Record::new(&commands, &samples, 0.25, 1e-6)?; // 400 intervals
/// let settings = Settings { every: 100, ..Settings::new(model) };
/// let history = calibrate(&record, Method::OnLine, &settings)?.history;
/// assert_eq!(history.time_s, [25.0, 50.0, 75.0, 100.0]);
/// assert!(history.deviation[3][24] < 0.1 * history.deviation[0][24]); // ka1x, once gravity lies along it
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// Time of each row, s.
    pub time_s: Vec<f64>,
    /// Estimates, SI.
    pub coefficients: Vec<Coefficients>,
    /// Their standard deviations (0 for methods that keep none on the way).
    pub deviation: Vec<Coefficients>,
}

/// Result of a calibration.
///
/// # Example
/// A record whose noise is not what it is said to be:
/// ```
/// # use stillrate::gimbal::{DEFAULT_SCALE, Model, Record};
/// # use stillrate_lab::gimbal::{Disturbance, Method, Settings, Trajectory, calibrate, disturb, draw, outputs};
/// # let model = Model::new(9.8, 0.7)?;
/// # let commands = Trajectory::default().commands(&model)?[..400].to_vec();
/// # let clean = outputs(&model, &draw(&DEFAULT_SCALE, 1.0, 1), &commands, 0.25, 5, 1, 0.0, 1);
/// let samples = disturb(&clean, &Disturbance { sigma_m_s2: 1.4e-6, ..Disturbance::default() }, 2)?;
/// let told = Record::new(&commands, &samples, 0.25, 1e-6)?;
/// let outcome = calibrate(&told, Method::Relinearised, &Settings::new(model))?;
/// assert!(!outcome.diverged && outcome.indices.len() == 30);
/// let tests = outcome.tests.unwrap();
/// assert!(tests.alarm() && (tests.mean_square - 1.4 * 1.4).abs() < 0.3);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// All coefficients, SI; attitude at the start for `Relinearised` and `Batch`.
    pub coefficients: Coefficients,
    /// Standard deviations; 0 where not estimated.
    pub deviation: Coefficients,
    /// Estimated coefficients by their place.
    pub indices: Vec<usize>,
    /// How the estimate grew.
    pub history: History,
    /// Tests of the residuals, where the method has innovations.
    pub tests: Option<ResidualTests>,
    /// Whether the method lost itself.
    pub diverged: bool,
    /// Largest scaled step of each iteration (`Batch`).
    pub steps: Vec<f64>,
    /// Squared whitened residuals (`Batch`).
    pub cost: f64,
    /// Scalar measurements (`Batch`).
    pub observations: usize,
}

/// A coefficient farther than this many prior deviations from zero is not one of a head: the method lost itself.
const LOST: f64 = 10.0;

impl Outcome {
    /// The prior, before any method has run.
    pub(super) fn prior(s: &Settings, indices: &[usize]) -> Self {
        Self {
            coefficients: s.prior,
            deviation: [0.0; COUNT],
            indices: indices.to_vec(),
            history: History::default(),
            tests: None,
            diverged: false,
            steps: Vec::new(),
            cost: f64::NAN,
            observations: 0,
        }
    }

    /// Takes over what was seen on the way, tests the residuals and judges.
    pub(super) fn conclude(mut self, watch: Watch, record: &Record<'_>, method: Method, s: &Settings) -> Self {
        self.history = watch.history;
        let mut residuals = watch.residuals;
        let mut fitted = 0;
        // With a random walk the residuals against one trajectory are not the noise alone: the innovations serve then.
        let deterministic = s.angle_random_walk_deg_sqrt_h == 0.0;
        if matches!(method, Method::Relinearised | Method::Batch) && deterministic && !self.diverged {
            residuals = Residuals::of_solution(&s.model, record, &self.coefficients, s.robust);
            fitted = self.indices.len();
        }
        if !residuals.is_empty() {
            let tests = residuals.test(record.interval_s(), fitted);
            self.diverged |= tests.diverged;
            self.tests = Some(tests);
        }
        let far = (3..COUNT).any(|i| (self.coefficients[i] / s.scale[i]).abs() > LOST);
        self.diverged |= far || !self.coefficients.iter().all(|x| x.is_finite());
        self
    }
}

/// Keeps what a method reports on the way.
pub(super) struct Watch {
    history: History,
    residuals: Residuals,
    every: usize,
    total: usize,
    interval_s: f64,
    reached: usize,
}

impl Watch {
    /// Nothing seen yet; a row of the history every so many epochs, and one at the end.
    pub(super) fn over(record: &Record<'_>, every: usize) -> Self {
        Self {
            history: History::default(),
            residuals: Residuals::default(),
            every: every.max(1),
            total: record.epochs(),
            interval_s: record.interval_s(),
            reached: 0,
        }
    }

    /// The innovations of the next epoch.
    pub(super) fn innovations(&mut self, innovations: &[Innovation; 3]) {
        self.residuals.push(innovations);
    }

    /// Another pass begins: what the one before left over does not count.
    pub(super) fn forget_innovations(&mut self) {
        self.residuals = Residuals::default();
    }

    /// Estimate and deviation after `epoch` intervals, worked out where a row is due.
    #[inline(always)]
    pub(super) fn estimate(&mut self, epoch: usize, estimate: impl FnOnce() -> (Coefficients, Coefficients)) {
        if self.due(epoch) {
            let (coefficients, deviation) = estimate();
            self.history.time_s.push(epoch as f64 * self.interval_s);
            self.history.coefficients.push(coefficients);
            self.history.deviation.push(deviation);
        }
    }

    /// Whether a row is due at this epoch: the first pass that gets there, and always the end.
    fn due(&mut self, epoch: usize) -> bool {
        if epoch == self.total && self.reached == self.total {
            self.history.time_s.pop();
            self.history.coefficients.pop();
            self.history.deviation.pop();
            return true;
        }
        if epoch <= self.reached {
            return false;
        }
        self.reached = epoch;
        epoch.is_multiple_of(self.every) || epoch == self.total
    }
}
