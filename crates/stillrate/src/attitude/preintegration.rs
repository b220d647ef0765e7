//! Body rates integrated to one rotation, with its derivative by gyro bias and scale factor.
//!
//! C <- C Exp((w - b) dt), J <- E' J + Jr((w - b) dt) dt with the same E = Exp((w - b) dt): then
//! C(b + db) = C(b) Exp(-J db) to first order (Forster et al., On-Manifold Preintegration, IEEE T-RO 2017, eq. 44, for steps of any length).
//! Unlike the average J = T I this stays exact in hand-held motion, where the average costs 100 deg/h.

use nalgebra::{Matrix3, Vector3};

use crate::attitude::so3;
use crate::real::Real;

/// Rotation, derivative and time of a stretch of body rates.
///
/// # Example
/// ```
/// use nalgebra::Vector3;
/// use stillrate::attitude::preintegration::Preintegration;
/// let (mut turn, mut scaled) = (Preintegration::<f64>::new(), Preintegration::<f64>::new());
/// for _ in 0..200 {
///     turn.advance(Vector3::new(0.0, 0.0, 0.1), 0.005);
///     scaled.advance_with_scale(Vector3::new(0.0, 0.0, 0.1), 0.005);
/// }
/// assert!((turn.time_s - 1.0).abs() < 1e-14);
/// assert!((stillrate::attitude::so3::log(&turn.rotation).z - 0.1).abs() < 1e-15);
/// // A bias about z adds up over the second, a scale error over the 0.1 rad.
/// assert!((turn.bias_jacobian[(2, 2)] - 1.0).abs() < 1e-14 && (scaled.scale_jacobian[(2, 2)] - 0.1).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preintegration<T> {
    /// Rotation from the body at the end to the body at the start.
    pub rotation: Matrix3<T>,
    /// -d(right increment)/d(bias), s.
    pub bias_jacobian: Matrix3<T>,
    /// -d(right increment)/d(scale factor error), rad; kept only by [`Preintegration::advance_with_scale`].
    pub scale_jacobian: Matrix3<T>,
    /// Time covered, s.
    pub time_s: T,
}

impl<T: Real> Default for Preintegration<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real> Preintegration<T> {
    /// Nothing integrated yet.
    #[must_use]
    pub fn new() -> Self {
        Self {
            rotation: Matrix3::identity(),
            bias_jacobian: Matrix3::zeros(),
            scale_jacobian: Matrix3::zeros(),
            time_s: T::ZERO,
        }
    }

    /// Adds a stretch of `dt_s` seconds at constant corrected body rate `rate_rad_s` (bias already taken off).
    #[inline]
    pub fn advance(&mut self, rate_rad_s: Vector3<T>, dt_s: T) {
        self.turn(rate_rad_s, dt_s);
    }

    /// As [`Preintegration::advance`], and follows the derivative by the three scale factors as well.
    #[inline]
    pub fn advance_with_scale(&mut self, rate_rad_s: Vector3<T>, dt_s: T) {
        let (turn, jacobian) = self.turn(rate_rad_s, dt_s);
        let by_scale = jacobian * Matrix3::from_diagonal(&rate_rad_s) * dt_s;
        self.scale_jacobian = turn.transpose() * self.scale_jacobian + by_scale;
    }

    /// Rotation, bias and time; returns the turn of the stretch and its right Jacobian.
    #[inline(always)]
    fn turn(&mut self, rate_rad_s: Vector3<T>, dt_s: T) -> (Matrix3<T>, Matrix3<T>) {
        let (turn, jacobian) = so3::exp_with_jacobian(&(rate_rad_s * dt_s));
        self.rotation *= turn;
        self.bias_jacobian = turn.transpose() * self.bias_jacobian + jacobian * dt_s;
        self.time_s += dt_s;
        (turn, jacobian)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integrate(bias: Vector3<f64>, scale: Vector3<f64>) -> Preintegration<f64> {
        let mut stretch = Preintegration::new();
        for k in 0..400 {
            let phase = f64::from(k) * 0.02;
            let (s, c) = phase.sine_cosine();
            let rate = Vector3::new(2.0 * s, 1.5 * c, 0.4 - s * c);
            let corrected = (rate - bias).component_div(&scale.add_scalar(1.0));
            stretch.advance_with_scale(corrected, 0.005);
        }
        stretch
    }

    #[test]
    fn jacobians_are_the_derivatives() {
        let nominal = integrate(Vector3::zeros(), Vector3::zeros());
        let h = 1e-6;
        for axis in 0..3 {
            let mut step = Vector3::zeros();
            step[axis] = h;
            let by = |plus: Preintegration<f64>, minus: Preintegration<f64>| {
                (so3::log(&(nominal.rotation.transpose() * minus.rotation))
                    - so3::log(&(nominal.rotation.transpose() * plus.rotation)))
                    / (2.0 * h)
            };
            let bias = by(integrate(step, Vector3::zeros()), integrate(-step, Vector3::zeros()));
            let scale = by(integrate(Vector3::zeros(), step), integrate(Vector3::zeros(), -step));
            assert!((bias - nominal.bias_jacobian.column(axis)).amax() < 1e-8);
            assert!((scale - nominal.scale_jacobian.column(axis)).amax() < 1e-8);
        }
    }
}
