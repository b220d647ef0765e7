//! The parts of the recommended bank: one random walk, a ladder of Singer models and a group of double oscillators.
//!
//! Time is counted in sample periods and derivatives are scaled by powers of the period, so that every number of the bank
//! is of the order of the signal at 50 Hz as at 8 kHz, in `f32` as in `f64`. All functions here work on one channel; the loops
//! over channels stand in [`super::ms_imm_ikf`].

pub(crate) mod frequency;
pub(crate) mod mix;
pub(crate) mod update;
