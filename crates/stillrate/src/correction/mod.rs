//! Run-time side of the rate-table error model: what is subtracted from a rate after calibration on a turntable.
//!
//! A desk-side fit ends in an [`ErrorCurve`]: a polynomial (offset, line, cubic ...) plus an optional hidden tanh layer in the rate
//! and up to two further inputs such as temperature. [`ErrorCurve::correct`] solves w = y - e(w) for a measured
//! rate y; outside the calibrated range the value at the edge is held and flagged, because polynomials, straight lines and networks all
//! extrapolate badly there. [`Compensated`] puts the curve behind any filter.
mod compensated;
mod curve;

pub use compensated::{Compensated, CompensatedState};
pub use curve::{Corrected, ErrorCurve, HIDDEN, INPUTS, TERMS, term_powers};
