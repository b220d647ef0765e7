//! One calibration of one record by any method, with history, residual tests and flags: what the command line and Python call.

use stillrate::ConfigError;
use stillrate::Real;
use stillrate::gimbal::{
    COUNT, Coefficients, Estimator, FirstOrder, Innovation, JointFilter, Record, Relinearised, Selection, TwoLoop,
};

use super::batch::batch;
use super::literal::literal_angle;
use super::residuals::{ResidualTests, Residuals};
use super::settings::{Method, Settings};

/// How the estimate grew.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// Time of each row, s.
    pub time_s: Vec<f64>,
    /// Estimates.
    pub coefficients: Vec<Coefficients>,
    /// Their standard deviations (0 for methods that keep none on the way).
    pub deviation: Vec<Coefficients>,
}

/// Result of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// All coefficients; attitude at the start for `Relinearised` and `Batch`.
    pub coefficients: Coefficients,
    /// Standard deviations; 0 where not estimated.
    pub deviation: Coefficients,
    /// Estimated coefficients.
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

struct Collector {
    history: History,
    every: usize,
    total: usize,
    interval_s: f64,
    reached: usize,
}

impl Collector {
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
    fn push(&mut self, epoch: usize, coefficients: &Coefficients, deviation: &Coefficients) {
        self.history.time_s.push(epoch as f64 * self.interval_s);
        self.history.coefficients.push(*coefficients);
        self.history.deviation.push(*deviation);
    }
}

/// Calibrates from a record.
///
/// # Errors
/// [`ConfigError`] if the settings do not fit together.
///
/// # Example
/// ```
/// use stillrate::gimbal::{DEFAULT_SCALE, Model, Record};
/// use stillrate_lab::gimbal::{Disturbance, Method, Settings, Trajectory, calibrate, disturb, draw, outputs};
/// let model = Model::new(9.8, 0.7).unwrap();
/// let commands = Trajectory::default().commands(&model).unwrap();
/// let truth = draw(&DEFAULT_SCALE, 10.0, 1);
/// let clean = outputs(&model, &truth, &commands, 0.25, 5, 1, 0.0, 1);
/// let samples = disturb(&clean, &Disturbance::default(), 2).unwrap();
/// let record = Record::new(&commands, &samples, 0.25, 1e-6).unwrap();
/// let outcome = calibrate(&record, Method::Relinearised, &Settings::new(model)).unwrap();
/// assert!((outcome.coefficients[3] / truth[3] - 1.0).abs() < 1e-3);
/// ```
pub fn calibrate(record: &Record<'_>, method: Method, settings: &Settings) -> Result<Outcome, ConfigError> {
    let count = settings.indices()?.len();
    match (count <= BASIC, settings.single) {
        (true, false) => widest::<f64, BASIC>(record, method, settings),
        (true, true) => widest::<f32, BASIC>(record, method, settings),
        (false, false) => widest::<f64, ALL>(record, method, settings),
        (false, true) => widest::<f32, ALL>(record, method, settings),
    }
}

/// Capacity for the 30 observable coefficients, in whole groups of four rows of the square root.
const BASIC: usize = 32;
/// Capacity for everything.
const ALL: usize = 44;

/// [`run`] compiled for the instructions that this machine has: the operations are the same, and so are the bits.
fn widest<T: Real, const N: usize>(record: &Record<'_>, method: Method, s: &Settings) -> Result<Outcome, ConfigError> {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the feature was just detected.
        return unsafe { run_avx2::<T, N>(record, method, s) };
    }
    run::<T, N>(record, method, s)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2<T: Real, const N: usize>(
    record: &Record<'_>,
    method: Method,
    s: &Settings,
) -> Result<Outcome, ConfigError> {
    run::<T, N>(record, method, s)
}

#[inline(always)]
#[expect(clippy::too_many_lines, reason = "one arm a method")]
fn run<T: Real, const N: usize>(record: &Record<'_>, method: Method, s: &Settings) -> Result<Outcome, ConfigError> {
    let selection = Selection::<N>::for_triads(s.gauge, s.options, &s.model.triads)?;
    let mut estimator = Estimator::<T, N>::new(s.model, selection, &s.scale, s.angle_random_walk_deg_sqrt_h)?
        .with_cut_off(s.cut_off_rad)?;
    if !s.robust {
        estimator = estimator.with_plain_windows();
    }
    let indices = selection.indices().to_vec();
    let total = record.epochs();
    let mut collector = Collector {
        history: History::default(),
        every: s.every.max(1),
        total,
        interval_s: record.interval_s(),
        reached: 0,
    };
    let mut residuals = Residuals::default();
    let mut outcome = Outcome {
        coefficients: s.prior,
        deviation: [0.0; COUNT],
        indices,
        history: History::default(),
        tests: None,
        diverged: false,
        steps: Vec::new(),
        cost: f64::NAN,
        observations: 0,
    };
    match method {
        Method::Relinearised => {
            let relinearised = Relinearised { estimator, reference: s.reference };
            let mut number = 0;
            let solution = relinearised.run(record, &s.prior, |pass_number, pass, innovations: &[Innovation; 3]| {
                if pass_number != number {
                    residuals = Residuals::default();
                    number = pass_number;
                }
                residuals.push(innovations);
                if collector.due(pass.epoch) {
                    let deviation = relinearised.standard_deviation(pass);
                    collector.push(pass.epoch, &relinearised.estimate(pass), &deviation);
                }
            });
            outcome.coefficients = solution.coefficients;
            outcome.deviation = solution.deviation;
            outcome.diverged = solution.diverged;
        }
        Method::OnLine => {
            let filter = JointFilter::new(estimator, s.second_order)?;
            let mut state = filter.start(&s.prior);
            for k in 0..total {
                let innovations = filter.epoch(&mut state, record, k, s.reference);
                residuals.push(&innovations);
                if collector.due(k + 1) {
                    let deviation = filter.standard_deviation(&state);
                    collector.push(k + 1, &filter.attitude_and_coefficients(&state), &deviation);
                }
            }
            outcome.coefficients = filter.attitude_and_coefficients(&state);
            outcome.deviation = filter.standard_deviation(&state);
        }
        Method::FirstOrder => {
            let filter = FirstOrder { estimator };
            let mut state = filter.start(&s.prior);
            for k in 0..total {
                residuals.push(&filter.epoch(&mut state, record, k));
                if collector.due(k + 1) {
                    collector.push(k + 1, &state.coefficients, &filter.standard_deviation(&state));
                }
            }
            outcome.coefficients = state.coefficients;
            outcome.deviation = filter.standard_deviation(&state);
        }
        Method::Batch => {
            let solution = batch(&s.model, record, &outcome.indices, &s.prior, &s.scale, s.reference, s.robust);
            outcome.coefficients = solution.coefficients;
            outcome.deviation = solution.deviation;
            outcome.steps = solution.steps;
            outcome.cost = solution.cost;
            outcome.observations = solution.observations;
        }
        Method::TwoStage | Method::TwoLoop => {
            let mut two = TwoLoop::<T>::new(s.model, &s.scale)?;
            if !s.robust {
                two = two.with_plain_windows();
            }
            let observe = |epoch: usize, coefficients: &Coefficients| {
                if collector.due(epoch) {
                    collector.push(epoch, coefficients, &[0.0; COUNT]);
                }
            };
            (outcome.coefficients, outcome.deviation) = if method == Method::TwoStage {
                two.two_stage(record, &s.prior, observe)
            } else {
                two.cascade(record, &s.prior, observe)
            };
        }
        Method::Literal => {
            outcome.coefficients = literal_angle(&s.model, record, &s.prior, &s.scale, |epoch, coefficients| {
                if collector.due(epoch) {
                    collector.push(epoch, coefficients, &[0.0; COUNT]);
                }
            });
        }
    }
    outcome.history = collector.history;
    let mut fitted = 0;
    let deterministic = s.angle_random_walk_deg_sqrt_h == 0.0;
    if matches!(method, Method::Relinearised | Method::Batch) && deterministic && !outcome.diverged {
        residuals = Residuals::of_solution(&s.model, record, &outcome.coefficients, s.robust);
        fitted = outcome.indices.len();
    }
    if !residuals.is_empty() {
        let tests = residuals.test(record.interval_s(), fitted);
        outcome.diverged |= tests.diverged;
        outcome.tests = Some(tests);
    }
    let far = (3..COUNT).any(|i| (outcome.coefficients[i] / s.scale[i]).abs() > 10.0);
    outcome.diverged |= far || !outcome.coefficients.iter().all(|x| x.is_finite());
    Ok(outcome)
}
