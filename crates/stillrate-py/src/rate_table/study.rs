//! The simulated turntable and the comparisons on it.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate::correction::ErrorCurve;
use stillrate_lab::random::Random;
use stillrate_lab::rate_table::bed::{SAMPLE_RATE_HZ, Unit, motion_names};
use stillrate_lab::rate_table::study::Study;
use stillrate_lab::rate_table::table3::table3;

use super::value_error;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(rate_table_motions, module)?)?;
    module.add_function(wrap_pyfunction!(rate_table_unit, module)?)?;
    module.add_function(wrap_pyfunction!(rate_table_record, module)?)?;
    module.add_function(wrap_pyfunction!(rate_table_calibration, module)?)?;
    module.add_function(wrap_pyfunction!(rate_table_published, module)?)?;
    module.add_function(wrap_pyfunction!(rate_table_table3, module)?)?;
    module.add_function(wrap_pyfunction!(rate_table_study, module)?)
}

/// Names of the motions in range and of those that jump.
#[pyfunction]
fn rate_table_motions() -> (Vec<&'static str>, Vec<&'static str>) {
    motion_names()
}

/// The unit of a seed; 0 is the nominal one.
fn unit_of(seed: u64) -> Unit {
    if seed == 0 { Unit::NOMINAL } else { Unit::drawn(seed) }
}

/// White noise, error coefficients and drift of a unit.
#[pyfunction]
fn rate_table_unit(seed: u64) -> (f64, [f64; 4], f64, f64) {
    let unit = unit_of(seed);
    (unit.white_dps, unit.error, unit.drift_dps, unit.drift_s)
}

/// What a unit measures of a true record.
#[pyfunction]
fn rate_table_record(
    py: Python<'_>,
    truth: Vec<f64>,
    unit: u64,
    seed: u64,
    sample_rate_hz: f64,
) -> Bound<'_, PyArray1<f64>> {
    PyArray1::from_vec(py, unit_of(unit).measure(&truth, sample_rate_hz, &mut Random::new(seed, 77)))
}

type Pair<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// True and measured rate of a calibration run at 2 kHz.
#[pyfunction]
fn rate_table_calibration(py: Python<'_>, unit: u64, seed: u64, rates: usize, seconds: f64) -> Pair<'_> {
    let (truth, measured) = unit_of(unit).calibration(rates, seconds, &mut Random::new(seed, 78));
    (PyArray1::from_vec(py, truth), PyArray1::from_vec(py, measured))
}

/// True and measured rates of the six records like the published ones.
#[pyfunction]
fn rate_table_published(py: Python<'_>, unit: u64, seed: u64) -> Vec<Pair<'_>> {
    let records = unit_of(unit).published_records(seed);
    records.into_iter().map(|(w, y)| (PyArray1::from_vec(py, w), PyArray1::from_vec(py, y))).collect()
}

/// The layout of the published table: [(method, [mse], [mae])] and the network's curve over a grid: (rate, output, error slope).
#[pyfunction]
fn rate_table_table3(py: Python<'_>, unit: u64, seed: u64, epochs: usize) -> PyResult<Bound<'_, PyDict>> {
    let (rows, curve) = py.detach(|| table3(&unit_of(unit), seed, epochs)).map_err(value_error)?;
    let dict = PyDict::new(py);
    let rows: Vec<(String, Vec<f64>, Vec<f64>)> = rows
        .into_iter()
        .map(|r| (r.method, r.cells.iter().map(|c| c.mse).collect(), r.cells.iter().map(|c| c.mae).collect()))
        .collect();
    dict.set_item("rows", rows)?;
    staircase(py, &dict, &curve)?;
    Ok(dict)
}

/// The published network's output over the measured rate.
fn staircase(py: Python<'_>, dict: &Bound<'_, PyDict>, curve: &ErrorCurve<f64>) -> PyResult<()> {
    let grid: Vec<f64> = (0..=700).map(|k| -7.0 + 0.02 * f64::from(k)).collect();
    let output: Vec<f64> = grid.iter().map(|y| curve.correct(*y, [0.0; 2]).rate).collect();
    let slope: Vec<f64> = grid.iter().map(|y| curve.slope([*y, 0.0, 0.0])).collect();
    dict.set_item("staircase_input", PyArray1::from_vec(py, grid))?;
    dict.set_item("staircase_output", PyArray1::from_vec(py, output))?;
    dict.set_item("staircase_slope", PyArray1::from_vec(py, slope))
}

/// Every method on a unit's held-out motions; `published_epochs` 0 leaves the published network out.
#[pyfunction]
fn rate_table_study(py: Python<'_>, unit: u64, seed: u64, published_epochs: usize) -> PyResult<Bound<'_, PyDict>> {
    let study = py.detach(|| Study::of(&unit_of(unit), seed, published_epochs)).map_err(value_error)?;
    let dict = PyDict::new(py);
    let table: Vec<_> =
        study.rows.into_iter().map(|r| (r.method.clone(), r.overall(), r.in_range, r.jumps, r.outside)).collect();
    dict.set_item("rows", table)?;
    dict.set_item("chosen", study.fit.chosen.name())?;
    dict.set_item("held_out_dps", study.fit.held_out)?;
    dict.set_item("blind", study.blind.each_ref().map(|t| t.log10_ratio))?;
    dict.set_item("seen", study.seen.each_ref().map(|t| t.log10_ratio))?;
    dict.set_item("on_constants", study.on_constants.each_ref().map(|t| t.log10_ratio))?;
    dict.set_item("warned", study.on_constants[0].warnings())?;
    dict.set_item("sample_rate_hz", SAMPLE_RATE_HZ)?;
    Ok(dict)
}
