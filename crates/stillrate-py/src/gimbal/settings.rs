//! Settings of `stillrate.gimbal` from a dictionary: place, build, gauge, optional states.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate::gimbal::{COUNT, Coefficients, DEFAULT_SCALE, Gauge, Model, Options, Reference, Triads};
use stillrate_lab::gimbal::Settings;

use crate::convert::{config_error, exception};

/// A vector of up to 41 coefficients over a default.
pub(super) fn coefficients(values: &[f64], default: &Coefficients) -> PyResult<Coefficients> {
    if values.len() > COUNT {
        return Err(PyValueError::new_err(format!("{} coefficients (there are {COUNT})", values.len())));
    }
    let mut all = *default;
    all[..values.len()].copy_from_slice(values);
    Ok(all)
}

/// Takes what is in the dictionary under a name, or the default.
pub(super) fn get<'py, V>(settings: &Bound<'py, PyDict>, name: &str, default: V) -> PyResult<V>
where
    V: for<'a> FromPyObject<'a, 'py>,
{
    match settings.get_item(name)? {
        Some(value) if !value.is_none() => {
            value.extract::<V>().map_err(|_| PyValueError::new_err(format!("{name} = {value} cannot be used")))
        }
        _ => Ok(default),
    }
}

fn triad(rows: &[Vec<usize>], default: [[usize; 3]; 3]) -> PyResult<[[usize; 3]; 3]> {
    if rows.is_empty() {
        return Ok(default);
    }
    let row = |i: usize| rows.get(i).and_then(|r| <[usize; 3]>::try_from(r.as_slice()).ok());
    match (rows.len(), row(0), row(1), row(2)) {
        (3, Some(a), Some(b), Some(c)) => Ok([a, b, c]),
        _ => Err(PyValueError::new_err("triads must be three rows of three axes (0, 1, 2)")),
    }
}

/// Place and build of a head.
pub(super) fn model_from(py: Python<'_>, settings: &Bound<'_, PyDict>) -> PyResult<Model> {
    let gravity = get(settings, "gravity_m_s2", 9.8)?;
    let latitude = get(settings, "latitude_rad", 40.0_f64.to_radians())?;
    let mut model = Model::new(gravity, latitude).map_err(|e| config_error(py, &e))?;
    model.earth_rate_rad_s = get(settings, "earth_rate_rad_s", model.earth_rate_rad_s)?;
    if !model.earth_rate_rad_s.is_finite() {
        return Err(PyValueError::new_err("earth_rate_rad_s must be finite"));
    }
    model.refined = get(settings, "refined", true)?;
    model.triads = Triads {
        gyro: triad(&get(settings, "gyro_triads", Vec::new())?, model.triads.gyro)?,
        accelerometer: triad(&get(settings, "accelerometer_triads", Vec::new())?, model.triads.accelerometer)?,
    };
    model.triads.check().map_err(|e| config_error(py, &e))?;
    Ok(model)
}

/// Everything about a calibration but the record.
pub(super) fn settings_from(py: Python<'_>, dict: &Bound<'_, PyDict>) -> PyResult<Settings> {
    let mut settings = Settings::new(model_from(py, dict)?);
    let wrong = |name: &str, value: &str, range: &str| {
        exception(py, "ConfigError", &format!("{name} = {value} (must be {range})"))
    };
    settings.gauge = match get(dict, "gauge", "accelerometer".to_owned())?.as_str() {
        "accelerometer" => Gauge::Accelerometer,
        "gyro" => Gauge::Gyro,
        "none" => Gauge::None,
        other => return Err(wrong("gauge", other, "accelerometer, gyro or none")),
    };
    settings.reference = match get(dict, "reference", "model".to_owned())?.as_str() {
        "model" => Reference::Model,
        "commanded" => Reference::Commanded,
        other => return Err(wrong("reference", other, "model or commanded")),
    };
    settings.options = Options {
        torquer: get(dict, "torquer", false)?,
        quadratic: get(dict, "quadratic", false)?,
        latency: get(dict, "latency", false)?,
        latitude: get(dict, "latitude", false)?,
    };
    settings.scale = coefficients(&get(dict, "scale", Vec::new())?, &DEFAULT_SCALE)?;
    settings.prior = coefficients(&get(dict, "prior", Vec::new())?, &[0.0; COUNT])?;
    settings.robust = get(dict, "robust", true)?;
    settings.second_order = get(dict, "second_order", settings.second_order)?;
    settings.angle_random_walk_deg_sqrt_h = get(dict, "angle_random_walk_deg_sqrt_h", 0.0)?;
    settings.cut_off_rad = get(dict, "cut_off_rad", 0.0)?;
    settings.single = get(dict, "single", false)?;
    settings.every = get(dict, "every", 4)?;
    Ok(settings)
}
