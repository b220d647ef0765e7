//! Noise figures and models found from recordings.

pub mod autoregressive;
