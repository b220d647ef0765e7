//! What every filter offers, whatever its method and precision.

use super::watched::{LastEstimate, Trace};
use crate::samples::{Precision, Sink, Source, Timing};
use crate::settings_map::SettingsMap;

/// A filter with its channels, whatever the method and precision. [`super::build`] makes one.
///
/// # Example
/// ```
/// use stillrate_lab::runner::{Precision, build};
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
/// let mut filter = build("ms-imm-ikf", &settings, 3, Precision::Single)?;
/// assert_eq!((filter.method(), filter.precision(), filter.channels()), ("ms-imm-ikf", Precision::Single, 3));
/// assert_eq!(filter.models(), 9); // at 50 Hz: rest, four rungs, four oscillators
/// assert!(filter.settings().contains_key("dwell_time_s")); // all of them, with their defaults
/// let mut rates = [0.1, -0.2, f64::NAN];
/// filter.update(&mut rates, None);
/// assert_eq!(rates[2], 0.0); // no sample yet: a placeholder, never NaN
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
pub trait Runner: Send {
    /// Name of the method.
    fn method(&self) -> &'static str;
    /// Every setting, by name.
    fn settings(&self) -> SettingsMap;
    /// Number type it computes in.
    fn precision(&self) -> Precision;
    /// Number of channels.
    fn channels(&self) -> usize;
    /// Number of models in its bank (1 for a plain filter).
    fn models(&self) -> usize;
    /// Back to the state before the first sample.
    ///
    /// # Example
    /// ```
    /// # use stillrate_lab::runner::{Precision, build};
    /// # use stillrate_lab::settings_map::{SettingsMap, Value};
    /// # let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
    /// let mut filter = build("pt1", &settings, 1, Precision::Double)?;
    /// let fresh = filter.save();
    /// filter.update(&mut [0.12], None);
    /// filter.reset();
    /// assert_eq!(filter.save(), fresh);
    /// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
    /// ```
    fn reset(&mut self);
    /// One sample a channel, in place, in the unit of the settings (deg/s); `dt_s` is the time since the one before, the nominal period if
    /// `None`.
    fn update(&mut self, values: &mut [f64], dt_s: Option<f64>);
    /// Filters a table; `sink` holds as many numbers as the table. Returns false, and nothing has changed, if shapes or precision do
    /// not fit.
    ///
    /// # Example
    /// ```
    /// # use stillrate_lab::runner::{Precision, Sink, Source, Table, Timing, build};
    /// # use stillrate_lab::settings_map::{SettingsMap, Value};
    /// # let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
    /// let mut filter = build("singer-imm-kf", &settings, 2, Precision::Double)?;
    /// let mut one_by_one = filter.duplicate();
    /// let samples = [0.1, -3.0, 0.2, -2.0, 0.1, -1.0]; // three samples of two channels
    /// let mut rates = [0.0; 6];
    /// let source = Source::Double(Table::contiguous(&samples, 2).unwrap());
    /// assert!(filter.run(source, Timing::Regular, Sink::Double(&mut rates)));
    /// for (row, expected) in samples.chunks(2).zip(rates.chunks(2)) {
    ///     let mut row = row.to_vec();
    ///     one_by_one.update(&mut row, None);
    ///     assert_eq!(row, expected); // to the bit
    /// }
    /// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
    /// ```
    fn run(&mut self, source: Source<'_>, timing: Timing<'_>, sink: Sink<'_>) -> bool;
    /// Filters a table and keeps what happened inside.
    ///
    /// # Example
    /// ```
    /// # use stillrate_lab::runner::{Precision, Source, Table, Timing, build};
    /// # use stillrate_lab::settings_map::{SettingsMap, Value};
    /// # let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
    /// let mut filter = build("singer-imm-kf", &settings, 1, Precision::Double)?;
    /// let samples = [0.1, f64::NAN, 0.2];
    /// let trace = filter.trace(Source::Double(Table::contiguous(&samples, 1).unwrap()), Timing::Regular);
    /// assert_eq!(trace.flags[1], stillrate::Flags::MISSING.0);
    /// assert_eq!(trace.rate[2], filter.estimate(0).rate);
    /// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
    /// ```
    fn trace(&mut self, source: Source<'_>, timing: Timing<'_>) -> Trace;
    /// The last estimate of a channel, however the last sample came in.
    fn estimate(&self, channel: usize) -> LastEstimate;
    /// Configuration and state as versioned, checksummed bytes; [`super::restore`] reads them.
    fn save(&self) -> Vec<u8>;
    /// Another one with the same configuration and state.
    fn duplicate(&self) -> Box<dyn Runner>;
}

/// A filter that can take the numbers of a saved state.
pub(super) trait Restorable: Runner {
    /// Takes the numbers that [`Runner::save`] wrote down.
    ///
    /// # Errors
    /// A sentence, and nothing has changed, if there are not as many numbers as there should be or one of them is not what this
    /// filter can leave behind.
    fn load(&mut self, numbers: &[f64]) -> Result<(), String>;
    /// Whether [`Restorable::load`] takes so many numbers for so many channels.
    fn fits(&self, numbers: usize, channels: usize) -> bool;
}
