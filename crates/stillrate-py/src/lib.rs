//! Python bindings: arrays into slices, errors into exceptions, nothing else.
//!
//! Each module binds one family and registers itself; the numerics live in `stillrate` and `stillrate-lab`.

use pyo3::prelude::*;

mod convert;
mod drift;
mod filter;
mod inspect;
mod logs;
mod servo;

/// The compiled half of the Python package.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    drift::register(module)?;
    filter::register(module)?;
    inspect::register(module)?;
    logs::register(module)?;
    servo::register(module)?;
    Ok(())
}
