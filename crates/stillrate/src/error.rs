//! What a configuration says when it cannot be built: field, value, unit and allowed range.

use core::fmt;

/// A setting that cannot be used. Settings are checked once, when a filter is built; nothing fails after that.
///
/// # Example
/// ```
/// use stillrate::ConfigError;
/// let error = ConfigError::new("sample_rate_hz", -50.0, "Hz", "finite and > 0");
/// assert_eq!(error.to_string(), "sample_rate_hz = -50 (must be finite and > 0 Hz)");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfigError {
    /// Name of the setting.
    pub field: &'static str,
    /// The value that was given.
    pub value: f64,
    /// Unit of the value, empty for a pure number.
    pub unit: &'static str,
    /// What would be right, to be read after "must be".
    pub range: &'static str,
}

impl ConfigError {
    /// An error about one setting; `range` completes the sentence "must be ...".
    #[must_use]
    pub const fn new(field: &'static str, value: f64, unit: &'static str, range: &'static str) -> Self {
        Self { field, value, unit, range }
    }
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let space = if self.unit.is_empty() { "" } else { " " };
        // Digits that nobody would count are left to the exponent.
        let size = self.value.abs();
        let plain = size == 0.0 || !self.value.is_finite() || (1e-6..1e16).contains(&size);
        write!(f, "{} = ", self.field)?;
        if plain {
            write!(f, "{}", self.value)?;
        } else {
            write!(f, "{:e}", self.value)?;
        }
        write!(f, " (must be {}{}{})", self.range, space, self.unit)
    }
}

impl core::error::Error for ConfigError {}

/// Passes a value on if it is finite and above zero.
///
/// # Errors
/// [`ConfigError`] that names the field otherwise.
///
/// # Example
/// ```
/// use stillrate::error::positive;
/// assert_eq!(positive("cutoff_hz", 8.0, "Hz"), Ok(8.0));
/// assert!(positive("cutoff_hz", f64::NAN, "Hz").is_err());
/// ```
pub fn positive(field: &'static str, value: f64, unit: &'static str) -> Result<f64, ConfigError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(ConfigError::new(field, value, unit, "finite and > 0"))
    }
}

/// Passes a value on if it is finite and not below zero.
///
/// # Errors
/// [`ConfigError`] that names the field otherwise.
///
/// # Example
/// ```
/// use stillrate::error::not_negative;
/// assert!(not_negative("beta", 0.0, "").is_ok());
/// assert!(not_negative("beta", -1.0, "").is_err());
/// ```
pub fn not_negative(field: &'static str, value: f64, unit: &'static str) -> Result<f64, ConfigError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(ConfigError::new(field, value, unit, "finite and >= 0"))
    }
}

/// Passes a value on if `low < value < high`; `range` says so in words.
///
/// # Errors
/// [`ConfigError`] that names the field otherwise.
///
/// # Example
/// ```
/// use stillrate::error::between;
/// assert!(between("cutoff_hz", 30.0, 0.0, 25.0, "Hz", "above 0 and below half the sample rate in").is_err());
/// ```
pub fn between(
    field: &'static str,
    value: f64,
    low: f64,
    high: f64,
    unit: &'static str,
    range: &'static str,
) -> Result<f64, ConfigError> {
    if value > low && value < high { Ok(value) } else { Err(ConfigError::new(field, value, unit, range)) }
}
