//! Why a record cannot be analysed.

use core::fmt;

use stillrate::ConfigError;

/// A record or a setting that an analysis cannot use.
///
/// # Example
/// ```
/// use stillrate_lab::error::LogError;
/// let error = LogError::TooShort { finite: 3, needed: 8 };
/// assert_eq!(error.to_string(), "the record holds 3 usable samples (at least 8 are needed)");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LogError {
    /// Too few finite samples.
    TooShort {
        /// Usable samples found.
        finite: usize,
        /// Samples needed.
        needed: usize,
    },
    /// A setting is out of range.
    Setting(ConfigError),
}

impl fmt::Display for LogError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooShort { finite, needed } => {
                write!(f, "the record holds {finite} usable samples (at least {needed} are needed)")
            }
            Self::Setting(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for LogError {}

impl From<ConfigError> for LogError {
    fn from(error: ConfigError) -> Self {
        Self::Setting(error)
    }
}
