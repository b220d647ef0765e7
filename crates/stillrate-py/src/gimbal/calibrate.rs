//! Calibrations of logs, and their scores against a known truth.

use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate::ConfigError;
use stillrate::gimbal::{COUNT, Coefficients};
use stillrate_lab::gimbal::{self as lab, Method, ResidualTests, Sampling};

use super::arrays::{table, triples};
use super::settings::{coefficients, get, settings_from};
use crate::convert::{config_error, exception};

pub(super) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(gimbal_calibrate, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_score, module)?)
}

/// Rows of all coefficients.
fn wide<'py>(py: Python<'py>, list: &[Coefficients]) -> Bound<'py, PyArray2<f64>> {
    let array = Array2::from_shape_vec((list.len(), COUNT), list.as_flattened().to_vec()).unwrap_or_default();
    PyArray2::from_owned_array(py, array)
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
        lab::LogError::Setting(error) => config_error(py, &error),
        lab::LogError::Data(text) => exception(py, "LogError", &text),
    })?;
    let found = py.detach(|| -> Result<_, ConfigError> {
        let record = prepared.record()?;
        let record = if half_window < usize::MAX { record.with_half_window(half_window) } else { record };
        let outcome = lab::calibrate(&record, method, &settings)?;
        let sampling = Sampling {
            interval_s: record.interval_s(),
            half_window: record.half_window(),
            sigma_m_s2: record.sigma_m_s2(),
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
    let (outcome, bound, hidden) = found.map_err(|e| config_error(py, &e))?;
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
        result.set_item("tests", residual_tests(py, &tests)?)?;
    }
    Ok(result)
}

fn residual_tests<'py>(py: Python<'py>, tests: &ResidualTests) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("mean_square", tests.mean_square)?;
    dict.set_item("mean_square_sigma", tests.mean_square_sigma)?;
    dict.set_item("correlation", tests.correlation.to_vec())?;
    dict.set_item("correlation_sigma", tests.correlation_sigma)?;
    dict.set_item("skipped", tests.skipped)?;
    dict.set_item("outliers", tests.outliers)?;
    dict.set_item("alarm", tests.alarm())?;
    Ok(dict)
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
