//! Rotations, and gyro bias from a reference attitude.

use nalgebra::{Matrix3, Vector3};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use stillrate::attitude::preintegration::Preintegration;
use stillrate::attitude::reference_bias::{BiasEstimate, BiasSettings, Iteration, NAMES, UNKNOWNS, Unknowns};
use stillrate::attitude::{Body, Navigation, Quaternion, Rotation, check_dcm, earth, project_to_rotation, so3};
use stillrate_lab::reference_bias::{METHODS, Method, Reading, ReferenceLog, reference_bias};
use stillrate_lab::settings_map::SettingsError;

use crate::convert::config_error;

type Rows3 = [[f64; 3]; 3];

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(rotation_exp, module)?)?;
    module.add_function(wrap_pyfunction!(rotation_log, module)?)?;
    module.add_function(wrap_pyfunction!(right_jacobian, module)?)?;
    module.add_function(wrap_pyfunction!(rotation_from_euler, module)?)?;
    module.add_function(wrap_pyfunction!(rotation_from_quaternion, module)?)?;
    module.add_function(wrap_pyfunction!(rotation_check, module)?)?;
    module.add_function(wrap_pyfunction!(position_matrix, module)?)?;
    module.add_function(wrap_pyfunction!(inertial_attitude, module)?)?;
    module.add_function(wrap_pyfunction!(relative_rotation, module)?)?;
    module.add_function(wrap_pyfunction!(preintegrate, module)?)?;
    module.add_function(wrap_pyfunction!(find_reference_bias, module)?)
}

fn rows_of(m: &Matrix3<f64>) -> Vec<Vec<f64>> {
    (0..3).map(|i| (0..3).map(|j| m[(i, j)]).collect()).collect()
}

fn array<'py>(py: Python<'py>, m: &Matrix3<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    Ok(PyArray2::from_vec2(py, &rows_of(m))?)
}

fn matrix(rows: Rows3) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

#[pyfunction]
fn rotation_exp(py: Python<'_>, vector: [f64; 3]) -> PyResult<Bound<'_, PyArray2<f64>>> {
    array(py, &so3::exp(&Vector3::from(vector)))
}

#[pyfunction]
fn rotation_log(py: Python<'_>, rows: Rows3) -> PyResult<Bound<'_, PyArray1<f64>>> {
    let checked = check_dcm(&matrix(rows)).map_err(|error| config_error(py, &error))?;
    Ok(PyArray1::from_slice(py, so3::log(&checked).as_slice()))
}

#[pyfunction]
fn right_jacobian(py: Python<'_>, vector: [f64; 3]) -> PyResult<Bound<'_, PyArray2<f64>>> {
    array(py, &so3::right_jacobian(&Vector3::from(vector)))
}

#[pyfunction]
fn rotation_from_euler(py: Python<'_>, euler: [f64; 3]) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let [roll, pitch, yaw] = euler;
    array(py, Rotation::<f64, Body, Navigation>::from_euler(roll, pitch, yaw).matrix())
}

#[pyfunction]
fn rotation_from_quaternion(py: Python<'_>, wxyz: [f64; 4]) -> PyResult<Bound<'_, PyArray2<f64>>> {
    array(py, &Quaternion::checked(wxyz).map_err(|error| config_error(py, &error))?.matrix())
}

#[pyfunction]
fn rotation_check(py: Python<'_>, rows: Rows3, project: bool) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let given = matrix(rows);
    let checked = if project { project_to_rotation(&given) } else { check_dcm(&given) };
    array(py, &checked.map_err(|error| config_error(py, &error))?)
}

#[pyfunction]
fn position_matrix(py: Python<'_>, latitude: f64, longitude: f64) -> PyResult<Bound<'_, PyArray2<f64>>> {
    array(py, earth::position(latitude, longitude).matrix())
}

#[pyfunction]
fn inertial_attitude(
    py: Python<'_>,
    latitude: f64,
    longitude: f64,
    rows: Rows3,
    elapsed_s: f64,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let attitude = Rotation::checked(matrix(rows)).map_err(|error| config_error(py, &error))?;
    array(py, earth::inertial_attitude(latitude, longitude, attitude, elapsed_s).matrix())
}

/// A' B
#[pyfunction]
fn relative_rotation(py: Python<'_>, first: Rows3, second: Rows3) -> PyResult<Bound<'_, PyArray2<f64>>> {
    array(py, &(matrix(first).transpose() * matrix(second)))
}

/// Rotation and bias Jacobian of a stretch of rates with a bias taken off.
#[pyfunction]
fn preintegrate(
    py: Python<'_>,
    rates: Vec<[f64; 3]>,
    dt_s: Vec<f64>,
    bias: [f64; 3],
) -> PyResult<(Bound<'_, PyArray2<f64>>, Bound<'_, PyArray2<f64>>)> {
    if rates.len() != dt_s.len() {
        return Err(PyValueError::new_err(format!("dt_s has {} entries for {} samples", dt_s.len(), rates.len())));
    }
    let mut turn = Preintegration::new();
    for (rate, dt) in rates.into_iter().zip(dt_s) {
        turn.advance(Vector3::from(rate) - Vector3::from(bias), dt);
    }
    Ok((array(py, &turn.rotation)?, array(py, &turn.bias_jacobian)?))
}

fn number(options: &Bound<'_, PyDict>, name: &str, into: &mut f64) -> PyResult<()> {
    if let Some(value) = options.get_item(name)? {
        *into = value.extract()?;
    }
    Ok(())
}

fn flag(options: &Bound<'_, PyDict>, name: &str, otherwise: bool) -> PyResult<bool> {
    options.get_item(name)?.map_or(Ok(otherwise), |value| value.extract())
}

fn settings_of(options: &Bound<'_, PyDict>) -> PyResult<BiasSettings> {
    let mut settings = BiasSettings::default();
    number(options, "angle_random_walk_rad_sqrt_s", &mut settings.angle_random_walk_rad_sqrt_s)?;
    number(options, "reference_sigma_rad", &mut settings.reference_sigma_rad)?;
    number(options, "prior_bias_rad_s", &mut settings.prior_bias_rad_s)?;
    number(options, "prior_mounting_rad", &mut settings.prior_mounting_rad)?;
    number(options, "prior_lag_s", &mut settings.prior_lag_s)?;
    number(options, "prior_scale", &mut settings.prior_scale)?;
    number(options, "tolerance", &mut settings.tolerance)?;
    settings.estimate_mounting = flag(options, "estimate_mounting", false)?;
    settings.estimate_lag = flag(options, "estimate_lag", false)?;
    settings.estimate_scale = flag(options, "estimate_scale", false)?;
    settings.use_prior = flag(options, "use_prior", false)?;
    if let Some(value) = options.get_item("max_iterations")? {
        settings.max_iterations = value.extract()?;
    }
    Ok(settings)
}

/// `log`: rates (n, 3), steps (n), fix indices, matrices, latitudes, longitudes.
#[pyfunction]
fn find_reference_bias<'py>(
    py: Python<'py>,
    rates: Vec<[f64; 3]>,
    dt_s: Vec<f64>,
    fix_index: Vec<usize>,
    c_b_n: Vec<Rows3>,
    latitude: Vec<f64>,
    longitude: Vec<f64>,
    method: &str,
    options: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let log = ReferenceLog {
        rate_rad_s: rates,
        dt_s,
        fix_index,
        c_b_n: c_b_n.into_iter().map(matrix).collect(),
        latitude_rad: latitude,
        longitude_rad: longitude,
    };
    let Some(method) = METHODS.iter().find(|(name, _)| *name == method).map(|(_, method)| *method) else {
        let known: Vec<&str> = METHODS.iter().map(|(name, _)| *name).collect();
        let text = format!("method = '{method}' (must be one of {})", known.join(", "));
        return Err(config_error(py, &SettingsError::Text(text)));
    };
    let reading = Reading {
        earth_rate: flag(options, "earth_rate", true)?,
        instantaneous: flag(options, "instantaneous", false)?,
        project: flag(options, "project", false)?,
    };
    let settings = settings_of(options)?;
    let mut start = Unknowns::<f64>::default();
    if let Some(rows) = options.get_item("mounting")? {
        start.mounting = check_dcm(&matrix(rows.extract()?)).map_err(|error| config_error(py, &error))?;
    }
    number(options, "lag_s", &mut start.lag_s)?;
    let found = py
        .detach(|| reference_bias(&log, reading, &settings, start, method))
        .map_err(|error| config_error(py, &error))?;
    let dict = PyDict::new(py);
    dict.set_item("bias_rad_s", PyArray1::from_slice(py, found.bias_rad_s.as_slice()))?;
    if let (Some(estimate), Method::Exact) = (&found.exact, method) {
        describe(py, &dict, estimate, &settings)?;
        let steps = found.history.iter().map(|step| iteration(py, step)).collect::<PyResult<Vec<_>>>()?;
        dict.set_item("history", PyList::new(py, steps)?)?;
    }
    Ok(dict)
}

fn iteration<'py>(py: Python<'py>, step: &Iteration<f64>) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("bias_rad_s", PyArray1::from_slice(py, step.bias.as_slice()))?;
    dict.set_item("rotation", array(py, &step.rotation)?)?;
    dict.set_item("jacobian_s", array(py, &step.jacobian)?)?;
    dict.set_item("residual_rad", PyArray1::from_slice(py, step.delta.as_slice()))?;
    Ok(dict)
}

fn describe(
    py: Python<'_>,
    dict: &Bound<'_, PyDict>,
    estimate: &BiasEstimate<f64>,
    settings: &BiasSettings,
) -> PyResult<()> {
    let priors = settings.priors::<f64>();
    let used: Vec<usize> = (0..UNKNOWNS).filter(|&k| priors[k] > 0.0).collect();
    let covariance: Vec<f64> =
        used.iter().flat_map(|&i| used.iter().map(move |&j| estimate.covariance[i][j])).collect();
    let shape = [used.len(), used.len()];
    dict.set_item("covariance", covariance.into_pyarray(py).reshape(shape)?)?;
    dict.set_item("names", used.iter().map(|&k| NAMES[k]).collect::<Vec<_>>())?;
    let directions: Vec<f64> =
        used.iter().flat_map(|&i| (0..estimate.dimension).map(move |k| estimate.directions[i][k])).collect();
    dict.set_item("directions", directions.into_pyarray(py).reshape(shape)?)?;
    let values = &estimate.singular_values[..estimate.dimension];
    dict.set_item("singular_values", PyArray1::from_slice(py, values))?;
    let ratios: Vec<f64> = used.iter().map(|&k| estimate.posterior_over_prior[k]).collect();
    dict.set_item("posterior_over_prior", ratios.into_pyarray(py))?;
    let unknowns = &estimate.unknowns;
    dict.set_item("mounting_rad", PyArray1::from_slice(py, so3::log(&unknowns.mounting).as_slice()))?;
    dict.set_item("lag_s", unknowns.lag_s)?;
    dict.set_item("scale", PyArray1::from_slice(py, unknowns.scale.as_slice()))?;
    dict.set_item("chi_square", estimate.chi_square)?;
    dict.set_item("degrees_of_freedom", estimate.degrees_of_freedom)?;
    dict.set_item("condition", estimate.condition())?;
    dict.set_item("rank", estimate.rank)?;
    dict.set_item("observable", estimate.observable())?;
    dict.set_item("iterations", estimate.iterations)?;
    dict.set_item("converged", estimate.converged)
}
