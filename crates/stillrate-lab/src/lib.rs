//! The desk-side companion of [`stillrate`]: simulate, tune, analyse, compare. Everything here may allocate and
//! use threads; everything that runs per sample lives in the core.

pub mod allan;
pub mod bounds;
pub mod error;
pub mod export;
pub mod gimbal;
pub mod inspect;
pub mod logs;
pub mod metrics;
pub mod observability;
pub mod random;
pub mod rate_table;
pub mod recursive;
pub mod reference_bias;
pub mod runner;
mod samples;
pub mod saved;
pub mod servo;
pub mod settings_map;
pub mod simulate;
pub mod statistics;
pub mod tune;

/// The Rust block of the README, run with the other examples.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

/// The Rust blocks of the documentation, run with the other examples.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/howto/firmware.md")]
mod firmware {}
