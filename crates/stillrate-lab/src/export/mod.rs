//! From the desk to firmware: the C header of the library, and a checked configuration as C and Rust source with a self-test.
//!
//! Nothing is listed twice: names, types and descriptions of the fields come from [`stillrate::Plain`], the methods from
//! [`stillrate::methods!`], sizes from the compiler.

mod configuration;
mod header;

pub use configuration::{Exported, export};
pub use header::{c_functions, c_header};

use stillrate::Estimate;

/// State of a filter as C holds it: the filter's own, and what the last step found.
#[derive(Clone, Copy)]
#[repr(C)]
struct Held<S, T> {
    filter: S,
    last: Estimate<T>,
}

/// `ms-imm-ikf` as part of a C name.
fn identifier(method: &str) -> String {
    method.replace('-', "_")
}
