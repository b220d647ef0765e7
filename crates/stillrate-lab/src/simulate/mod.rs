//! Signals with a known truth: the noise of a gyro ([`GyroNoiseModel`]) and the beds on which filters are scored ([`BedSettings`]).

pub(crate) mod beds;
mod flicker;
mod gyro_noise;
pub(crate) mod motion;

pub use beds::{Bed, BedKind, BedSettings};
pub use gyro_noise::{GyroNoiseModel, NoiseRecord};
