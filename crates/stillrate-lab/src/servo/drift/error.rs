//! What drift propagation says when there is no answer: which number shows it and what to do.

use core::fmt;

use stillrate::ConfigError;

/// Why a variance could not be computed.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::{TransferFunction, steady_state};
/// let unstable = TransferFunction::new(&[1.0], &[1.0, -2.0]).unwrap();
/// assert!(steady_state(&unstable).unwrap_err().to_string().contains("Routh row 1"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum DriftError {
    /// A parameter is out of range.
    Config(ConfigError),
    /// The numerator is not of lower degree than the denominator: white noise passes with infinite variance.
    InfiniteVariance {
        /// Degree of the numerator.
        numerator_degree: usize,
        /// Degree of the denominator.
        denominator_degree: usize,
    },
    /// A first-column entry of the Routh table is not positive.
    Unstable {
        /// Row of the Routh table, counted from 1 (highest power).
        row: usize,
        /// The entry found there.
        entry: f64,
    },
    /// A pole at 0 is excited: the variance grows without limit, so only a finite time has an answer.
    NeedsTime,
    /// Neither loop nor filter can be built from these polynomials.
    BadPolynomial(&'static str),
}

impl fmt::Display for DriftError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Config(error) => error.fmt(f),
            Self::InfiniteVariance { numerator_degree, denominator_degree } => write!(
                f,
                "infinite variance: numerator degree {numerator_degree} must be below denominator degree {denominator_degree} (limit the bandwidth, or give a band)"
            ),
            Self::Unstable { row, entry } => {
                write!(
                    f,
                    "the loop is unstable: Routh row {row} starts with {entry:e} (must be > 0); lower the gain or give time_s"
                )
            }
            Self::NeedsTime => {
                write!(f, "a pole at 0 is excited: the variance grows without limit, so give time_s")
            }
            Self::BadPolynomial(what) => f.write_str(what),
        }
    }
}

impl core::error::Error for DriftError {}

impl From<ConfigError> for DriftError {
    fn from(error: ConfigError) -> Self {
        Self::Config(error)
    }
}
