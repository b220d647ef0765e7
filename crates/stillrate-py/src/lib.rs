//! Python bindings: arrays into slices, errors into exceptions, nothing else.
//!
//! Each module binds one family and registers itself; the numerics live in `stillrate` and `stillrate-lab`.

use pyo3::prelude::*;

mod analysis;
mod convert;
mod drift;
mod filter;
mod gimbal;
mod gimbal_parts;
mod inspect;
mod logs;
mod rate_table;
mod servo;
mod servo_objects;

/// The compiled half of the Python package.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    filter::register(module)?;
    rate_table::register(module)?;
    gimbal::register(module)?;
    inspect::register(module)?;
    logs::register(module)?;
    analysis::register(module)?;
    drift::register(module)?;
    servo::register(module)?;
    Ok(())
}
