//! `stillrate.gimbal`: arrays in, dictionaries of arrays out; all arithmetic is in the two crates.
mod arrays;
mod calibrate;
mod design;
mod parts;
mod settings;
mod truth;

use pyo3::prelude::*;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    parts::register(module)?;
    design::register(module)?;
    truth::register(module)?;
    calibrate::register(module)
}
