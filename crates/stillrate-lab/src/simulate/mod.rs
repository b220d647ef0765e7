//! Signals with a known truth: the noise of a gyro ([`gyro_noise`]), the beds on which filters are scored ([`beds`])
//! and the random motions they are made of ([`motion`]).

pub mod beds;
mod flicker;
pub mod gyro_noise;
pub mod motion;

pub use beds::{Bed, BedKind, BedSettings};
pub use gyro_noise::{GyroNoiseModel, NoiseRecord};
