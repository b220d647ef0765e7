//! The exact model in single steps: rotations, axes, one step, outputs, sensitivities, gauges.

use nalgebra::Vector3;
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate::gimbal::rotation::exponential;
use stillrate::gimbal::{COUNT, Gauge, Geometry, NAMES};
use stillrate_lab::gimbal as lab;

use super::arrays::{Rows, matrix, rows, triples, vector};
use super::settings::{coefficients, model_from};

pub(super) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(gimbal_names, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_rotation, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_axes, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_step, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_output, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_sensitivity, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_convert, module)?)
}

/// Names of all coefficients.
#[pyfunction]
fn gimbal_names() -> Vec<&'static str> {
    NAMES.to_vec()
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
    let geometry = Geometry::new(&model, &coefficients(&values, &[0.0; COUNT])?);
    let list = |v: &Vector3<f64>| v.iter().copied().collect::<Vec<f64>>();
    let gyros = geometry.gyros.iter().map(|axes| vec![list(&axes.input), list(&axes.output), list(&axes.spin)]);
    let forces = geometry
        .forces
        .iter()
        .map(|axis| vec![list(&axis.input), list(&axis.by_pendulous_angle), list(&axis.by_output_angle)]);
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
        "accelerometer" => Gauge::Accelerometer,
        "gyro" => Gauge::Gyro,
        other => return Err(PyValueError::new_err(format!("gauge = {other} (must be accelerometer or gyro)"))),
    };
    Ok(lab::to_gauge(&x, gauge, &model.triads).to_vec())
}
