//! Dictionaries to settings and back, arrays of any stride to tables, errors to exceptions.

use numpy::ndarray::ArrayViewD;
use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use stillrate_lab::runner::Table;
use stillrate_lab::settings_map::{SettingsError, SettingsMap, Value};

/// An exception of `stillrate.errors` by name.
pub(crate) fn named_error(py: Python<'_>, class: &str, text: &str) -> PyErr {
    let build = || -> PyResult<PyErr> {
        let class = py.import("stillrate.errors")?.getattr(class)?;
        Ok(PyErr::from_value(class.call1((text,))?))
    };
    build().unwrap_or_else(|failure| failure)
}

/// A settings error as `stillrate.ConfigError` (a `ValueError`).
pub(crate) fn config_error(py: Python<'_>, error: &SettingsError) -> PyErr {
    named_error(py, "ConfigError", &error.to_string())
}

/// Reads a dictionary of numbers, lists of numbers and words.
pub(crate) fn settings_from(dict: &Bound<'_, PyDict>) -> PyResult<SettingsMap> {
    let mut map = SettingsMap::new();
    for (name, value) in dict {
        let name: String = name.extract()?;
        let value = if let Ok(number) = value.extract::<f64>() {
            Value::Number(number)
        } else if let Ok(word) = value.extract::<String>() {
            Value::Word(word)
        } else if let Ok(list) = value.extract::<Vec<f64>>() {
            Value::List(list)
        } else {
            let kind = value.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "{name} must be a number, a list of numbers or a word, not {kind}"
            )));
        };
        map.insert(name, value);
    }
    Ok(map)
}

/// Writes settings as a dictionary.
pub(crate) fn settings_to<'py>(py: Python<'py>, map: &SettingsMap) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in map {
        match value {
            Value::Number(number) => dict.set_item(name, number)?,
            Value::List(list) => dict.set_item(name, PyList::new(py, list)?)?,
            Value::Word(word) => dict.set_item(name, word)?,
        }
    }
    Ok(dict)
}

/// A numeric array in either precision.
pub(crate) enum Samples<'py> {
    Single(PyReadonlyArrayDyn<'py, f32>),
    Double(PyReadonlyArrayDyn<'py, f64>),
}

/// Takes a `float32`/`float64` array as it is; anything else goes through `stillrate.arrays.as_samples`.
pub(crate) fn samples_from<'py>(value: &Bound<'py, PyAny>) -> PyResult<Samples<'py>> {
    if let Some(samples) = try_samples(value) {
        return Ok(samples);
    }
    let converted = value.py().import("stillrate.arrays")?.getattr("as_samples")?.call1((value,))?;
    try_samples(&converted).ok_or_else(|| PyTypeError::new_err("samples must be numbers"))
}

fn try_samples<'py>(value: &Bound<'py, PyAny>) -> Option<Samples<'py>> {
    // A subclass (a masked array) may hide missing samples: it takes the long way.
    if value.get_type().name().is_ok_and(|name| name != "ndarray") {
        return None;
    }
    if let Ok(array) = value.cast::<PyArrayDyn<f64>>() {
        let readonly = array.try_readonly().ok()?;
        return regular(&readonly.as_array()).then_some(Samples::Double(readonly));
    }
    let array = value.cast::<PyArrayDyn<f32>>().ok()?;
    let readonly = array.try_readonly().ok()?;
    regular(&readonly.as_array()).then_some(Samples::Single(readonly))
}

/// Whether the strides are such that a [`Table`] can describe the array.
fn regular<T>(array: &ArrayViewD<'_, T>) -> bool {
    (1..=2).contains(&array.ndim()) && array.strides().iter().all(|stride| *stride >= 0)
}

/// Describes a one- or two-dimensional array as a table, in place.
pub(crate) fn table_of<'a, T>(array: &ArrayViewD<'a, T>) -> Option<Table<'a, T>> {
    if !regular(array) {
        return None;
    }
    let rows = array.shape()[0];
    let row_stride = array.strides()[0].unsigned_abs();
    let (channels, channel_stride) = match array.ndim() {
        2 => (array.shape()[1], array.strides()[1].unsigned_abs()),
        _ => (1, 1),
    };
    let length =
        if rows == 0 || channels == 0 { 0 } else { (rows - 1) * row_stride + (channels - 1) * channel_stride + 1 };
    // SAFETY: numpy vouches that every index inside the shape is readable; with non-negative strides they all lie
    // between the first element and the last, `length - 1` items on. A caller who writes to the array from another
    // thread meanwhile gets unspecified samples, as the documentation of `Filter.run` says.
    let items = unsafe { core::slice::from_raw_parts(array.as_ptr(), length) };
    Some(Table { items, rows, channels, row_stride, channel_stride })
}
