//! Known truth: draws of coefficients, simulated heads, studies of the methods on them.

use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate::gimbal::{COUNT, DEFAULT_SCALE, NAMES};
use stillrate_lab::gimbal::{self as lab, Disturbance, Method, Start, Study, Trajectory};

use super::arrays::{table, triples};
use super::settings::{coefficients, get, model_from, settings_from};
use crate::convert::config_error;

pub(super) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(gimbal_draw, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_simulate, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_study, module)?)
}

/// A draw of true coefficients.
#[pyfunction]
fn gimbal_draw(py: Python<'_>, gyro_factor: f64, seed: u64) -> Bound<'_, PyArray1<f64>> {
    PyArray1::from_slice(py, &lab::draw(&DEFAULT_SCALE, gyro_factor, seed))
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
    stillrate::error::positive("dt_s", dt_s, "s").map_err(|e| config_error(py, &e))?;
    if per_interval == 0 || per_interval > 100_000 {
        return Err(PyValueError::new_err(format!("per_interval = {per_interval} (must be 1 to 100000)")));
    }
    let none = Disturbance { sigma_m_s2: 0.0, ..Disturbance::default() };
    let disturbance = Disturbance {
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
    let samples = samples.map_err(|e| config_error(py, &e))?;
    Ok(table(py, &samples.iter().map(|c| c.to_vec()).collect::<Vec<_>>()))
}

/// Draws of a study: one dictionary a seed.
#[pyfunction]
fn gimbal_study<'py>(
    py: Python<'py>,
    method: &str,
    start: &str,
    seeds: Vec<u64>,
    options: &Bound<'py, PyDict>,
    settings: &Bound<'py, PyDict>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let number = |name: &str, default: f64| get(options, name, default);
    let mut settings = settings_from(py, settings)?;
    settings = settings.with_gyro_scale(number("gyro_scale", 1.0)?);
    let method = Method::named(method).ok_or_else(|| PyValueError::new_err(format!("no method {method}")))?;
    let start = match start {
        "zero" => Start::Zero,
        "half" => Start::Half,
        "scattered" => Start::Scattered,
        other => return Err(PyValueError::new_err(format!("no start {other}"))),
    };
    let sigma = number("sigma_m_s2", 1e-6)?;
    let mut extra = [0.0; COUNT];
    for (slot, name) in extra.iter_mut().zip(NAMES) {
        *slot = number(name, 0.0)?;
    }
    let study = Study {
        method,
        settings,
        trajectory: Trajectory::default(),
        disturbance: Disturbance {
            sigma_m_s2: sigma,
            angle_random_walk_deg_sqrt_h: number("angle_random_walk_deg_sqrt_h", 0.0)?,
            quantisation_m_s2: number("quantisation_m_s2", 0.0)?,
            spike_probability: number("spike_probability", 0.0)?,
            spike_m_s2: number("spike_m_s2", 1e-3)?,
            loss_probability: number("loss_probability", 0.0)?,
        },
        sigma_m_s2: number("told_sigma_m_s2", sigma)?,
        gyro_factor: number("gyro_factor", 1.0)?,
        extra,
        start,
        per_interval: 5,
    };
    let draws = py.detach(|| lab::run_study(&study, &seeds)).map_err(|e| config_error(py, &e))?;
    draws
        .iter()
        .map(|draw| {
            let dict = PyDict::new(py);
            dict.set_item("other", draw.score.other)?;
            dict.set_item("kappa", draw.kappa_of_mean_size)?;
            dict.set_item("kappa_of_own_mean", draw.score.kappa)?;
            dict.set_item("over_bound", draw.score.over_bound)?;
            dict.set_item("normalised_error", draw.error_over_bound)?;
            dict.set_item("settling_s", draw.settling_s.to_vec())?;
            dict.set_item("coefficients", draw.outcome.coefficients.to_vec())?;
            dict.set_item("deviation", draw.outcome.deviation.to_vec())?;
            dict.set_item("truth", draw.truth.to_vec())?;
            dict.set_item("diverged", draw.outcome.diverged)?;
            dict.set_item("alarm", draw.tests.map(|t| t.alarm()))?;
            dict.set_item("mean_square_sigma", draw.tests.map(|t| t.mean_square_sigma))?;
            dict.set_item("correlation_sigma", draw.tests.map(|t| t.correlation_sigma))?;
            Ok(dict)
        })
        .collect()
}
