//! Continuous calibration of a gimballed sensor head: a platform with three gyros and three accelerometers tumbles under command, and
//! from the accelerometer outputs alone every gyro and accelerometer coefficient is found.
//!
//! [`Model`] and [`Geometry`] are the exact model; [`Relinearised`] is the recommended estimator (recursive Gauss-Newton, reaches the
//! Cramer-Rao bound), [`JointFilter`] the on-line one, [`TwoLoop`] the smaller two-loop filter. All run on [`Factor`], one
//! triangular square root in `f32` or `f64`. Source: our reconstruction of
//! DOI 10.3873/j.issn.1000-1328.2017.06.009, whose displayed equations we did not have: written anew from
//! inertial-navigation theory, and checked against the figures it publishes.

pub mod carried;
pub mod coefficients;
pub mod estimator;
pub mod factor;
pub mod first_order;
pub mod geometry;
pub mod joint;
mod line;
pub mod model;
pub mod norm_loop;
pub mod record;
pub mod relinearised;
pub mod rotation;
pub mod tilt_loop;
pub mod window;

pub use carried::Carried;
pub use coefficients::{COUNT, Coefficients, DEFAULT_SCALE, Gauge, NAMES, Options, Selection, Triads};
pub use estimator::{Estimator, Innovation};
pub use factor::Factor;
pub use first_order::{FirstOrder, FirstOrderState};
pub use geometry::Geometry;
pub use joint::{JointFilter, JointState};
pub use model::{Model, Step};
pub use norm_loop::{NormLoop, NormState};
pub use record::{Measurement, Record};
pub use relinearised::{Linearisation, Pass, Relinearised, Solution};
pub use tilt_loop::{TiltState, TwoLoop};
pub use window::Reference;
