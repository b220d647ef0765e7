//! The C functions of stillrate: start, step, estimate and reset of every filter, in f32 and f64.
//!
//! Configuration and state are the core's own `repr(C)` structs; `stillrate.h` declares them for C. A null pointer does
//! nothing and gives 0. No allocation, no global state, no panic: the panic handler below is never linked in, which the
//! tests prove by looking for it.
#![no_std]

use core::panic::PanicInfo;
use stillrate::{Estimate, Filter, Sample, Settings};

include!("never.rs");
include!("calls.rs");
include!("functions.rs");
