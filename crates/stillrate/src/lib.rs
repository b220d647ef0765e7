//! Real-time denoising and calibration of inertial sensors: a gyro signal made still without being made late.
//!
//! The core runs per sample, on a desk or in firmware: `no_std`, no allocation, no panic, no unsafe code, and the same
//! bits on every target. A filter is a checked configuration; its state is plain data; a step cannot fail.
//!
//! ```
//! use stillrate::{Filter, Sample, filters::Pt1};
//! let filter = Pt1::<f64>::new(50.0, 8.0)?;
//! let mut state = filter.start();
//! let estimate = filter.step(&mut state, Sample { value: 0.12, dt: 0.02 });
//! assert_eq!(estimate.rate, 0.12);
//! # Ok::<(), stillrate::ConfigError>(())
//! ```
//!
//! * [`filters`]: the methods. Each is built from its [`settings`], whose values [`ranges`] bounds and [`noise`] scales.
//! * [`filter`]: what they have in common; [`block`] runs many channels at once.
//! * [`attitude`], [`gimbal`], [`correction`]: rotations and reference biases, the gimballed platform, the rate-table error curve.
//! * [`real`], [`elementary`], [`mod@reals`], [`mod@plain`]: numbers, and values made of nothing else, for filters of your own.
#![no_std]
#![cfg_attr(feature = "core-sqrt", feature(core_float_math))]
#![forbid(unsafe_code)]

#[cfg(any(test, feature = "std"))]
extern crate std;

pub mod adaptive;
pub mod attitude;
pub mod block;
pub mod correction;
pub mod elementary;
pub mod error;
pub mod filter;
pub mod filters;
mod flags;
pub mod gaussian;
pub mod gimbal;
mod glide;
mod imm;
mod kalman;
pub mod models;
pub mod noise;
pub mod plain;
pub mod ranges;
pub mod real;
pub mod reals;
pub mod settings;
mod sound;

/// The example that stands on the crate's own page runs too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub use error::ConfigError;
pub use filter::{Estimate, Filter, Flags, ModelTrace, Observer, Sample};
pub use noise::GyroNoise;
pub use plain::{Outline, Plain};
pub use real::Real;
pub use reals::{Lane, Reals};
pub use settings::Settings;
