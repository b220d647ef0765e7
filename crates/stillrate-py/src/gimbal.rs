//! `stillrate.gimbal`: arrays in, dictionaries of arrays out; all arithmetic is in the two crates.

use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate::ConfigError;
use stillrate::gimbal::{COUNT, Coefficients, DEFAULT_SCALE, NAMES};
use stillrate_lab::gimbal::{self as lab, Method, Sampling};

use crate::convert::{config_error, exception};

use super::gimbal_parts;
use super::gimbal_settings::{get, model_from, settings_from};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(gimbal_names, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_calibrate, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_bound, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_trajectory, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_simulate, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_draw, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_score, module)?)?;
    gimbal_parts::register(module)
}

/// An error of the core as `stillrate.ConfigError`.
pub(crate) fn refused(py: Python<'_>, error: &ConfigError) -> PyErr {
    config_error(py, error)
}

/// Rows of three.
pub(crate) fn triples(array: &PyReadonlyArray2<'_, f64>, name: &str) -> PyResult<Vec<[f64; 3]>> {
    if array.shape()[1] != 3 {
        return Err(PyValueError::new_err(format!("{name} has shape {:?} (must be (n, 3))", array.shape())));
    }
    Ok(array.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect())
}

/// A vector of up to 41 coefficients over a default.
pub(crate) fn coefficients(values: &[f64], default: &Coefficients) -> PyResult<Coefficients> {
    if values.len() > COUNT {
        return Err(PyValueError::new_err(format!("{} coefficients (there are {COUNT})", values.len())));
    }
    let mut all = *default;
    all[..values.len()].copy_from_slice(values);
    Ok(all)
}

pub(crate) fn table<'py>(py: Python<'py>, rows: &[Vec<f64>]) -> Bound<'py, PyArray2<f64>> {
    let columns = rows.first().map_or(0, Vec::len);
    let flat: Vec<f64> = rows.iter().flatten().copied().collect();
    let array = Array2::from_shape_vec((rows.len(), columns), flat).unwrap_or_default();
    PyArray2::from_owned_array(py, array)
}

/// Rows of all coefficients.
fn wide<'py>(py: Python<'py>, list: &[Coefficients]) -> Bound<'py, PyArray2<f64>> {
    let array = Array2::from_shape_vec((list.len(), COUNT), list.as_flattened().to_vec()).unwrap_or_default();
    PyArray2::from_owned_array(py, array)
}

/// Names of all coefficients.
#[pyfunction]
fn gimbal_names() -> Vec<&'static str> {
    NAMES.to_vec()
}

/// Calibrates a log; everything it found, as a dictionary.
#[pyfunction]
fn gimbal_calibrate<'py>(
    py: Python<'py>,
    command: PyReadonlyArray2<'py, f64>,
    samples: PyReadonlyArray2<'py, f64>,
    dt_s: f64,
    sigma_m_s2: Option<f64>,
    method: &str,
    settings: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let half_window = get(settings, "half_window", usize::MAX)?;
    let diagnose = get(settings, "diagnose", false)?;
    let bounds = get(settings, "bounds", true)?;
    let settings = settings_from(py, settings)?;
    let Some(method) = Method::named(method) else {
        let names: Vec<&str> = Method::NAMED.iter().map(|(name, _)| *name).collect();
        return Err(exception(py, "ConfigError", &format!("method = {method} (must be one of {})", names.join(", "))));
    };
    let commands = triples(&command, "command_rad_s")?;
    let samples = triples(&samples, "specific_force_m_s2")?;
    let prepared = lab::prepare(&settings.model, &commands, &samples, dt_s, sigma_m_s2).map_err(|e| match e {
        lab::LogError::Setting(error) => refused(py, &error),
        lab::LogError::Data(text) => exception(py, "LogError", &text),
    })?;
    let found = py.detach(|| -> Result<_, ConfigError> {
        let record = prepared.record()?;
        let record = if half_window < usize::MAX { record.with_half_window(half_window) } else { record };
        let outcome = lab::calibrate(&record, method, &settings)?;
        let sampling = Sampling {
            interval_s: record.interval_s(),
            half_window: record.half_window(),
            sigma_m_s2: record.sigma(),
            skip_jumps: false,
            cut_off_rad: settings.cut_off_rad,
        };
        let at = if outcome.diverged { settings.prior } else { outcome.coefficients };
        let bound = bounds.then(|| {
            lab::bound(&settings.model, &at, &settings.scale, &outcome.indices, &prepared.commands, &sampling)
        });
        let hidden = if diagnose { lab::hidden(&record, &settings)? } else { Vec::new() };
        Ok((outcome, bound, hidden))
    });
    let (outcome, bound, hidden) = found.map_err(|e| refused(py, &e))?;
    let result = PyDict::new(py);
    result.set_item("coefficients", PyArray1::from_slice(py, &outcome.coefficients))?;
    result.set_item("deviation", PyArray1::from_slice(py, &outcome.deviation))?;
    result.set_item("indices", outcome.indices.clone())?;
    result.set_item("history_time_s", PyArray1::from_slice(py, &outcome.history.time_s))?;
    result.set_item("history", wide(py, &outcome.history.coefficients))?;
    result.set_item("history_deviation", wide(py, &outcome.history.deviation))?;
    result.set_item("diverged", outcome.diverged)?;
    result.set_item("steps", outcome.steps)?;
    result.set_item("cost", outcome.cost)?;
    result.set_item("observations", outcome.observations)?;
    result.set_item("sigma_m_s2", prepared.sigma_m_s2)?;
    result.set_item("interval_s", prepared.interval_s)?;
    result.set_item("missing", prepared.missing)?;
    let deviation = bound.as_ref().map_or([f64::NAN; COUNT], |b| b.deviation);
    result.set_item("bound", PyArray1::from_slice(py, &deviation))?;
    result.set_item("kappa_bound", bound.as_ref().map_or(f64::NAN, |b| b.kappa_deviation))?;
    result.set_item("unobservable", bound.as_ref().map_or_else(Vec::new, |b| b.unobservable(&settings.scale)))?;
    result.set_item("weakest", bound.as_ref().map_or_else(Vec::new, |b| b.weakest(4)))?;
    result.set_item("hidden", hidden)?;
    if let Some(tests) = outcome.tests {
        let dict = PyDict::new(py);
        dict.set_item("mean_square", tests.mean_square)?;
        dict.set_item("mean_square_sigma", tests.mean_square_sigma)?;
        dict.set_item("correlation", tests.correlation.to_vec())?;
        dict.set_item("correlation_sigma", tests.correlation_sigma)?;
        dict.set_item("skipped", tests.skipped)?;
        dict.set_item("outliers", tests.outliers)?;
        dict.set_item("alarm", tests.alarm())?;
        result.set_item("tests", dict)?;
    }
    Ok(result)
}

/// Cramer-Rao bound of a run before it is made.
#[pyfunction]
fn gimbal_bound<'py>(
    py: Python<'py>,
    command: PyReadonlyArray2<'py, f64>,
    dt_s: f64,
    sigma_m_s2: f64,
    half_window: usize,
    skip_jumps: bool,
    settings: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let settings = settings_from(py, settings)?;
    let commands = triples(&command, "command_rad_s")?;
    stillrate::error::positive("dt_s", dt_s, "s").map_err(|e| refused(py, &e))?;
    stillrate::error::positive("sigma_m_s2", sigma_m_s2, "m/s^2").map_err(|e| refused(py, &e))?;
    let indices = settings.indices().map_err(|e| refused(py, &e))?;
    let sampling =
        Sampling { interval_s: dt_s, half_window, sigma_m_s2, skip_jumps, cut_off_rad: settings.cut_off_rad };
    let bound =
        py.detach(|| lab::bound(&settings.model, &settings.prior, &settings.scale, &indices, &commands, &sampling));
    let result = PyDict::new(py);
    result.set_item("deviation", PyArray1::from_slice(py, &bound.deviation))?;
    result.set_item("singular_values", PyArray1::from_slice(py, &bound.singular_values))?;
    result.set_item("directions", table(py, &bound.directions))?;
    result.set_item("indices", bound.indices.clone())?;
    result.set_item("kappa_deviation", bound.kappa_deviation)?;
    result.set_item("weakest", bound.weakest(5))?;
    result.set_item("unobservable", bound.unobservable(&settings.scale))?;
    Ok(result)
}

/// Commands of a tumbling programme, rad/s.
#[pyfunction]
fn gimbal_trajectory<'py>(
    py: Python<'py>,
    segments_deg_s: Option<PyReadonlyArray2<'py, f64>>,
    segment_s: f64,
    slew_deg_s2: f64,
    interval_s: f64,
    settings: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let model = model_from(py, settings)?;
    let segments_deg_s = match segments_deg_s {
        Some(array) => triples(&array, "segments_deg_s")?,
        None => lab::DEFAULT_SEGMENTS.to_vec(),
    };
    let trajectory = lab::Trajectory { segments_deg_s, segment_s, slew_deg_s2, interval_s };
    let commands = trajectory.commands(&model).map_err(|e| refused(py, &e))?;
    Ok(table(py, &commands.iter().map(|c| c.to_vec()).collect::<Vec<_>>()))
}

/// Accelerometer samples of a run with disturbances.
#[pyfunction]
fn gimbal_simulate<'py>(
    py: Python<'py>,
    values: Vec<f64>,
    command: PyReadonlyArray2<'py, f64>,
    dt_s: f64,
    per_interval: usize,
    disturbance: &Bound<'py, PyDict>,
    seed: u64,
    settings: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let model = model_from(py, settings)?;
    let truth = coefficients(&values, &[0.0; COUNT])?;
    let commands = triples(&command, "command_rad_s")?;
    stillrate::error::positive("dt_s", dt_s, "s").map_err(|e| refused(py, &e))?;
    if per_interval == 0 || per_interval > 100_000 {
        return Err(PyValueError::new_err(format!("per_interval = {per_interval} (must be 1 to 100000)")));
    }
    let none = lab::Disturbance { sigma_m_s2: 0.0, ..lab::Disturbance::default() };
    let disturbance = lab::Disturbance {
        sigma_m_s2: get(disturbance, "sigma_m_s2", none.sigma_m_s2)?,
        angle_random_walk_deg_sqrt_h: get(disturbance, "angle_random_walk_deg_sqrt_h", 0.0)?,
        quantisation_m_s2: get(disturbance, "quantisation_m_s2", 0.0)?,
        spike_probability: get(disturbance, "spike_probability", 0.0)?,
        spike_m_s2: get(disturbance, "spike_m_s2", none.spike_m_s2)?,
        loss_probability: get(disturbance, "loss_probability", 0.0)?,
    };
    let walk = disturbance.angle_random_walk_deg_sqrt_h;
    let samples = py.detach(|| {
        let clean = lab::outputs(&model, &truth, &commands, dt_s, per_interval, 2, walk, seed);
        lab::disturb(&clean, &disturbance, seed)
    });
    let samples = samples.map_err(|e| refused(py, &e))?;
    Ok(table(py, &samples.iter().map(|c| c.to_vec()).collect::<Vec<_>>()))
}

/// A draw of true coefficients.
#[pyfunction]
fn gimbal_draw(py: Python<'_>, gyro_factor: f64, seed: u64) -> Bound<'_, PyArray1<f64>> {
    PyArray1::from_slice(py, &lab::draw(&DEFAULT_SCALE, gyro_factor, seed))
}

/// Errors of a history of estimates: other, kappa, all and rms over bound of each row.
#[pyfunction]
fn gimbal_score<'py>(
    py: Python<'py>,
    estimates: PyReadonlyArray2<'py, f64>,
    truth: Vec<f64>,
    bound: PyReadonlyArray1<'py, f64>,
    indices: Vec<usize>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let truth = coefficients(&truth, &[0.0; COUNT])?;
    let bound = coefficients(&bound.as_array().to_vec(), &[f64::NAN; COUNT])?;
    let mut rows = Vec::new();
    for row in estimates.as_array().rows() {
        let estimate = coefficients(&row.to_vec(), &[0.0; COUNT])?;
        let score = lab::score(&estimate, &truth, &bound, &indices);
        rows.push(vec![score.other, score.kappa, score.all, score.over_bound]);
    }
    Ok(table(py, &rows))
}
