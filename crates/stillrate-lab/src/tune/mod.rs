//! Settings from data: noise figures and autoregressive models from a log.

pub mod autoregressive;
pub mod noise;
mod quantum;

pub use noise::{NoiseFromLog, NoiseReason, noise_from_log};
pub use quantum::smallest_step;
