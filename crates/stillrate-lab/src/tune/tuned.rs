//! Tunes Q/R of a small Kalman filter on records, from checks to warnings.

use core::fmt;

use stillrate::Real;

use crate::tune::gain_ratio::{Criterion, GainRatio, LN_10, Walk};
use crate::tune::minimise::{Method, minimise};
use crate::tune::objective::{MinimiseError, Progress};
use crate::tune::records::RecordError;

/// log10(Q/R) of the random walk: from a mean over 1e6 samples to no filter at all.
const RANDOM_WALK_RANGE: (f64, f64) = (-12.0, 4.0);
/// A result this close to the end of its range (in decades) is the end and not a minimum.
const AT_BOUND: f64 = 0.05;

/// Tuned noise of a small Kalman filter.
///
/// # Example
/// ```
/// use stillrate_lab::{random::Random, tune::records::Record};
/// use stillrate_lab::tune::{gain_ratio::{Criterion, GainRatio, Walk}, minimise::Method};
/// let still = Random::new(1, 0).normals(6000);
/// let records = [Record { measured: &still, truth: None }];
/// let objective = GainRatio { records: &records, walk: Walk::RandomWalk, criterion: Criterion::Innovation, period_s: 0.01 };
/// let tuned = objective.tune(&Method::default(), false, &mut |_| true)?;
/// assert!((tuned.measurement_variance - 1.0).abs() < 0.05);
/// assert!(!tuned.moving && tuned.warnings()[0].starts_with("nothing moves in these records"));
/// # Ok::<(), stillrate_lab::tune::tuned::TuneError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Tuned {
    /// log10 of Q/R.
    pub log10_ratio: f64,
    /// Q: (deg/s)^2 a step for the random walk, spectral density of the acceleration's derivative in (deg/s)^2/s^3 for the two-state filter.
    pub process_noise: f64,
    /// R in (deg/s)^2, estimated from the innovations.
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
///
/// # Example
/// ```
/// use stillrate_lab::tune::{gain_ratio::{Criterion, GainRatio, Walk}, tuned::TuneError};
/// let objective = GainRatio { records: &[], walk: Walk::RandomWalk, criterion: Criterion::Innovation, period_s: 0.0 };
/// assert_eq!(objective.check(), Err(TuneError::Period(0.0)));
/// assert_eq!(objective.check().unwrap_err().to_string(), "sample period = 0 s (must be finite and > 0 s)");
/// ```
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

impl GainRatio<'_> {
    /// The range of log10(Q/R) that is searched. For two states it is that of bandwidths w = (q/(R dt))^(1/4) from
    /// 0.006 rad/s to the sample rate.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        match self.walk {
            Walk::RandomWalk => RANDOM_WALK_RANGE,
            Walk::RateAcceleration => {
                let log10 = |x: f64| x.logarithm() / LN_10;
                let period = log10(self.period_s);
                (4.0 * log10(0.006) + period, -4.0 * period + period)
            }
        }
    }

    /// Checks records and period as [`GainRatio::tune`] does.
    ///
    /// # Errors
    /// [`TuneError`].
    pub fn check(&self) -> Result<(), TuneError> {
        if !(self.period_s.is_finite() && self.period_s > 0.0) {
            return Err(TuneError::Period(self.period_s));
        }
        if self.records.is_empty() {
            return Err(RecordError::None.into());
        }
        for (number, record) in self.records.iter().enumerate() {
            record.check(number, self.criterion == Criterion::Truth)?;
        }
        Ok(())
    }

    /// Finds Q/R. With `separate` the search is the published one over log10 Q and log10 R, each in -10..=10.
    ///
    /// # Errors
    /// [`TuneError`].
    pub fn tune(
        mut self,
        method: &Method,
        separate: bool,
        progress: &mut dyn FnMut(&Progress) -> bool,
    ) -> Result<Tuned, TuneError> {
        self.check()?;
        let (low, high) = self.range();
        let (lower, upper) = if separate { (vec![-10.0; 2], vec![10.0; 2]) } else { (vec![low], vec![high]) };
        let best = minimise(&mut self, &lower, &upper, method, progress)?;
        Ok(self.finish(&best.point, best.value, best.evaluations))
    }

    /// Completes a point found by any optimiser: log10 of Q/R, or log10 of Q and of R.
    #[must_use]
    pub fn finish(&self, point: &[f64], value: f64, evaluations: usize) -> Tuned {
        let log10_ratio = if point.len() == 2 { point[0] - point[1] } else { point[0] };
        let (low, high) = self.range();
        let ratio = (LN_10 * log10_ratio).exponential();
        let blind = GainRatio { criterion: Criterion::Innovation, ..*self };
        let measurement_variance = blind.scores(&[ratio])[0].measurement_variance;
        Tuned {
            log10_ratio,
            process_noise: ratio * measurement_variance,
            measurement_variance,
            value,
            evaluations,
            moving: self.records.iter().any(|record| record.moves(self.period_s)),
            at_bound: log10_ratio <= low + AT_BOUND || log10_ratio >= high - AT_BOUND,
        }
    }
}
