//! One face for every method: a filter built by name, with its channels, run over arrays or sample by sample.
//!
//! The numerics stay in the core; this module moves samples between arrays of any stride and the small tiles of
//! rows that [`stillrate::Filter::tile`] works on, chooses the widest vector instructions of the machine once a tile, and
//! keeps the state between calls. Batch, chunked and streamed runs therefore give the same bits.

use stillrate::{ConfigError, Settings};

use crate::saved;
use crate::settings_map::{SettingsError, SettingsMap, from_map, hint};

mod face;
mod running;
mod watched;
mod wide;

pub use crate::samples::{Precision, Sink, Source, Table, Timing};
use face::Restorable;
pub use face::Runner;
use running::Running;
pub use watched::{LastEstimate, Trace};

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
    let runner: Box<dyn Runner> = start(method, settings, channels, precision)?;
    Ok(runner)
}

fn start(
    method: &str,
    settings: &SettingsMap,
    channels: usize,
    precision: Precision,
) -> Result<Box<dyn Restorable>, SettingsError> {
    if channels == 0 || channels > 1 << 20 {
        let value = channels as f64;
        return Err(ConfigError::new("channels", value, "", "a whole number from 1 to 1048576").into());
    }
    macro_rules! by_name {
        ($($name:ident),* $(,)?) => {
            match method {
                $(<stillrate::filters::$name as Settings>::METHOD => {
                    start_of::<stillrate::filters::$name>(settings, channels, precision)
                })*
                other => Err(unknown_method(other)),
            }
        };
    }
    stillrate::methods!(by_name)
}

fn start_of<S: Settings>(
    map: &SettingsMap,
    channels: usize,
    precision: Precision,
) -> Result<Box<dyn Restorable>, SettingsError> {
    let settings: S = from_map(map)?;
    Ok(match precision {
        Precision::Single => Box::new(Running::<S, f32>::new(settings, channels)?),
        Precision::Double => Box::new(Running::<S, f64>::new(settings, channels)?),
    })
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

/// What to tell someone who asked for a method that there is not.
pub(crate) fn unknown_method(name: &str) -> SettingsError {
    let known = method_names();
    let hint = hint(name, &known);
    SettingsError::Text(format!("no method '{name}' (one of {}){hint}", known.join(", ")))
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
    let single = start(&saved.method, &saved.settings, 1, saved.precision)?;
    if saved.channels == 0 || !single.fits(saved.numbers.len(), saved.channels) {
        return Err(SettingsError::Text("saved state does not fit its configuration".into()));
    }
    let mut runner = start(&saved.method, &saved.settings, saved.channels, saved.precision)?;
    runner.load(&saved.numbers).map_err(SettingsError::Text)?;
    Ok(runner)
}
