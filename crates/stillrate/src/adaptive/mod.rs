//! What adapts on line: manoeuvre frequency, fading factors.
pub(crate) mod fading;
pub mod manoeuvre_frequency;
