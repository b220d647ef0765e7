//! What users hand in and get back: a sample or time steps of any kind, results in the container of the samples, traces.

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyInt, PyTuple};
use stillrate_lab::runner::Trace;

/// One sample; what is masked, `None` or NA is missing.
pub(crate) fn number_from(value: &Bound<'_, PyAny>) -> PyResult<f64> {
    if let Ok(number) = value.cast::<PyFloat>() {
        return Ok(number.value());
    }
    if value.is_instance_of::<PyInt>() {
        return value.extract();
    }
    value.py().import("stillrate.arrays")?.getattr("as_number")?.call1((value,))?.extract()
}

/// Hands one sample of each channel on, given one by one or as one row.
pub(crate) fn with_row<R>(
    value: &Bound<'_, PyAny>,
    others: &Bound<'_, PyTuple>,
    then: impl FnOnce(&mut [f64]) -> PyResult<R>,
) -> PyResult<R> {
    if others.is_empty() {
        let Ok(items) = value.try_iter() else { return then(&mut [number_from(value)?]) };
        let mut row = items.map(|item| number_from(&item?)).collect::<PyResult<Vec<f64>>>()?;
        return then(&mut row);
    }
    // A row of ordinary size needs no heap.
    let (mut short, mut long) = ([0.0; 16], Vec::new());
    let count = 1 + others.len();
    let row = if count <= short.len() {
        &mut short[..count]
    } else {
        long.resize(count, 0.0);
        long.as_mut_slice()
    };
    row[0] = number_from(value)?;
    for (slot, other) in row[1..].iter_mut().zip(others) {
        *slot = number_from(&other)?;
    }
    then(row)
}

/// The result in the container of the samples: a series for a series, an array for an array.
pub(crate) fn like<'py>(given: &Bound<'py, PyAny>, result: Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    if given.get_type().name().is_ok_and(|name| name == "ndarray") {
        return Ok(result);
    }
    given.py().import("stillrate.arrays")?.getattr("like")?.call1((given, result))
}

/// Time steps of all samples: one number for all, or one a sample.
pub(crate) fn steps_from(dt: &Bound<'_, PyAny>, rows: usize) -> PyResult<Vec<f64>> {
    if let Ok(one) = dt.extract::<f64>() {
        return Ok(vec![one; rows]);
    }
    let steps: Vec<f64> = if let Ok(array) = dt.extract::<PyReadonlyArray1<'_, f64>>() {
        array.as_array().iter().copied().collect()
    } else {
        let column = dt.py().import("stillrate.arrays")?.getattr("as_column")?.call1((dt,))?;
        column.extract().map_err(|_| PyTypeError::new_err("dt_s must be a number or one number a sample"))?
    };
    if steps.len() == rows {
        Ok(steps)
    } else {
        Err(PyValueError::new_err(format!("dt_s has {} entries for {rows} samples", steps.len())))
    }
}

/// A trace as `stillrate.Trace`.
pub(crate) fn trace_to_python<'py>(
    py: Python<'py>,
    trace: &Trace,
    shape: &[usize],
    dtype: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let fields = PyDict::new(py);
    let plain = |values: &[f64]| PyArray1::from_slice(py, values).reshape(shape.to_vec());
    fields.set_item("rate", plain(&trace.rate)?)?;
    fields.set_item("acceleration", plain(&trace.acceleration)?)?;
    fields.set_item("variance", plain(&trace.variance)?)?;
    fields.set_item("frequency_hz", plain(&trace.frequency_hz)?)?;
    fields.set_item("flags", PyArray1::from_slice(py, &trace.flags).reshape(shape.to_vec())?)?;
    let mut by_model = vec![shape[0], trace.models];
    by_model.extend_from_slice(&shape[1..]);
    let model = |pick: fn(&stillrate::ModelTrace<f64>) -> f64| {
        PyArray1::from_iter(py, trace.per_model.iter().map(pick)).reshape(by_model.clone())
    };
    fields.set_item("probability", PyArray1::from_slice(py, &trace.probability).reshape(by_model.clone())?)?;
    fields.set_item("innovation", model(|m| m.innovation)?)?;
    fields.set_item("innovation_variance", model(|m| m.innovation_variance)?)?;
    fields.set_item("fading", model(|m| m.fading)?)?;
    fields.set_item("alpha", model(|m| m.alpha)?)?;
    fields.set_item("model_rate", model(|m| m.rate)?)?;
    fields.set_item("dtype", dtype)?;
    py.import("stillrate.results")?.getattr("Trace")?.getattr("from_native")?.call((), Some(&fields))
}
