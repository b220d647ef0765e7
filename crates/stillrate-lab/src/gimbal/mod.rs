//! Desk-side part of the gimballed sensor head: truth, bounds, batch solution, baselines, trajectory search, studies.
//!
//! # How close to the bound
//! 400 draws of the default run: NEES/n 1.006, error over bound 1.013, median of the largest relative error 0.048 % (drifts of 0.03 to
//! 0.1 deg/h). The largest of 20 draws is chance: in 16 of 20 studies it stays within 0.13 %, kappa over the mean size of the kgI within
//! 0.9 %; over its own mean, which random signs bring near zero, in none. With ten times larger drifts the worst of 200 draws is 0.014 %, kappa
//! 0.104 %, and 0.05 % is reached after 519 s at the latest.
//!
//! # What was tried beyond the source
//! Measured by `stillrate reproduce gimbal` (six draws of 900 s; "own" is error over the method's own deviation, 1 is honest).
//!
//! - **Relinearisation with process noise.** The passes of the recommended method run with the attitude's random walk as process noise about a
//!   deterministic path. It is honest (own 1.0 to 1.2 from 1e-5 to 1e-3 deg/sqrt(h)) and as good as the on-line filter with the same
//!   noise, no better in the median: 0.21 against 0.21 %, 1.8 against 1.8 %, 19 against 18 %. Once the walk decides, there is nothing left that
//!   a better linearisation could gain.
//! - **On-line filter with torquer states.** Honest (own 0.92) and unaffected by the size of the error (1e-6 or 1e-5): 0.11 %
//!   against 0.09 % on a head without the error. The recommended method with these states: 0.05 %.
//! - **Another trajectory.** Climbing from the default table, and from random ones of 12, 18 and 24 segments, at the same rate and slew
//!   limits lowers the worst bound (kappa aside) from 0.0292 to 0.0284 % of a typical coefficient and no further: the default is
//!   within three per cent of the best that [`plan()`] knows. kappa does not depend on the table but on the duration.
//! - **What no residual test notices**: gravity wrong by 1e-6 (a pure scale error, 0.2 %), a random walk of 1e-5 deg/sqrt(h) that the
//!   filter was not told of (eight times the error). Torquer errors, latency, latitude, quadratic terms and larger walks are noticed in every
//!   draw, and their states find them.

mod batch;
mod bound;
mod calibrate;
mod gauge;
mod hidden;
mod literal;
mod outcome;
mod plan;
mod prepare;
mod residuals;
mod score;
mod settings;
mod simulate;
mod study;
mod trajectory;
mod triangle;

pub use bound::{Bound, Sampling, Sensitivity, bound, sensitivities};
pub use calibrate::calibrate;
pub use gauge::to_gauge;
pub use hidden::{Hidden, hidden};
pub use outcome::{History, Outcome};
pub use plan::{Figures, Search, figures, plan};
pub use prepare::{LogError, Prepared, prepare};
pub use residuals::ResidualTests;
pub use score::{Score, score};
pub use settings::{Method, Settings};
pub use simulate::{Disturbance, disturb, draw, outputs};
pub use study::{Draw, Start, Study, run_study};
pub use trajectory::{DEFAULT_SEGMENTS, Trajectory};
