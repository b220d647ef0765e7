//! Networks: outputs, derivatives, one Levenberg-Marquardt step, training.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate_lab::rate_table::levenberg::Trial;
use stillrate_lab::rate_table::network::{Network, Shape};
use stillrate_lab::rate_table::training::Training;

use super::{slice, value_error};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<RateTableNetwork>()?;
    module.add_function(wrap_pyfunction!(network_train, module)?)
}

fn check_rows(inputs: usize, rows: &[f64]) -> PyResult<()> {
    if inputs == 0 || !rows.len().is_multiple_of(inputs) {
        return Err(value_error(format!("{} numbers are no rows of {inputs} inputs", rows.len())));
    }
    Ok(())
}

/// A network of one tanh layer.
#[pyclass(frozen, module = "stillrate._native")]
pub(super) struct RateTableNetwork(pub(super) Network);

#[pymethods]
impl RateTableNetwork {
    #[new]
    fn new(inputs: usize, hidden: usize, linear: bool, parameters: PyReadonlyArray1<'_, f64>) -> PyResult<Self> {
        let parameters = slice(&parameters)?.to_vec();
        Network::new(Shape { inputs, hidden, linear }, parameters).map(Self).map_err(value_error)
    }

    /// Outputs, slopes in the first input and the Jacobian (row after row).
    fn evaluate<'py>(&self, py: Python<'py>, rows: PyReadonlyArray1<'py, f64>) -> PyResult<Bound<'py, PyDict>> {
        let (network, rows) = (&self.0, slice(&rows)?);
        let Shape { inputs, .. } = network.shape();
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
    fn step<'py>(
        &self,
        py: Python<'py>,
        rows: PyReadonlyArray1<'py, f64>,
        targets: PyReadonlyArray1<'py, f64>,
        decay: f64,
        mask: Option<PyReadonlyArray1<'py, f64>>,
        damping: f64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (rows, targets) = (slice(&rows)?, slice(&targets)?);
        let shape = self.0.shape();
        check_rows(shape.inputs, rows)?;
        if targets.is_empty() || rows.len() != targets.len() * shape.inputs {
            return Err(value_error(format!("{} inputs for {} targets", rows.len() / shape.inputs, targets.len())));
        }
        let mask = mask.as_ref().map(slice).transpose()?;
        if mask.is_some_and(|mask| mask.len() != shape.parameters()) {
            return Err(value_error("decay mask and parameters must be equally many"));
        }
        let trial = Trial::of(&self.0, rows, targets, decay, mask, damping)
            .ok_or_else(|| value_error("the damped normal matrix is not positive definite: raise the damping"))?;
        let dict = PyDict::new(py);
        dict.set_item("mean_square", trial.mse)?;
        dict.set_item("gradient", PyArray1::from_vec(py, trial.gradient))?;
        dict.set_item("before", trial.before)?;
        dict.set_item("after", trial.after)?;
        dict.set_item("step", PyArray1::from_vec(py, trial.step))?;
        Ok(dict)
    }
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
    let trained = py.detach(|| training.train(rows, targets)).map_err(value_error)?;
    let parameters = PyArray1::from_slice(py, trained.network.parameters());
    Ok((parameters, trained.epochs, trained.mean_square))
}
