//! Python bindings: arrays into slices, errors into exceptions, nothing else.
//!
//! Each module binds one family and registers itself; the numerics live in `stillrate` and `stillrate-lab`.

use pyo3::prelude::*;

mod attitude;
mod convert;
mod filter;
mod inspect;
mod logs;
mod observability;
mod recursive;

/// The compiled half of the Python package.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    attitude::register(module)?;
    filter::register(module)?;
    inspect::register(module)?;
    logs::register(module)?;
    observability::register(module)?;
    recursive::register(module)?;
    Ok(())
}
