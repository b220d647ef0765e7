//! Which effect that was not modelled explains a record that fails its residual tests?
//!
//! The same record is calibrated once more with every optional state switched on; each comes back with its estimate, standard deviation and the
//! quotient. Only what a state exists for can be named; a wrong gravity is a pure scale error of the accelerometers and no test sees it.

use stillrate::ConfigError;
use stillrate::gimbal::coefficients::TORQUER;
use stillrate::gimbal::{COUNT, NAMES, Options, Record};

use super::calibrate::calibrate;
use super::settings::{Method, Settings};

/// Name, estimate, standard deviation (SI) and their quotient of every optional coefficient.
///
/// # Errors
/// [`ConfigError`] if the settings do not fit.
pub fn hidden(record: &Record<'_>, settings: &Settings) -> Result<Vec<(String, f64, f64, f64)>, ConfigError> {
    let mut settings = *settings;
    settings.options = Options { torquer: true, quadratic: true, latency: true, latitude: true };
    settings.every = usize::MAX;
    let outcome = calibrate(record, Method::Relinearised, &settings)?;
    Ok((TORQUER..COUNT)
        .map(|i| {
            let (value, deviation) = (outcome.coefficients[i], outcome.deviation[i]);
            (NAMES[i].to_owned(), value, deviation, value / deviation)
        })
        .collect())
}
