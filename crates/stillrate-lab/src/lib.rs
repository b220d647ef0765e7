//! The desk-side companion of [`stillrate`]: simulate, tune, analyse, compare. Everything here may allocate and
//! use threads; everything that runs per sample lives in the core.

pub mod servo;
