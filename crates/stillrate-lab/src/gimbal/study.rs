//! Monte Carlo study of the methods: draws of coefficients and noise, four starts, disturbances; the numbers behind `reproduce gimbal`.
//!
//! Starts: (1) zero, (2) half the truth, (3) truth times 1 + N(0,1), all on the same noise; (4) zero with a hundred times the noise.
//! kappa is scored over the mean size of the three kgI: over its own true value the relative error of a mean that random signs bring near zero
//! says nothing; both are kept.

use rayon::prelude::*;
use stillrate::gimbal::coefficients::{GYRO_BIAS, TORQUER};
use stillrate::gimbal::{COUNT, Coefficients, DEFAULT_SCALE, Model, Record};
use stillrate::{ConfigError, Real};

use super::bound::{Bound, Sampling, bound};
use super::calibrate::calibrate;
use super::outcome::Outcome;
use super::residuals::ResidualTests;
use super::score::{KAPPA, Score, mean_kappa, score, settling_time};
use super::settings::{Method, Settings};
use super::simulate::{Disturbance, disturb, draw, outputs};
use super::trajectory::Trajectory;
use crate::random::Random;

/// Where the estimate starts.
///
/// # Example
/// Whether a method depends on it is what a study of the same seeds shows:
/// ```
/// use stillrate::gimbal::Model;
/// use stillrate_lab::gimbal::{Start, Study, Trajectory, run_study};
/// let mut study = Study::new(Model::new(9.8, 0.7)?);
/// study.trajectory = Trajectory { segment_s: 20.0, ..Trajectory::default() };
/// let from_zero = run_study(&study, &[1])?;
/// study.start = Start::Half;
/// let from_half = run_study(&study, &[1])?;
/// let (a, b) = (&from_zero[0].outcome, &from_half[0].outcome);
/// assert!((a.coefficients[21] - b.coefficients[21]).abs() < 0.1 * a.deviation[21]);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// (1) and (4): zero.
    Zero,
    /// (2): half the truth.
    Half,
    /// (3): truth times 1 + N(0,1).
    Scattered,
}

/// What a study runs.
///
/// # Example
/// ```
/// use stillrate::gimbal::{Model, coefficients::TORQUER};
/// use stillrate_lab::gimbal::{Method, Study, run_study};
/// let mut study = Study::new(Model::new(9.8, 0.7)?);
/// study.method = Method::OnLine;
/// study.extra[TORQUER] = 1e-4; // an effect that the estimator is not told of
/// let draws = run_study(&study, &[1])?;
/// assert!(draws[0].tests.unwrap().alarm()); // and that its residuals show
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Method.
    pub method: Method,
    /// Settings of the estimator; the prior mean is set from the start.
    pub settings: Settings,
    /// Motion.
    pub trajectory: Trajectory,
    /// Disturbance of the truth.
    pub disturbance: Disturbance,
    /// Deviation of the noise that the estimator is told, m/s^2.
    pub sigma_m_s2: f64,
    /// Drifts and g-sensitive terms: 1 for 0.03 to 0.1 deg/h, 10 for ten times that.
    pub gyro_factor: f64,
    /// Added to every draw (torquer error, quadratic term, latency, latitude ...).
    pub extra: Coefficients,
    /// Start.
    pub start: Start,
    /// Samples in a command interval.
    pub per_interval: usize,
}

impl Study {
    /// The recommended method on the default run.
    #[must_use]
    pub fn new(model: Model) -> Self {
        Self {
            method: Method::Relinearised,
            settings: Settings::new(model),
            trajectory: Trajectory::default(),
            disturbance: Disturbance::default(),
            sigma_m_s2: 1e-6,
            gyro_factor: 1.0,
            extra: [0.0; COUNT],
            start: Start::Zero,
            per_interval: 5,
        }
    }
}

/// Result of one draw.
///
/// # Example
/// ```
/// use stillrate::gimbal::Model;
/// use stillrate_lab::gimbal::{Draw, Study, run_study};
/// let draws = run_study(&Study::new(Model::new(9.8, 0.7)?), &[1])?;
/// let Draw { score, settling_s, .. } = &draws[0];
/// assert!(score.other < 2e-3 && (0.3..3.0).contains(&score.over_bound));
/// assert!(settling_s[0] < settling_s[1]); // 1 % before 0.2 %
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Draw {
    /// Truth.
    pub truth: Coefficients,
    /// What came out.
    pub outcome: Outcome,
    /// Bound at the truth.
    pub bound: Bound,
    /// Errors.
    pub score: Score,
    /// Error of kappa over the mean size of the three kgI.
    pub kappa_of_mean_size: f64,
    /// Normalised estimation error squared over the number of coefficients, with the method's own deviations.
    pub normalised_error: f64,
    /// Error in units of the bound's deviation, full covariance: e^T J^T J e / n.
    pub error_over_bound: f64,
    /// Settling times to 1 %, 0.2 %, 0.05 %, s.
    pub settling_s: [Option<f64>; 3],
    /// Residual tests.
    pub tests: Option<ResidualTests>,
}

/// e^T J^T J e / n of the coefficients without the attitude, from singular values and directions with the attitude's error minimised out: the
/// covariance of the coefficients is the block of (J^T J)^-1.
fn whitened_error(bound: &Bound, error: &Coefficients, scale: &Coefficients) -> f64 {
    let n = bound.indices.len();
    let free: Vec<usize> = (0..n).filter(|&at| bound.indices[at] >= 3).collect();
    let mut covariance = nalgebra::DMatrix::<f64>::zeros(free.len(), free.len());
    for (value, direction) in bound.singular_values.iter().zip(&bound.directions) {
        for (i, &a) in free.iter().enumerate() {
            for (j, &b) in free.iter().enumerate() {
                covariance[(i, j)] += direction[a] * direction[b] / (value * value);
            }
        }
    }
    let e = nalgebra::DVector::from_fn(free.len(), |i, _| {
        let index = bound.indices[free[i]];
        error[index] / scale[index]
    });
    match covariance.cholesky() {
        Some(root) => e.dot(&root.solve(&e)) / free.len() as f64,
        None => f64::NAN,
    }
}

/// One draw of a study.
fn run_draw(study: &Study, seed: u64) -> Result<Draw, ConfigError> {
    let model = &study.settings.model;
    let mut truth = draw(&DEFAULT_SCALE, study.gyro_factor, seed);
    for (t, e) in truth.iter_mut().zip(&study.extra) {
        *t += e;
    }
    let commands = study.trajectory.commands(model)?;
    let interval_s = study.trajectory.interval_s;
    let walk = study.disturbance.angle_random_walk_deg_sqrt_h;
    let clean = outputs(model, &truth, &commands, interval_s, study.per_interval, 1, walk, seed);
    let samples = disturb(&clean, &study.disturbance, seed)?;
    let record = Record::new(&commands, &samples, interval_s, study.sigma_m_s2)?;
    let mut settings = study.settings;
    let mut random = Random::new(seed, 9);
    for i in GYRO_BIAS..TORQUER {
        settings.prior[i] = match study.start {
            Start::Zero => 0.0,
            Start::Half => 0.5 * truth[i],
            Start::Scattered => truth[i] * (1.0 + random.normal()),
        };
    }
    let outcome = calibrate(&record, study.method, &settings)?;
    let sampling = Sampling {
        interval_s,
        half_window: record.half_window(),
        sigma_m_s2: study.sigma_m_s2,
        skip_jumps: false,
        cut_off_rad: settings.cut_off_rad,
    };
    let bound = bound(model, &truth, &settings.scale, &outcome.indices, &commands, &sampling);
    let of = |x: &Coefficients| score(x, &truth, &bound.deviation, &outcome.indices);
    let others: Vec<f64> = outcome.history.coefficients.iter().map(|x| of(x).other).collect();
    let settling_s = [0.01, 0.002, 0.0005].map(|limit| settling_time(&outcome.history.time_s, &others, limit));
    let error: Coefficients = core::array::from_fn(|i| outcome.coefficients[i] - truth[i]);
    let size = KAPPA.map(|i| truth[i].magnitude()).sum::<f64>() / 3.0;
    let kappa_of_mean_size = mean_kappa(&error).magnitude() / size;
    let estimated: Vec<usize> = outcome.indices.iter().copied().filter(|&i| i >= 3).collect();
    let own = estimated.iter().map(|&i| error[i] / outcome.deviation[i]).map(|x| x * x).sum::<f64>();
    let normalised_error = own / estimated.len() as f64;
    let error_over_bound = whitened_error(&bound, &error, &settings.scale);
    let tests = outcome.tests;
    let score = of(&outcome.coefficients);
    Ok(Draw { truth, outcome, bound, score, kappa_of_mean_size, normalised_error, error_over_bound, settling_s, tests })
}

/// Draws with the given seeds, in their order; they run on all processors, with the same bits on any number of them.
///
/// # Errors
/// [`ConfigError`] if settings do not fit.
///
/// # Example
/// ```
/// use stillrate::gimbal::Model;
/// use stillrate_lab::gimbal::{Study, Trajectory, run_study};
/// let mut study = Study::new(Model::new(9.8, 0.7)?);
/// study.trajectory = Trajectory { segment_s: 20.0, ..Trajectory::default() };
/// let draws = run_study(&study, &[5, 3])?;
/// assert_eq!(draws[1].outcome.coefficients, run_study(&study, &[3])?[0].outcome.coefficients);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub fn run_study(study: &Study, seeds: &[u64]) -> Result<Vec<Draw>, ConfigError> {
    seeds.par_iter().map(|&seed| run_draw(study, seed)).collect()
}
