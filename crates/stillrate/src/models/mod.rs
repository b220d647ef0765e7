//! One motion model a file: its transition and process noise over a time step.
pub(crate) mod modified_singer;
pub mod oscillator;
mod singer;

pub use singer::{SingerCoefficients, singer_derivatives};
