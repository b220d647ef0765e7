//! Rotations, the turning Earth, and gyro bias from a reference attitude.
//!
//! Conventions, everywhere in this module: navigation frame north-east-down, body frame forward-right-down, `C_b_n` (our
//! [`Rotation<T, Body, Navigation>`]) takes body coordinates to navigation coordinates, and small rotations are
//! multiplied from the right: C <- C Exp(v). SI units: rad, rad/s, s.
//!
//! * [`so3`]: Exp, Log, the right Jacobian, on plain nalgebra vectors and matrices;
//! * [`rotation`]: the same as a type that knows its two frames, so that they cannot be mixed up;
//! * [`quaternion`], [`dcm`]: other forms of the same thing, checked and projected;
//! * [`earth`]: Earth rate and position, exact and safe at the poles;
//! * [`preintegration`]: rates to one rotation with its derivative by the bias;
//! * [`reference_bias`]: the bias that makes the integrated rates meet a reference attitude;
//! * [`shortcuts`]: the classical approximations of it, for comparison.

pub mod dcm;
pub mod earth;
pub mod preintegration;
pub mod quaternion;
pub mod reference_bias;
pub mod rotation;
pub mod shortcuts;
pub mod so3;
mod symmetric;

pub use dcm::{check_dcm, project_to_rotation};
pub use quaternion::Quaternion;
pub use rotation::{Body, EarthFixed, Frame, Inertial, Navigation, Rotation, Sensor};
