//! Python bindings: arrays into slices, errors into exceptions, nothing else.
//!
//! Each module binds one family and registers itself; the numerics live in `stillrate` and `stillrate-lab`.

use pyo3::prelude::*;

mod convert;
mod drift;
mod filter;
mod servo;

/// The compiled half of the Python package.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    filter::register(module)?;
    drift::register(module)?;
    servo::register(module)?;
    Ok(())
}
