//! Arrays and lists of the gimbal's bindings: rows of three, tables, vectors, rotations.

use nalgebra::{Matrix3, Vector3};
use numpy::ndarray::Array2;
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Rows of three.
pub(super) fn triples(array: &PyReadonlyArray2<'_, f64>, name: &str) -> PyResult<Vec<[f64; 3]>> {
    if array.shape()[1] != 3 {
        return Err(PyValueError::new_err(format!("{name} has shape {:?} (must be (n, 3))", array.shape())));
    }
    Ok(array.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect())
}

/// Rows of one length as an array.
pub(super) fn table<'py>(py: Python<'py>, rows: &[Vec<f64>]) -> Bound<'py, PyArray2<f64>> {
    let columns = rows.first().map_or(0, Vec::len);
    let flat: Vec<f64> = rows.iter().flatten().copied().collect();
    let array = Array2::from_shape_vec((rows.len(), columns), flat).unwrap_or_default();
    PyArray2::from_owned_array(py, array)
}

/// A table as Python lists.
pub(super) type Rows = Vec<Vec<f64>>;

/// A matrix by rows.
pub(super) fn rows(matrix: &Matrix3<f64>) -> Rows {
    (0..3).map(|i| (0..3).map(|j| matrix[(i, j)]).collect()).collect()
}

/// Three rows of three.
pub(super) fn matrix(array: &PyReadonlyArray2<'_, f64>) -> PyResult<Matrix3<f64>> {
    let list = triples(array, "rotation")?;
    if list.len() == 3 {
        Ok(Matrix3::from_fn(|i, j| list[i][j]))
    } else {
        Err(PyValueError::new_err(format!("rotation has {} rows (must be 3)", list.len())))
    }
}

/// Three numbers.
pub(super) fn vector(array: &PyReadonlyArray1<'_, f64>, name: &str) -> PyResult<Vector3<f64>> {
    let view = array.as_array();
    if view.len() == 3 {
        Ok(Vector3::new(view[0], view[1], view[2]))
    } else {
        Err(PyValueError::new_err(format!("{name} has {} numbers (must be 3)", view.len())))
    }
}
