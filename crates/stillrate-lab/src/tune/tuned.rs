//! Tunes Q/R of a small Kalman filter on records, from checks to warnings.

use core::fmt;

use stillrate::Real;

use crate::tune::gain_ratio::{Criterion, GainRatio, LN_10, Walk};
use crate::tune::minimise::{Method, MinimiseError, Progress, minimise};
use crate::tune::records::{Record, RecordError};

/// log10(Q/R) of the random walk: from a mean over 1e6 samples to no filter at all.
const RANDOM_WALK_RANGE: (f64, f64) = (-12.0, 4.0);
/// A result this close to the end of its range (in decades) is the end and not a minimum.
const AT_BOUND: f64 = 0.05;

/// Tuned noise of a small Kalman filter.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuned {
    /// log10 of Q/R.
    pub log10_ratio: f64,
    /// Q: per step for the random walk, spectral density of the acceleration's derivative for the two-state filter.
    pub process_noise: f64,
    /// R, estimated from the innovations.
    pub measurement_variance: f64,
    /// The objective there.
    pub value: f64,
    /// Candidates valued.
    pub evaluations: usize,
    /// Whether something moved in at least one record.
    pub moving: bool,
    /// Whether the result stands at the end of its range.
    pub at_bound: bool,
}

/// Why there is no result.
#[derive(Clone, Debug, PartialEq)]
pub enum TuneError {
    /// A record cannot be used.
    Record(RecordError),
    /// The optimiser could not start or found nothing.
    Minimise(MinimiseError),
    /// The sample period is unusable.
    Period(f64),
}

impl fmt::Display for TuneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Record(error) => error.fmt(f),
            Self::Minimise(error) => error.fmt(f),
            Self::Period(period) => write!(f, "sample period = {period} s (must be finite and > 0 s)"),
        }
    }
}

impl std::error::Error for TuneError {}

impl From<RecordError> for TuneError {
    fn from(error: RecordError) -> Self {
        Self::Record(error)
    }
}

impl From<MinimiseError> for TuneError {
    fn from(error: MinimiseError) -> Self {
        Self::Minimise(error)
    }
}

impl Tuned {
    /// What the user should know before using the result; empty if there is nothing.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut out = Vec::new();
        if !self.moving {
            out.push(
                "nothing moves in these records: the result suits standing still and will lag behind motion; tune on \
                 records with the motion to be expected"
                    .to_owned(),
            );
        }
        if self.at_bound {
            out.push(format!("log10(Q/R) = {:.2} is the end of the searched range, not a minimum", self.log10_ratio));
        }
        out
    }
}

/// The range of log10(Q/R) that is searched. For two states it is that of bandwidths w = (q/(R dt))^(1/4) from
/// 0.006 rad/s to the sample rate.
#[must_use]
pub fn range(walk: Walk, period_s: f64) -> (f64, f64) {
    match walk {
        Walk::RandomWalk => RANDOM_WALK_RANGE,
        Walk::RateAcceleration => {
            let log10 = |x: f64| x.logarithm() / LN_10;
            let period = log10(period_s);
            (4.0 * log10(0.006) + period, -4.0 * period + period)
        }
    }
}

/// Finds Q/R. With `separate` the search is the published one over log10 Q and log10 R, each in -10..=10.
///
/// # Errors
/// [`TuneError`].
///
/// # Example
/// ```
/// use stillrate_lab::random::Random;
/// use stillrate_lab::tune::{brent::Brent, gain_ratio::{Criterion, Walk}, minimise::Method, records::Record, tuned::tune};
/// let mut random = Random::new(1, 0);
/// let mut rate = 0.0;
/// let measured: Vec<f64> = (0..4000).map(|_| { rate += 0.1 * random.normal(); rate + random.normal() }).collect();
/// let records = [Record { measured: &measured, truth: None }];
/// let method = Method::Brent(Brent::default());
/// let tuned = tune(&records, 0.01, Walk::RandomWalk, Criterion::Innovation, &method, false, &mut |_| true)?;
/// assert!((tuned.log10_ratio + 2.0).abs() < 0.2); // Q/R = 0.01
/// # Ok::<(), stillrate_lab::tune::tuned::TuneError>(())
/// ```
pub fn tune(
    records: &[Record<'_>],
    period_s: f64,
    walk: Walk,
    criterion: Criterion,
    method: &Method,
    separate: bool,
    progress: &mut dyn FnMut(&Progress) -> bool,
) -> Result<Tuned, TuneError> {
    check(records, period_s, criterion)?;
    let mut objective = GainRatio { records, walk, criterion, period_s };
    let (low, high) = range(walk, period_s);
    let (lower, upper) = if separate { (vec![-10.0; 2], vec![10.0; 2]) } else { (vec![low], vec![high]) };
    let best = minimise(&mut objective, &lower, &upper, method, progress)?;
    Ok(finish(&objective, &best.point, best.value, best.evaluations))
}

/// Checks records and period as [`tune`] does.
///
/// # Errors
/// [`TuneError`].
pub fn check(records: &[Record<'_>], period_s: f64, criterion: Criterion) -> Result<(), TuneError> {
    if !(period_s.is_finite() && period_s > 0.0) {
        return Err(TuneError::Period(period_s));
    }
    if records.is_empty() {
        return Err(RecordError::None.into());
    }
    for (number, record) in records.iter().enumerate() {
        record.check(number, criterion == Criterion::Truth)?;
    }
    Ok(())
}

/// Completes a point found by any optimiser.
#[must_use]
pub fn finish(objective: &GainRatio<'_>, point: &[f64], value: f64, evaluations: usize) -> Tuned {
    let log10_ratio = if point.len() == 2 { point[0] - point[1] } else { point[0] };
    let (low, high) = range(objective.walk, objective.period_s);
    let ratio = (LN_10 * log10_ratio).exponential();
    let blind = GainRatio { criterion: Criterion::Innovation, ..*objective };
    let measurement_variance = blind.scores(&[ratio])[0].measurement_variance;
    Tuned {
        log10_ratio,
        process_noise: ratio * measurement_variance,
        measurement_variance,
        value,
        evaluations,
        moving: objective.records.iter().any(|record| record.moves(objective.period_s)),
        at_bound: log10_ratio <= low + AT_BOUND || log10_ratio >= high - AT_BOUND,
    }
}
