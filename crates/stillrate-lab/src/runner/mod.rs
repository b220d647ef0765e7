//! One face for every method: a filter built by name, with its channels, run over arrays or sample by sample.
//!
//! The numerics stay in the core; this module moves samples between arrays of any stride and the small tiles of
//! rows that [`stillrate::Filter::tile`] works on, chooses the widest vector instructions of the machine once a tile, and
//! keeps the state between calls. Batch, chunked and streamed runs therefore give the same bits.

use stillrate::{ConfigError, Settings};

use crate::saved;
use crate::settings_map::{SettingsError, SettingsMap, from_map, hint};

mod running;
mod table;
mod watched;

use running::Running;
pub use table::{Precision, Sink, Source, Table, Timing};
pub use watched::{LastEstimate, Trace};

/// A filter with its channels, whatever the method and precision.
pub trait Runner: Send {
    /// Name of the method.
    fn method(&self) -> &'static str;
    /// Every setting, by name.
    fn settings(&self) -> SettingsMap;
    /// Number type it computes in.
    fn precision(&self) -> Precision;
    /// Number of channels.
    fn channels(&self) -> usize;
    /// Number of models in its bank.
    fn models(&self) -> usize;
    /// Back to the state before the first sample.
    fn reset(&mut self);
    /// One sample a channel, in place; `dt_s` is the nominal period if `None`.
    fn update(&mut self, values: &mut [f64], dt_s: Option<f64>);
    /// Filters a table; `sink` holds as many numbers as the table. Returns false if shapes or precision do not fit.
    fn run(&mut self, source: Source<'_>, timing: Timing<'_>, sink: Sink<'_>) -> bool;
    /// Filters a table and keeps what happened inside.
    fn trace(&mut self, source: Source<'_>, timing: Timing<'_>) -> Trace;
    /// The last estimate of a channel from [`Runner::update`] or [`Runner::trace`], of what is known after [`Runner::run`].
    fn estimate(&self, channel: usize) -> LastEstimate;
    /// Configuration and state as versioned, checksummed bytes.
    fn save(&self) -> Vec<u8>;
    /// Takes a state that [`Runner::save`] wrote.
    ///
    /// # Errors
    /// A sentence, and nothing has changed, if there are not as many numbers as there should be or one of them is not what this
    /// filter can leave behind.
    fn load(&mut self, numbers: &[f64]) -> Result<(), String>;
    /// Whether [`Runner::load`] takes so many numbers for so many channels.
    fn fits(&self, numbers: usize, channels: usize) -> bool;
    /// Another one with the same configuration and state.
    fn duplicate(&self) -> Box<dyn Runner>;
}

/// Builds a filter by the name of its method.
///
/// # Errors
/// [`SettingsError`] with the field, value, unit and range, or the nearest known name.
///
/// # Example
/// ```
/// use stillrate_lab::runner::{Precision, build};
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
/// let mut filter = build("pt1", &settings, 1, Precision::Double)?;
/// let mut sample = [0.12];
/// filter.update(&mut sample, None);
/// assert_eq!(sample, [0.12]);
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
pub fn build(
    method: &str,
    settings: &SettingsMap,
    channels: usize,
    precision: Precision,
) -> Result<Box<dyn Runner>, SettingsError> {
    if channels == 0 || channels > 1 << 20 {
        let value = channels as f64;
        return Err(ConfigError::new("channels", value, "", "a whole number from 1 to 1048576").into());
    }
    macro_rules! by_name {
        ($($name:ident),* $(,)?) => {
            match method {
                $(<stillrate::filters::$name as Settings>::METHOD => {
                    start::<stillrate::filters::$name>(settings, channels, precision)
                })*
                other => {
                    let known = [$(<stillrate::filters::$name as Settings>::METHOD),*];
                    let hint = hint(other, &known);
                    Err(SettingsError::Text(format!("no method '{other}' (one of {}){hint}", known.join(", "))))
                }
            }
        };
    }
    stillrate::methods!(by_name)
}

/// Names of all methods.
///
/// # Example
/// ```
/// assert!(stillrate_lab::runner::method_names().contains(&"ms-imm-ikf"));
/// ```
#[must_use]
pub fn method_names() -> Vec<&'static str> {
    macro_rules! names {
        ($($name:ident),* $(,)?) => { vec![$(<stillrate::filters::$name as Settings>::METHOD),*] };
    }
    stillrate::methods!(names)
}

fn start<S: Settings>(
    map: &SettingsMap,
    channels: usize,
    precision: Precision,
) -> Result<Box<dyn Runner>, SettingsError> {
    let settings: S = from_map(map)?;
    Ok(match precision {
        Precision::Single => Box::new(Running::<S, f32>::new(settings, channels)?),
        Precision::Double => Box::new(Running::<S, f64>::new(settings, channels)?),
    })
}

/// Reads a state saved by [`Runner::save`] and continues it.
///
/// # Errors
/// A sentence that says why the bytes are refused: truncated, altered, of another version, or out of range.
///
/// # Example
/// ```
/// use stillrate_lab::runner::{Precision, build, restore};
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
/// let mut filter = build("pt1", &settings, 1, Precision::Double)?;
/// filter.update(&mut [0.12], None);
/// let again = restore(&filter.save())?;
/// assert_eq!(again.estimate(0).rate, filter.estimate(0).rate);
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
pub fn restore(bytes: &[u8]) -> Result<Box<dyn Runner>, SettingsError> {
    let saved = saved::read(bytes).map_err(SettingsError::Text)?;
    // One channel first: a few bytes that speak of a million channels are refused before these are made.
    let single = build(&saved.method, &saved.settings, 1, saved.precision)?;
    if saved.channels == 0 || !single.fits(saved.numbers.len(), saved.channels) {
        return Err(SettingsError::Text("saved state does not fit its configuration".into()));
    }
    let mut runner = build(&saved.method, &saved.settings, saved.channels, saved.precision)?;
    runner.load(&saved.numbers).map_err(SettingsError::Text)?;
    Ok(runner)
}
