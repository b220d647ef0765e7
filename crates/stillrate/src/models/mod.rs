//! One motion model a file: its transition and process noise for a time step.
pub mod oscillator;
pub mod singer;
