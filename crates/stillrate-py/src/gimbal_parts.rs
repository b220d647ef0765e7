//! Single steps of the gimbal model for `stillrate.gimbal`: rotations, axes, one step, outputs, sensitivities; studies and searches.

use nalgebra::{Matrix3, Vector3};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate::gimbal::geometry::{force_axis, gyro_axes};
use stillrate::gimbal::rotation::exponential;
use stillrate::gimbal::{COUNT, Geometry};
use stillrate_lab::gimbal::{self as lab, Disturbance, Method, Sampling, Search, Start, Study, Trajectory};

use super::gimbal::{coefficients, refused, triples};
use super::gimbal_settings::{model_from, settings_from};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(gimbal_rotation, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_axes, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_step, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_output, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_sensitivity, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_convert, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_study, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_plan, module)?)
}

type Rows = Vec<Vec<f64>>;

fn rows(matrix: &Matrix3<f64>) -> Rows {
    (0..3).map(|i| (0..3).map(|j| matrix[(i, j)]).collect()).collect()
}

fn matrix(array: &PyReadonlyArray2<'_, f64>) -> PyResult<Matrix3<f64>> {
    let list = triples(array, "rotation")?;
    if list.len() == 3 {
        Ok(Matrix3::from_fn(|i, j| list[i][j]))
    } else {
        Err(PyValueError::new_err(format!("rotation has {} rows (must be 3)", list.len())))
    }
}

fn vector(array: &PyReadonlyArray1<'_, f64>, name: &str) -> PyResult<Vector3<f64>> {
    let view = array.as_array();
    if view.len() == 3 {
        Ok(Vector3::new(view[0], view[1], view[2]))
    } else {
        Err(PyValueError::new_err(format!("{name} has {} numbers (must be 3)", view.len())))
    }
}

/// exp(+[v x]).
#[pyfunction]
fn gimbal_rotation(v: PyReadonlyArray1<'_, f64>) -> PyResult<Rows> {
    Ok(rows(&exponential(&vector(&v, "v")?)))
}

/// Axes of the three gyros (input, output, spin) and of the three accelerometers (input, d/d(thp), d/d(tho)).
#[pyfunction]
fn gimbal_axes(py: Python<'_>, values: Vec<f64>, settings: &Bound<'_, PyDict>) -> PyResult<(Vec<Rows>, Vec<Rows>)> {
    let model = model_from(py, settings)?;
    let x = coefficients(&values, &[0.0; COUNT])?;
    let list = |v: &Vector3<f64>| v.iter().copied().collect::<Vec<f64>>();
    let gyros = (0..3).map(|i| {
        let axes = gyro_axes(&model.triads.gyro[i], x[15 + i], x[18 + i]);
        vec![list(&axes.input), list(&axes.output), list(&axes.spin)]
    });
    let forces = (0..3).map(|i| {
        let axis = force_axis(&model.triads.accelerometer[i], x[27 + i], x[30 + i]);
        vec![list(&axis.input), list(&axis.by_pendulous_angle), list(&axis.by_output_angle)]
    });
    Ok((gyros.collect(), forces.collect()))
}

/// One step: attitude, platform rate, specific force at mid-step, d(rate)/d(coefficients) by rows.
#[pyfunction]
fn gimbal_step(
    py: Python<'_>,
    values: Vec<f64>,
    rotation: PyReadonlyArray2<'_, f64>,
    command: PyReadonlyArray1<'_, f64>,
    dt_s: f64,
    settings: &Bound<'_, PyDict>,
) -> PyResult<(Rows, Vec<f64>, Vec<f64>, Rows)> {
    let model = model_from(py, settings)?;
    let geometry = Geometry::new(&model, &coefficients(&values, &[0.0; COUNT])?);
    let command = vector(&command, "command")?;
    let step = geometry.step(&model, &matrix(&rotation)?, &command, dt_s);
    let sensitivity = geometry.rate_sensitivity(&model, &step, &command);
    let by_row = (0..3).map(|r| sensitivity.iter().map(|column| column[r]).collect()).collect();
    let list = |v: &Vector3<f64>| v.iter().copied().collect();
    Ok((rows(&step.rotation), list(&step.rate), list(&step.force), by_row))
}

/// Specific force, outputs and d(output)/d(attitude, coefficients) in an attitude.
#[pyfunction]
fn gimbal_output(
    py: Python<'_>,
    values: Vec<f64>,
    rotation: PyReadonlyArray2<'_, f64>,
    settings: &Bound<'_, PyDict>,
) -> PyResult<(Vec<f64>, Vec<f64>, Rows)> {
    let model = model_from(py, settings)?;
    let geometry = Geometry::new(&model, &coefficients(&values, &[0.0; COUNT])?);
    let force = model.force(&matrix(&rotation)?);
    let outputs: Vec<_> = (0..3).map(|i| geometry.output_row(i, &force, &Vector3::zeros())).collect();
    let values = outputs.iter().map(|(z, _)| *z).collect();
    let jacobian = outputs.iter().map(|(_, row)| row.to_vec()).collect();
    Ok((force.iter().copied().collect(), values, jacobian))
}

/// Outputs and their derivatives by attitude at the start and coefficients, at the chosen epochs.
#[pyfunction]
fn gimbal_sensitivity(
    py: Python<'_>,
    values: Vec<f64>,
    command: PyReadonlyArray2<'_, f64>,
    dt_s: f64,
    epochs: Vec<usize>,
    settings: &Bound<'_, PyDict>,
) -> PyResult<Vec<(Vec<f64>, Rows)>> {
    let model = model_from(py, settings)?;
    let x = coefficients(&values, &[0.0; COUNT])?;
    let commands = triples(&command, "command_rad_s")?;
    if let Some(k) = epochs.iter().find(|&&k| k > commands.len()) {
        return Err(PyValueError::new_err(format!("epoch {k} is beyond the {} commands", commands.len())));
    }
    let mut found = vec![(Vec::new(), Vec::new()); epochs.len()];
    lab::sensitivities(&model, &x, &commands, dt_s, |k, _, _, value, jacobian| {
        for (slot, _) in found.iter_mut().zip(&epochs).filter(|(_, wanted)| **wanted == k) {
            *slot = (value.to_vec(), jacobian.iter().map(|row| row.to_vec()).collect());
        }
    });
    Ok(found)
}

/// Coefficients in another gauge (exact).
#[pyfunction]
fn gimbal_convert(py: Python<'_>, values: Vec<f64>, gauge: &str, settings: &Bound<'_, PyDict>) -> PyResult<Vec<f64>> {
    let model = model_from(py, settings)?;
    let x = coefficients(&values, &[0.0; COUNT])?;
    let gauge = match gauge {
        "accelerometer" => stillrate::gimbal::Gauge::Accelerometer,
        "gyro" => stillrate::gimbal::Gauge::Gyro,
        other => return Err(PyValueError::new_err(format!("gauge = {other} (must be accelerometer or gyro)"))),
    };
    Ok(lab::to_gauge(&x, gauge, &model.triads).to_vec())
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
    let number = |name: &str, default: f64| -> PyResult<f64> {
        options.get_item(name)?.map_or(Ok(default), |value| value.extract())
    };
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
    for (slot, name) in extra.iter_mut().zip(stillrate::gimbal::NAMES) {
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
    let draws = py.detach(|| lab::run_study(&study, &seeds)).map_err(|e| refused(py, &e))?;
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

/// A better trajectory within limits: segments and figures.
#[pyfunction]
fn gimbal_plan<'py>(
    py: Python<'py>,
    segments_deg_s: Option<PyReadonlyArray2<'py, f64>>,
    limits: (f64, f64, f64, f64),
    effort: (usize, usize, u64),
    kappa_weight: f64,
    sampling: (usize, f64),
    settings: &Bound<'py, PyDict>,
) -> PyResult<(Rows, Vec<f64>, Vec<f64>)> {
    let settings = settings_from(py, settings)?;
    let (rate_max_deg_s, slew_deg_s2, segment_s, interval_s) = limits;
    let (moves, climbs, seed) = effort;
    let start = Trajectory {
        segments_deg_s: match segments_deg_s {
            Some(array) => triples(&array, "segments_deg_s")?,
            None => lab::DEFAULT_SEGMENTS.iter().map(|s| s.map(|x| x * rate_max_deg_s)).collect(),
        },
        segment_s,
        slew_deg_s2,
        interval_s,
    };
    let sampling = Sampling { interval_s, half_window: sampling.0, sigma_m_s2: sampling.1, ..Sampling::default() };
    let indices = settings.indices().map_err(|e| refused(py, &e))?;
    let search = Search { start, rate_max_deg_s, moves, climbs, kappa_weight, seed };
    let list = |f: &lab::Figures| vec![f.drift, f.g_sensitive, f.kappa, f.mounting, f.accelerometer];
    let found = py.detach(|| -> Result<_, stillrate::ConfigError> {
        let commands = search.start.commands(&settings.model)?;
        let zero = [0.0; COUNT];
        let at_start = lab::bound(&settings.model, &zero, &settings.scale, &indices, &commands, &sampling);
        let before = lab::figures(&at_start, &settings.scale);
        let (best, figures) = lab::plan(&settings.model, &settings.scale, &indices, &sampling, &search)?;
        Ok((best, before, figures))
    });
    let (best, before, after) = found.map_err(|e| refused(py, &e))?;
    Ok((best.segments_deg_s.iter().map(|s| s.to_vec()).collect(), list(&before), list(&after)))
}
