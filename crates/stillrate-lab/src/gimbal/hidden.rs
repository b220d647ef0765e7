//! Which effect that was not modelled explains a record that fails its residual tests?
//!
//! The same record is calibrated once more with every optional state switched on; each comes back with its estimate, standard deviation and the
//! quotient. Only what a state exists for can be named; a wrong gravity is a pure scale error of the accelerometers and no test sees it.

use stillrate::ConfigError;
use stillrate::gimbal::coefficients::TORQUER;
use stillrate::gimbal::{COUNT, NAMES, Options, Record};

use super::calibrate::calibrate;
use super::settings::{Method, Settings};

/// Name of an optional coefficient, its estimate, its standard deviation (both SI) and their quotient.
pub type Hidden = (&'static str, f64, f64, f64);

/// What every optional coefficient is found to be.
///
/// # Errors
/// [`ConfigError`] if the settings do not fit.
///
/// # Example
/// Accelerometers that are 1 ms late, on a head that is not known to be:
/// ```
/// use stillrate::gimbal::{DEFAULT_SCALE, Model, Record, coefficients::LATENCY};
/// use stillrate_lab::gimbal::{Disturbance, Settings, Trajectory, disturb, draw, hidden, outputs};
/// let model = Model::new(9.8, 0.7)?;
/// let commands = Trajectory::default().commands(&model)?;
/// let mut truth = draw(&DEFAULT_SCALE, 1.0, 1);
/// truth[LATENCY] = 1e-3;
/// let samples = disturb(&outputs(&model, &truth, &commands, 0.25, 5, 1, 0.0, 1), &Disturbance::default(), 2)?;
/// let record = Record::new(&commands, &samples, 0.25, 1e-6)?;
/// let found = hidden(&record, &Settings::new(model))?;
/// let (name, value, _, in_deviations) = found[6];
/// assert!(name == "latency" && (value - 1e-3).abs() < 1e-6 && in_deviations > 100.0);
/// assert!(found[0].3.abs() < 5.0); // no torquer error
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub fn hidden(record: &Record<'_>, settings: &Settings) -> Result<Vec<Hidden>, ConfigError> {
    let mut settings = *settings;
    settings.options = Options { torquer: true, quadratic: true, latency: true, latitude: true };
    settings.every = usize::MAX;
    let outcome = calibrate(record, Method::Relinearised, &settings)?;
    Ok((TORQUER..COUNT)
        .map(|i| {
            let (value, deviation) = (outcome.coefficients[i], outcome.deviation[i]);
            (NAMES[i], value, deviation, value / deviation)
        })
        .collect())
}
