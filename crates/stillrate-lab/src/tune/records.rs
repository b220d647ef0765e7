//! Records to tune on: what can be used at all, how noisy it is, and whether anything moves in it.
//!
//! White noise is taken from the median magnitude of the second difference, which smooth motion hardly touches. A record moves if the
//! averages of blocks of a tenth of a second spread further than noise and slow drift explain. A record in which nothing
//! moves has a best Q/R too, but it is the one for standing still.

use core::fmt;

use stillrate::Real;

/// Fewest usable samples of a record.
pub const FEWEST_SAMPLES: usize = 64;
/// Block averages cover this time, s: shorter than the motion of anything with mass, long against the noise.
const BLOCK_S: f64 = 0.1;
/// Most samples in a block.
const LONGEST_BLOCK: usize = 1000;
/// Median magnitude of a normal deviate, in standard deviations.
const MEDIAN_MAGNITUDE: f64 = 0.674_489_750_196_081_7;
/// Standard deviation of a second difference of white noise: sqrt(1 + 4 + 1).
const SECOND_DIFFERENCE: f64 = 2.449_489_742_783_178;

/// One measured record, with the true rate where it is known. NaN is a missing sample.
///
/// # Example
/// ```
/// use stillrate_lab::tune::records::Record;
/// let still = [0.1; 100];
/// assert!(Record { measured: &still, truth: None }.check(0, false).is_err()); // no noise in it
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    /// Measured rate.
    pub measured: &'a [f64],
    /// True rate at the same samples.
    pub truth: Option<&'a [f64]>,
}

/// Why a record cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub enum RecordError {
    /// There is no record.
    None,
    /// Fewer usable samples than [`FEWEST_SAMPLES`].
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
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn check(&self, number: usize, needs_truth: bool) -> Result<(), RecordError> {
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

    /// Standard deviation of the white part of the noise.
    #[must_use]
    pub fn white_noise(&self) -> f64 {
        let mut second: Vec<f64> =
            self.measured.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs()).filter(|v| v.is_finite()).collect();
        if second.is_empty() {
            return 0.0;
        }
        let middle = second.len() / 2;
        let (_, median, _) = second.select_nth_unstable_by(middle, f64::total_cmp);
        let sigma = *median / (MEDIAN_MAGNITUDE * SECOND_DIFFERENCE);
        // Coarse quantisation: most differences are zero, so their root mean square has to do.
        let mean_square = second.iter().map(|d| d * d).sum::<f64>() / second.len() as f64;
        if sigma > 0.0 { sigma } else { mean_square.root() / SECOND_DIFFERENCE }
    }

    /// Whether more moves in the record than noise and slow drift.
    #[must_use]
    pub fn moves(&self, period_s: f64) -> bool {
        let sigma = self.white_noise();
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
