//! The rate-table error model and the tuning of its filters: arrays to slices and back.
mod model;
mod network;
mod noise_tuning;
mod search;
mod study;

use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    network::register(module)?;
    search::register(module)?;
    noise_tuning::register(module)?;
    model::register(module)?;
    study::register(module)
}

/// Anything that can be said in a sentence as `ValueError`.
fn value_error(error: impl ToString) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A contiguous array as a slice.
fn slice<'a>(array: &'a PyReadonlyArray1<'_, f64>) -> PyResult<&'a [f64]> {
    array.as_slice().map_err(value_error)
}
