//! Observability of piecewise constant systems.

use nalgebra::DMatrix;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate_lab::observability::{BENCH_STATES, Problem, Segment, bench_imu, bench_measurement, observability};
use stillrate_lab::settings_map::SettingsError;

use crate::convert::config_error;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(analyse_observability, module)?)?;
    module.add_function(wrap_pyfunction!(bench_imu_model, module)?)
}

type Rows = Vec<Vec<f64>>;

fn dense(rows: &Rows) -> PyResult<DMatrix<f64>> {
    let columns = rows.first().map_or(0, Vec::len);
    if rows.iter().any(|row| row.len() != columns) {
        return Err(PyValueError::new_err("the rows of a matrix have different lengths"));
    }
    Ok(DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j]))
}

fn array<'py>(py: Python<'py>, m: &DMatrix<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat: Vec<f64> = m.row_iter().flat_map(|row| row.iter().copied().collect::<Vec<_>>()).collect();
    flat.into_pyarray(py).reshape([m.nrows(), m.ncols()])
}

/// A and H of the bench IMU.
#[pyfunction]
#[allow(clippy::type_complexity)]
fn bench_imu_model(
    py: Python<'_>,
    euler_rad: [f64; 3],
    latitude_rad: f64,
    gravity_m_s2: f64,
) -> PyResult<(Bound<'_, PyArray2<f64>>, Bound<'_, PyArray2<f64>>, Vec<&'static str>)> {
    let dynamics = bench_imu(euler_rad, latitude_rad, gravity_m_s2);
    Ok((array(py, &dynamics)?, array(py, &bench_measurement())?, BENCH_STATES.to_vec()))
}

/// One entry of `dynamics`, `measurement` and `duration_s` a segment.
#[pyfunction]
fn analyse_observability(
    py: Python<'_>,
    dynamics: Vec<Rows>,
    measurement: Vec<Rows>,
    duration_s: Vec<f64>,
    interval_s: f64,
    measurement_sigma: Vec<f64>,
    prior_sigma: Vec<f64>,
    process_density: Vec<f64>,
) -> PyResult<Bound<'_, PyDict>> {
    let segments = dynamics
        .iter()
        .zip(&measurement)
        .zip(duration_s)
        .map(|((a, h), duration_s)| Ok(Segment { dynamics: dense(a)?, measurement: dense(h)?, duration_s }))
        .collect::<PyResult<Vec<_>>>()?;
    let problem = Problem { segments, interval_s, measurement_sigma, prior_sigma, process_density };
    let report =
        py.detach(|| observability(&problem)).map_err(|error| config_error(py, &SettingsError::Value(error)))?;
    let dict = PyDict::new(py);
    let list = |values: &[f64]| PyArray1::from_slice(py, values);
    dict.set_item("local_ranks", report.local_ranks)?;
    dict.set_item("stacked_ranks", report.stacked_ranks)?;
    dict.set_item("total_rank", report.total_rank)?;
    dict.set_item("singular_values", list(&report.stacked_singular_values))?;
    dict.set_item("singular_values_scaled", list(&report.stacked_singular_values_scaled))?;
    dict.set_item("total_singular_values_scaled", list(&report.total_singular_values_scaled))?;
    dict.set_item("gramian", array(py, &report.gramian)?)?;
    dict.set_item("gramian_eigenvalues", list(&report.gramian_eigenvalues))?;
    dict.set_item("posterior_sigma", list(&report.posterior_sigma))?;
    dict.set_item("posterior_over_prior", list(&report.posterior_over_prior))?;
    dict.set_item("riccati_over_prior", list(&report.riccati_over_prior))?;
    dict.set_item("tenth_of_prior_s", list(&report.tenth_of_prior_s))?;
    let weak: Vec<(f64, Vec<f64>)> =
        report.weak_directions.into_iter().map(|weak| (weak.over_prior, weak.components)).collect();
    dict.set_item("weak_directions", weak)?;
    Ok(dict)
}
