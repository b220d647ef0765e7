//! Networks: outputs, derivatives, one Levenberg-Marquardt step, training.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate_lab::rate_table::levenberg::{self, Samples};
use stillrate_lab::rate_table::network::{Network, Shape};
use stillrate_lab::rate_table::training::{Training, train};

use super::{slice, value_error};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(network_evaluate, module)?)?;
    module.add_function(wrap_pyfunction!(network_step, module)?)?;
    module.add_function(wrap_pyfunction!(network_train, module)?)
}

fn network(inputs: usize, hidden: usize, linear: bool, parameters: &[f64]) -> PyResult<Network> {
    Network::new(Shape { inputs, hidden, linear }, parameters.to_vec()).map_err(value_error)
}

fn check_rows(inputs: usize, rows: &[f64]) -> PyResult<()> {
    if inputs == 0 || !rows.len().is_multiple_of(inputs) {
        return Err(value_error(format!("{} numbers are no rows of {inputs} inputs", rows.len())));
    }
    Ok(())
}

/// Outputs, slopes in the first input and the Jacobian (row after row).
#[pyfunction]
fn network_evaluate<'py>(
    py: Python<'py>,
    inputs: usize,
    hidden: usize,
    linear: bool,
    parameters: PyReadonlyArray1<'py, f64>,
    rows: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let network = network(inputs, hidden, linear, slice(&parameters)?)?;
    let rows = slice(&rows)?;
    check_rows(inputs, rows)?;
    let mut gradient = vec![0.0; network.shape().parameters()];
    let (mut output, mut slope, mut jacobian) = (Vec::new(), Vec::new(), Vec::new());
    for x in rows.chunks_exact(inputs) {
        output.push(network.gradient(x, &mut gradient));
        slope.push(network.slope(x));
        jacobian.extend_from_slice(&gradient);
    }
    let dict = PyDict::new(py);
    dict.set_item("output", PyArray1::from_vec(py, output))?;
    dict.set_item("slope", PyArray1::from_vec(py, slope))?;
    dict.set_item("jacobian", PyArray1::from_vec(py, jacobian))?;
    Ok(dict)
}

/// Mean square error, its gradient, and one trial step.
#[pyfunction]
fn network_step<'py>(
    py: Python<'py>,
    inputs: usize,
    hidden: usize,
    linear: bool,
    parameters: PyReadonlyArray1<'py, f64>,
    rows: PyReadonlyArray1<'py, f64>,
    targets: PyReadonlyArray1<'py, f64>,
    decay: f64,
    mask: Option<PyReadonlyArray1<'py, f64>>,
    damping: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let network = network(inputs, hidden, linear, slice(&parameters)?)?;
    let (rows, targets) = (slice(&rows)?, slice(&targets)?);
    check_rows(inputs, rows)?;
    if targets.is_empty() || rows.len() != targets.len() * inputs {
        return Err(value_error(format!("{} inputs for {} targets", rows.len() / inputs, targets.len())));
    }
    let mask = match &mask {
        Some(mask) => slice(mask)?.to_vec(),
        None => network.shape().decay_mask(),
    };
    if mask.len() != network.shape().parameters() {
        return Err(value_error("decay mask and parameters must be equally many"));
    }
    let samples = Samples { rows, targets, weights: &[] };
    let normal = levenberg::normal(&network, samples);
    let trial = levenberg::step(&network, samples, &normal, &mask, decay, damping)
        .ok_or_else(|| value_error("the damped normal matrix is not positive definite: raise the damping"))?;
    let dict = PyDict::new(py);
    dict.set_item("mse", normal.mse)?;
    dict.set_item("gradient", PyArray1::from_iter(py, normal.gradient.iter().map(|g| 2.0 * g)))?;
    dict.set_item("before", trial.before)?;
    dict.set_item("after", trial.after)?;
    dict.set_item("step", PyArray1::from_vec(py, trial.step))?;
    Ok(dict)
}

/// Trains a network on scaled samples; gives its parameters, epochs and the three mean squares.
#[pyfunction]
fn network_train<'py>(
    py: Python<'py>,
    inputs: usize,
    hidden: usize,
    linear: bool,
    rows: PyReadonlyArray1<'py, f64>,
    targets: PyReadonlyArray1<'py, f64>,
    decay: f64,
    epochs: usize,
    patience: usize,
    seed: u64,
) -> PyResult<(Bound<'py, PyArray1<f64>>, usize, [f64; 3])> {
    let (rows, targets) = (slice(&rows)?, slice(&targets)?);
    check_rows(inputs, rows)?;
    let training = Training { shape: Shape { inputs, hidden, linear }, decay, epochs, patience, seed };
    let trained = py.detach(|| train(&training, rows, targets)).map_err(value_error)?;
    let parameters = PyArray1::from_slice(py, trained.network.parameters());
    Ok((parameters, trained.epochs, trained.mean_square))
}
