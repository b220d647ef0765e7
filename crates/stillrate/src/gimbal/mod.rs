//! Continuous calibration of a gimballed sensor head: a platform with three gyros and three accelerometers tumbles under command, and
//! from the accelerometer outputs alone every gyro and accelerometer coefficient is found.
//!
//! [`Model`] and [`Geometry`] are the exact model; [`Relinearised`] is the recommended estimator (recursive Gauss-Newton, reaches the
//! Cramer-Rao bound), [`JointFilter`] the on-line one, [`TwoLoop`] the smaller two-loop filter, [`FirstOrder`] the published single loop. All
//! run on [`Factor`], one triangular square root in `f32` or `f64`, and read a [`Record`]. Source: our reconstruction of
//! DOI 10.3873/j.issn.1000-1328.2017.06.009, whose displayed equations we did not have: written anew from
//! inertial-navigation theory, and checked against the figures it publishes.

mod carried;
pub mod coefficients;
mod estimator;
mod factor;
mod first_order;
mod geometry;
mod joint;
mod line;
mod linearisation;
mod model;
mod motion;
mod norm_loop;
mod output;
mod record;
mod relinearised;
pub mod rotation;
mod selection;
mod tilt_loop;
pub mod window;

pub use carried::Carried;
pub use coefficients::{COUNT, Coefficients, DEFAULT_SCALE, NAMES, Triads};
pub use estimator::{Estimator, Innovation};
pub use factor::{Factor, Gain};
pub use first_order::{FirstOrder, FirstOrderState};
pub use geometry::{ForceAxis, Geometry, GyroAxes};
pub use joint::{COMMAND_MAX_RAD_S, JointFilter, JointState, SECOND_ORDER};
pub use linearisation::Linearisation;
pub use model::Model;
pub use motion::{Step, Turning};
pub use norm_loop::{NORM_COUNT, NORM_INDICES};
pub use output::Row;
pub use record::{HALF_WINDOW_MAX, Measurement, Record};
pub use relinearised::{Pass, Relinearised, SPOILT_SIGMA, Solution};
pub use selection::{Gauge, Options, Selection};
pub use tilt_loop::{TILT_COUNT, TwoLoop};
pub use window::Reference;
