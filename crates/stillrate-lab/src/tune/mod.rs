//! Settings from data: noise figures from a log.

pub mod noise;
mod quantum;

pub use noise::{NoiseFromLog, NoiseReason, noise_from_log};
pub use quantum::smallest_step;
