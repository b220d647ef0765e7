//! Finding the numbers a filter needs: noise figures and autoregressive models from a log, optimisers and what they make small.

pub mod autoregressive;
mod bank_likelihood;
pub mod brent;
mod candidates;
pub mod gain_ratio;
mod lanes;
pub mod minimise;
mod noise;
pub mod objective;
pub mod qpso;
mod quantum;
pub mod records;
mod reflection;
mod second_differences;
pub mod swarm;
pub mod track;
pub mod tuned;
pub mod tuned_bank;
mod windows;

pub use noise::{NoiseFromLog, NoiseReason, noise_from_log, shared_noise};
pub use quantum::smallest_step;
pub(crate) use second_differences::white_sigma_with_gaps;
