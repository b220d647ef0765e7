//! Spectrum and quiet stretch of a record.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate_lab::inspect::{quiet, spectrum};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(welch, module)?)?;
    module.add_function(wrap_pyfunction!(filter_effect, module)?)
}

type Curve<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Frequencies in Hz and one-sided spectral density.
#[pyfunction]
fn welch<'py>(py: Python<'py>, samples: PyReadonlyArray1<'py, f64>, sample_rate_hz: f64, segment: usize) -> Curve<'py> {
    let samples = samples.as_array().to_vec();
    let found = py.detach(|| spectrum::welch(&samples, sample_rate_hz, segment));
    (PyArray1::from_vec(py, found.frequency_hz), PyArray1::from_vec(py, found.density))
}

/// The quietest stretch, the scatter there before and after, and the RMS of what was taken away.
#[pyfunction]
fn filter_effect<'py>(
    py: Python<'py>,
    raw: PyReadonlyArray1<'py, f64>,
    filtered: PyReadonlyArray1<'py, f64>,
    window: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let (raw, filtered) = (raw.as_array().to_vec(), filtered.as_array().to_vec());
    let found = py.detach(|| quiet::effect(&raw, &filtered, window));
    let dict = PyDict::new(py);
    dict.set_item("start", found.quiet.start)?;
    dict.set_item("stop", found.quiet.end)?;
    dict.set_item("before", found.before)?;
    dict.set_item("after", found.after)?;
    dict.set_item("removed", found.removed)?;
    Ok(dict)
}
