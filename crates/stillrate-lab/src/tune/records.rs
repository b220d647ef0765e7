//! Records to tune on: what can be used at all, and whether anything moves in it.
//!
//! A record moves if the averages of blocks of a tenth of a second spread further than noise and slow drift explain. A record in which
//! nothing moves has a best Q/R too, but it is the one for standing still.

use core::fmt;

use stillrate::Real;

use super::second_differences::white_sigma_with_gaps;

/// Fewest usable samples of a record.
pub(crate) const FEWEST_SAMPLES: usize = 64;
/// Block averages cover this time, s: shorter than the motion of anything with mass, long against the noise.
const BLOCK_S: f64 = 0.1;
/// Most samples in a block.
const LONGEST_BLOCK: usize = 1000;

/// One measured record, with the true rate where it is known. NaN is a missing sample.
///
/// # Example
/// ```
/// use stillrate_lab::{random::Random, tune::records::Record};
/// let still = Random::new(1, 0).normals(1000); // at 100 Hz
/// let turning: Vec<f64> = still.iter().zip(0..).map(|(noise, k)| noise + 5.0 * (0.02 * f64::from(k)).sin()).collect();
/// assert!(!Record { measured: &still, truth: None }.moves(0.01));
/// assert!(Record { measured: &turning, truth: None }.moves(0.01));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    /// Measured rate, deg/s.
    pub measured: &'a [f64],
    /// True rate at the same samples, deg/s.
    pub truth: Option<&'a [f64]>,
}

/// Why a record cannot be used.
///
/// # Example
/// ```
/// use stillrate_lab::tune::gain_ratio::{Criterion, GainRatio, Walk};
/// use stillrate_lab::tune::records::{Record, RecordError};
/// use stillrate_lab::tune::tuned::TuneError;
/// let records = [Record { measured: &[0.1; 100], truth: None }];
/// let objective = GainRatio { records: &records, walk: Walk::RandomWalk, criterion: Criterion::Innovation, period_s: 0.01 };
/// assert_eq!(objective.check(), Err(TuneError::Record(RecordError::NoNoise { record: 0 })));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum RecordError {
    /// There is no record.
    None,
    /// Fewer usable samples than 64.
    Short {
        /// Which record.
        record: usize,
        /// Usable samples.
        usable: usize,
    },
    /// All samples are equal.
    NoNoise {
        /// Which record.
        record: usize,
    },
    /// Truth is needed and missing, of another length or not finite.
    Truth {
        /// Which record.
        record: usize,
        /// What is wrong.
        why: String,
    },
}

impl fmt::Display for RecordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => write!(f, "no record to tune on"),
            Self::Short { record, usable } => {
                write!(f, "record {record} has {usable} usable samples (must be at least {FEWEST_SAMPLES})")
            }
            Self::NoNoise { record } => {
                write!(f, "no noise in record {record}: all its samples are equal, so there is nothing to tune")
            }
            Self::Truth { record, why } => write!(f, "record {record}: {why}"),
        }
    }
}

impl std::error::Error for RecordError {}

impl Record<'_> {
    /// Whether the record can be used; `number` is what an error calls it.
    pub(crate) fn check(&self, number: usize, needs_truth: bool) -> Result<(), RecordError> {
        let usable = self.measured.iter().filter(|v| v.is_finite()).count();
        if usable < FEWEST_SAMPLES {
            return Err(RecordError::Short { record: number, usable });
        }
        let mut values = self.measured.iter().filter(|v| v.is_finite());
        let first = values.next();
        if values.all(|v| Some(v) == first) {
            return Err(RecordError::NoNoise { record: number });
        }
        if !needs_truth {
            return Ok(());
        }
        let wrong = |why: String| Err(RecordError::Truth { record: number, why });
        let Some(truth) = self.truth else { return wrong("the truth objective needs the true rate".into()) };
        if truth.len() != self.measured.len() {
            return wrong(format!("{} true rates for {} samples (must be as many)", truth.len(), self.measured.len()));
        }
        match truth.iter().position(|v| !v.is_finite()) {
            Some(k) => wrong(format!("true rate at sample {k} is {} (must be finite)", truth[k])),
            None => Ok(()),
        }
    }

    /// Whether more moves in the record than noise and slow drift; `period_s` between samples.
    #[must_use]
    pub fn moves(&self, period_s: f64) -> bool {
        let sigma = white_sigma_with_gaps(self.measured);
        let length =
            ((BLOCK_S / period_s) as usize).clamp(1, LONGEST_BLOCK).min(self.measured.len().div_ceil(8)).max(1);
        let means: Vec<f64> = self.measured.chunks_exact(length).filter_map(mean).collect();
        let low = means.iter().copied().fold(f64::INFINITY, f64::min);
        let high = means.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // The largest of k normal deviates is about sqrt(2 ln k); one more sigma is room for drift.
        let extreme = (2.0 * (means.len().max(2) as f64).logarithm()).root();
        high - low > sigma * (1.0 + 2.0 * extreme / (length as f64).root())
    }
}

/// Mean of the usable samples of a block, if at least half are usable.
fn mean(block: &[f64]) -> Option<f64> {
    let (sum, count) =
        block.iter().filter(|v| v.is_finite()).fold((0.0, 0_usize), |(sum, count), v| (sum + v, count + 1));
    (2 * count > block.len()).then(|| sum / count as f64)
}
