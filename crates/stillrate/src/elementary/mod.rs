//! exp, ln, sin, cos, ...: one definition for every target, so that no system libm decides a bit.
//!
//! Each function is written once (the module `format` holds what differs between `f32` and `f64`), from IEEE add,
//! subtract, multiply, divide and compare only: no tables in memory, no branches, no fused multiply-add. Special values are chosen by selects,
//! so a loop over any of these functions vectorises and every lane gives the bits of the scalar call. The `f32` functions never
//! touch `f64`: they run on a single-precision unit.
//!
//! Polynomials were fitted for this library by `tests/tables/elementary.py`, but for 2^x, whose power series is short enough. Largest errors measured, in units in the
//! last place (half a unit would be correct rounding): `f64` against 400-bit arithmetic at
//! 120 000 points a function, `f32` against our `f64` at all its numbers (`angle_over`: two million pairs):
//!
//! | function | `f64` | `f32` | range |
//! |---|---|---|---|
//! | `root` | 0.50 | 0.50 | all |
//! | `exponential` | 1.00 | 0.87 | all |
//! | `exponential_less_one` | 0.92 | 1.06 | all |
//! | `logarithm` | 0.80 | 0.85 | all |
//! | `sine_cosine` | 0.77 | 0.79 | up to 2^20 rad in `f64`, 2^12 rad in `f32` |
//! | `angle_over` | 1.32 | 1.36 | all |
//! | `tangent_hyperbolic` | 1.18 | 1.30 | all |
//!
//! Beyond its range `sine_cosine` has an absolute error below one unit in the last place of its *argument*, up to
//! 2^52 rad (2^23 rad in `f32`); from there on, where neighbouring arguments are a radian apart, it is (0, 1).

mod angle;
mod circular;
pub mod double;
mod exponential;
mod format;
mod logarithm;
pub mod single;
