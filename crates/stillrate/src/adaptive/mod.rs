//! What adapts on line: manoeuvre frequency, fading factors.
pub mod fading;
pub mod manoeuvre_frequency;
