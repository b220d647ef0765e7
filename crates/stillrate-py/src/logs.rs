//! Delimited text in and out, and what time stamps say.

use std::path::PathBuf;

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use stillrate_lab::logs::blackbox::{self, Values};
use stillrate_lab::logs::delimited::{self, Column, ReadError};
use stillrate_lab::logs::timebase;
use stillrate_lab::logs::writer::{self, Style};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(read_blackbox, module)?)?;
    module.add_function(wrap_pyfunction!(read_delimited, module)?)?;
    module.add_function(wrap_pyfunction!(write_delimited, module)?)?;
    module.add_function(wrap_pyfunction!(analyse_timebase, module)?)?;
    module.add_function(wrap_pyfunction!(time_steps, module)?)
}

/// Reads a blackbox file: its longest flight (None if there is none), the number of flights, and why others cannot be read.
#[pyfunction]
fn read_blackbox<'py>(py: Python<'py>, bytes: &[u8]) -> PyResult<(Option<Bound<'py, PyDict>>, usize, Vec<String>)> {
    let found = py.detach(|| blackbox::read(bytes));
    let Some(flight) = found.longest else { return Ok((None, found.count, found.unreadable)) };
    let columns = PyList::empty(py);
    for column in flight.columns {
        match column {
            Values::Physical(values) => columns.append(PyArray1::from_vec(py, values))?,
            Values::Signed(values) => columns.append(PyArray1::from_vec(py, values))?,
            Values::Unsigned(values) => columns.append(PyArray1::from_vec(py, values))?,
        }
    }
    let dict = PyDict::new(py);
    dict.set_item("firmware", flight.firmware)?;
    dict.set_item("time_us", PyArray1::from_vec(py, flight.time_us))?;
    dict.set_item("names", flight.names)?;
    dict.set_item("columns", columns)?;
    dict.set_item("damaged_places", flight.damaged_places)?;
    dict.set_item("ended", flight.ended)?;
    dict.set_item("full", flight.full)?;
    Ok((Some(dict), found.count, found.unreadable))
}

/// Reads delimited text: columns (arrays of int64 or float64, lists of words), and how the file is written.
#[pyfunction]
fn read_delimited(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let table = py.detach(|| delimited::read(&path)).map_err(|error| match error {
        ReadError::Io(error) => error.into(),
        ReadError::Malformed(reason) => PyValueError::new_err(reason),
    })?;
    let columns = PyList::empty(py);
    for column in table.columns {
        match column {
            Column::Integers(values) => columns.append(PyArray1::from_vec(py, values))?,
            Column::Numbers(values) => columns.append(PyArray1::from_vec(py, values))?,
            Column::Text(values) => columns.append(values)?,
        }
    }
    let found = PyDict::new(py);
    let dialect = table.dialect;
    found.set_item("names", dialect.names)?;
    found.set_item("columns", columns)?;
    found.set_item("named", dialect.named)?;
    found.set_item("delimiter", char::from(dialect.delimiter))?;
    found.set_item("decimal_comma", dialect.decimal_comma)?;
    found.set_item("preamble", dialect.preamble)?;
    found.set_item("first_row_line", dialect.lines_before_rows + 1)?;
    found.set_item("missing_word", table.missing_word)?;
    Ok(found)
}

/// Writes columns of one length as delimited text.
#[pyfunction]
#[pyo3(signature = (path, columns, *, delimiter, decimal_comma, preamble, header, missing_word))]
fn write_delimited(
    py: Python<'_>,
    path: PathBuf,
    columns: &Bound<'_, PyList>,
    delimiter: char,
    decimal_comma: bool,
    preamble: Vec<String>,
    header: Option<Vec<String>>,
    missing_word: String,
) -> PyResult<()> {
    let columns = columns.iter().map(|column| column_from(&column)).collect::<PyResult<Vec<_>>>()?;
    let delimiter = u8::try_from(delimiter).map_err(|_| PyValueError::new_err("delimiter must be one byte"))?;
    let style = Style { delimiter, decimal_comma, preamble, header, missing_word };
    Ok(py.detach(|| writer::write(&path, &columns, &style))?)
}

fn column_from(column: &Bound<'_, PyAny>) -> PyResult<Column> {
    if let Ok(values) = column.extract::<PyReadonlyArray1<'_, f64>>() {
        return Ok(Column::Numbers(values.as_array().to_vec()));
    }
    if let Ok(values) = column.extract::<PyReadonlyArray1<'_, i64>>() {
        return Ok(Column::Integers(values.as_array().to_vec()));
    }
    Ok(Column::Text(column.extract()?))
}

/// Nominal rate, gaps, repeats and jumps back of time stamps in s.
#[pyfunction]
fn analyse_timebase<'py>(py: Python<'py>, t_s: PyReadonlyArray1<'py, f64>) -> PyResult<Bound<'py, PyDict>> {
    let found = timebase::analyse(&t_s.as_array().to_vec());
    let dict = PyDict::new(py);
    dict.set_item("sample_rate_hz", found.sample_rate_hz)?;
    dict.set_item("median_step_s", found.median_step_s)?;
    dict.set_item("longest_step_s", found.longest_step_s)?;
    dict.set_item("gaps", found.gaps)?;
    dict.set_item("repeats", found.repeats)?;
    dict.set_item("backward", found.backward)?;
    dict.set_item("missing", found.missing)?;
    dict.set_item("regular", found.regular)?;
    Ok(dict)
}

/// Time steps for a filter, nominal where the stamps are near it.
#[pyfunction]
fn time_steps<'py>(py: Python<'py>, t_s: PyReadonlyArray1<'py, f64>, sample_rate_hz: f64) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_vec(py, timebase::steps(&t_s.as_array().to_vec(), sample_rate_hz))
}
