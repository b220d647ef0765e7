//! Python bindings: arrays into slices, errors into exceptions, nothing else.
//!
//! Each module binds one family and registers itself; the numerics live in `stillrate` and `stillrate-lab`.

// Arguments come from Python by value.
#![allow(clippy::needless_pass_by_value)]

use pyo3::prelude::*;

mod analysis;
mod attitude;
mod convert;
mod drift;
mod export;
mod filter;
mod gimbal;
mod inspect;
mod logs;
mod methods;
mod observability;
mod rate_table;
mod recursive;
mod samples;
mod servo;
mod servo_filters;
mod servo_objects;
mod vector_rls;

/// The compiled half of the Python package.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    attitude::register(module)?;
    filter::register(module)?;
    methods::register(module)?;
    rate_table::register(module)?;
    gimbal::register(module)?;
    inspect::register(module)?;
    logs::register(module)?;
    analysis::register(module)?;
    drift::register(module)?;
    export::register(module)?;
    servo::register(module)?;
    servo_filters::register(module)?;
    observability::register(module)?;
    recursive::register(module)?;
    vector_rls::register(module)?;
    Ok(())
}
