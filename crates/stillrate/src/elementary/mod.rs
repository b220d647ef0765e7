//! exp, ln, sin, cos, ...: one definition for every target, so that no system libm decides a bit.
pub mod double;
pub mod single;
