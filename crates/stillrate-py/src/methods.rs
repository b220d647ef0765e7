//! Methods by name, and what their settings may be.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate::models::SingerCoefficients;
use stillrate_lab::runner::{self, Precision};

use crate::convert::{config_error, settings_from, settings_to};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(resolve, module)?)?;
    module.add_function(wrap_pyfunction!(setting_range, module)?)?;
    module.add_function(wrap_pyfunction!(singer_coefficients, module)?)?;
    module.add_function(wrap_pyfunction!(method_names, module)?)
}

/// Names of all methods.
#[pyfunction]
fn method_names() -> Vec<&'static str> {
    runner::method_names()
}

/// r, s, q11, q12, q22 of a Singer model for unit driving noise.
#[pyfunction]
fn singer_coefficients(alpha_per_s: f64, dt_s: f64, single: bool) -> (f64, f64, f64, f64, f64) {
    if single {
        let c = SingerCoefficients::new(alpha_per_s as f32, dt_s as f32);
        (c.r.into(), c.s.into(), c.q11.into(), c.q12.into(), c.q22.into())
    } else {
        let c = SingerCoefficients::new(alpha_per_s, dt_s);
        (c.r, c.s, c.q11, c.q12, c.q22)
    }
}

/// Checks settings and returns them complete.
#[pyfunction]
fn resolve<'py>(py: Python<'py>, method: &str, settings: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyDict>> {
    let map = settings_from(settings)?;
    let runner = runner::build(method, &map, 1, Precision::Double).map_err(|error| config_error(py, &error))?;
    settings_to(py, &runner.settings())
}

/// What a setting may be: smallest and largest value, the range in words, and its unit; None for words and unknown settings.
#[pyfunction]
fn setting_range(method: &str, name: &str) -> Option<(f64, f64, &'static str, &'static str)> {
    stillrate::ranges::range_of(method, name).map(|range| (range.low, range.high, range.words, range.unit))
}
