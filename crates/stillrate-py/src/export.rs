//! Configurations as C and Rust source.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate_lab::export::{c_header, export};
use stillrate_lab::runner::Precision;

use crate::convert::{config_error, settings_from};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(export_c, module)?)
}

/// Texts of `stillrate_config.h`, `stillrate_selftest.h`, `stillrate_config.rs` and `stillrate.h`.
#[pyfunction]
fn export_c(method: &str, settings: &Bound<'_, PyDict>, single: bool) -> PyResult<(String, String, String, String)> {
    let map = settings_from(settings)?;
    let precision = if single { Precision::Single } else { Precision::Double };
    let files = export(method, &map, precision).map_err(|error| config_error(settings.py(), &error))?;
    Ok((files.config_h, files.selftest_h, files.config_rs, c_header()))
}
