//! Rotation vectors: Exp, Log and the right Jacobian, accurate from zero to pi and past it.
//!
//! Exp is Rodrigues' formula with the half angle, so that nothing cancels: with a = |v|,
//! Exp(v) = I + (sin a / a) \[v] + (1 - cos a)/a^2 \[v]^2 and (1 - cos a)/a^2 = (sin(a/2) / (a/2))^2 / 2.
//! Jr(v) = I - (1 - cos a)/a^2 \[v] + (a - sin a)/a^3 \[v]^2, so that Exp(v + d) = Exp(v) Exp(Jr(v) d) for small d
//! (Chirikjian, Stochastic Models, Information Theory, and Lie Groups, vol. 2, section 10.8.6; Forster et al., IEEE T-RO 2017, eq. 7-8).
//! Below a^2 = 1e-2 the power series is used: a switch further down loses half the digits of (a - sin a)/a^3.

use nalgebra::{Matrix3, Vector3};

use crate::attitude::quaternion::Quaternion;
use crate::real::Real;

/// Squared angle below which power series replace quotients. Six terms then leave less than 1e-17.
const SERIES_BELOW: f64 = 1e-2;

/// sum of `coefficients[k] x^k` by Horner's rule.
#[inline(always)]
fn series<T: Real, const N: usize>(x: T, coefficients: [f64; N]) -> T {
    coefficients.iter().rev().fold(T::ZERO, |sum, &c| sum * x + T::of(c))
}

/// The three coefficients (sin a / a, (1 - cos a)/a^2, (a - sin a)/a^3) of squared angle `a2`.
#[inline]
fn coefficients<T: Real>(a2: T) -> (T, T, T) {
    if a2 < T::of(SERIES_BELOW) {
        (
            series(a2, [1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0, -1.0 / 39_916_800.0]),
            series(a2, [0.5, -1.0 / 24.0, 1.0 / 720.0, -1.0 / 40_320.0, 1.0 / 3_628_800.0, -1.0 / 479_001_600.0]),
            series(
                a2,
                [1.0 / 6.0, -1.0 / 120.0, 1.0 / 5040.0, -1.0 / 362_880.0, 1.0 / 39_916_800.0, -1.0 / 6_227_020_800.0],
            ),
        )
    } else {
        let a = a2.root();
        let (sine, cosine) = (a * T::HALF).sine_cosine();
        let sine_full = T::TWO * sine * cosine;
        (sine_full / a, T::TWO * sine * sine / a2, (a - sine_full) / (a2 * a))
    }
}

/// Inner product, summed from x to z.
#[inline(always)]
pub(super) fn dot<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> T {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// Squared length of a vector.
#[inline(always)]
pub(super) fn squared<T: Real>(v: &Vector3<T>) -> T {
    dot(v, v)
}

/// The matrix `[v]` of the cross product: `[v] u = v x u`.
///
/// # Example
/// ```
/// use nalgebra::Vector3;
/// use stillrate::attitude::so3::cross_matrix;
/// assert_eq!(cross_matrix(&Vector3::new(1.0, 0.0, 0.0)) * Vector3::new(0.0, 1.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
/// ```
#[inline]
pub fn cross_matrix<T: Real>(v: &Vector3<T>) -> Matrix3<T> {
    Matrix3::new(T::ZERO, -v.z, v.y, v.z, T::ZERO, -v.x, -v.y, v.x, T::ZERO)
}

/// `I + first [v] + second [v]^2`.
#[inline]
fn assemble<T: Real>(v: &Vector3<T>, first: T, second: T) -> Matrix3<T> {
    // [v]^2 = v v' - |v|^2 I, written out so that the diagonal stays exact for small angles.
    let (xx, yy, zz) = (v.x * v.x * second, v.y * v.y * second, v.z * v.z * second);
    let (xy, xz, yz) = (v.x * v.y * second, v.x * v.z * second, v.y * v.z * second);
    let (fx, fy, fz) = (first * v.x, first * v.y, first * v.z);
    Matrix3::new(
        T::ONE - (yy + zz),
        xy - fz,
        xz + fy,
        xy + fz,
        T::ONE - (xx + zz),
        yz - fx,
        xz - fy,
        yz + fx,
        T::ONE - (xx + yy),
    )
}

/// Rotation matrix of the rotation vector `v` (rad).
///
/// # Example
/// ```
/// use nalgebra::Vector3;
/// use stillrate::attitude::so3::exp;
/// let quarter = exp(&Vector3::new(0.0, 0.0, core::f64::consts::FRAC_PI_2));
/// assert!((quarter * Vector3::x() - Vector3::<f64>::y()).amax() < 1e-15);
/// ```
#[inline]
pub fn exp<T: Real>(v: &Vector3<T>) -> Matrix3<T> {
    let (first, second, _) = coefficients(squared(v));
    assemble(v, first, second)
}

/// Rotation vector (rad, length at most pi) of a rotation matrix, through the unit quaternion with the largest pivot.
///
/// Past pi it gives the shorter equivalent: the same rotation with angle 2 pi - a about the opposite axis.
///
/// # Example
/// ```
/// use nalgebra::Vector3;
/// use stillrate::attitude::so3::{exp, log};
/// let v = Vector3::new(1.0, -2.0, 2.1); // 3.07 rad
/// assert!((log(&exp(&v)) - v).amax() < 1e-14);
/// ```
#[inline]
pub fn log<T: Real>(c: &Matrix3<T>) -> Vector3<T> {
    Quaternion::from_matrix(c).log()
}

/// Right Jacobian Jr(v): Exp(v + d) = Exp(v) Exp(Jr(v) d) to first order in d.
///
/// # Example
/// ```
/// use nalgebra::{Matrix3, Vector3};
/// use stillrate::attitude::so3::right_jacobian;
/// assert_eq!(right_jacobian(&Vector3::<f64>::zeros()), Matrix3::identity());
/// ```
#[inline]
pub fn right_jacobian<T: Real>(v: &Vector3<T>) -> Matrix3<T> {
    let (_, second, third) = coefficients(squared(v));
    assemble(v, -second, third)
}

/// Exp(v) and Jr(v) together, at the cost of one sine and cosine.
///
/// # Example
/// ```
/// use nalgebra::Vector3;
/// use stillrate::attitude::so3::{exp, exp_with_jacobian, right_jacobian};
/// let v = Vector3::new(0.1, -0.2, 0.3_f64);
/// assert_eq!(exp_with_jacobian(&v), (exp(&v), right_jacobian(&v)));
/// ```
#[inline]
pub fn exp_with_jacobian<T: Real>(v: &Vector3<T>) -> (Matrix3<T>, Matrix3<T>) {
    let (first, second, third) = coefficients(squared(v));
    (assemble(v, first, second), assemble(v, -second, third))
}

/// Inverse of the right Jacobian, for |v| < 2 pi: I + \[v]/2 + (1/a^2 - cot(a/2)/(2a)) \[v]^2.
///
/// # Example
/// ```
/// use nalgebra::{Matrix3, Vector3};
/// use stillrate::attitude::so3::{right_jacobian, right_jacobian_inverse};
/// let v = Vector3::new(0.3, -0.2, 1.9);
/// let product = right_jacobian(&v) * right_jacobian_inverse(&v);
/// assert!((product - Matrix3::<f64>::identity()).amax() < 1e-15);
/// ```
#[inline]
pub fn right_jacobian_inverse<T: Real>(v: &Vector3<T>) -> Matrix3<T> {
    let a2 = squared(v);
    let second = if a2 < T::of(SERIES_BELOW) {
        series(a2, [1.0 / 12.0, 1.0 / 720.0, 1.0 / 30_240.0, 1.0 / 1_209_600.0, 1.0 / 47_900_160.0])
    } else {
        let a = a2.root();
        let (sine, cosine) = (a * T::HALF).sine_cosine();
        T::ONE / a2 - cosine / (sine * T::TWO * a)
    };
    assemble(v, T::HALF, second)
}

/// The vector of the antisymmetric part of a matrix: what a small-angle method takes for Log.
///
/// Its length is sin a where that of [`log`] is a.
///
/// # Example
/// ```
/// use nalgebra::Vector3;
/// use stillrate::attitude::so3::{antisymmetric_part, exp};
/// let turn = exp(&Vector3::new(0.0, 0.0, 0.5_f64));
/// assert!((antisymmetric_part(&turn).z - 0.5_f64.sin()).abs() < 1e-15);
/// ```
#[inline]
pub fn antisymmetric_part<T: Real>(c: &Matrix3<T>) -> Vector3<T> {
    Vector3::new(
        (c[(2, 1)] - c[(1, 2)]) * T::HALF,
        (c[(0, 2)] - c[(2, 0)]) * T::HALF,
        (c[(1, 0)] - c[(0, 1)]) * T::HALF,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn direction(x: f64, y: f64, z: f64) -> Vector3<f64> {
        let v = Vector3::new(x, y, z);
        v / squared(&v).root()
    }

    #[test]
    fn series_and_quotients_meet_where_they_switch() {
        let below = coefficients(SERIES_BELOW * (1.0 - 1e-12));
        let above = coefficients(SERIES_BELOW * (1.0 + 1e-12));
        // The quotients lose eps / a^2 on (a - sin a)/a^3, 6e-14 relative at a = 0.1; the others nothing.
        assert!((below.0 - above.0).abs() < 1e-13 && (below.1 - above.1).abs() < 1e-13);
        assert!((below.2 / above.2 - 1.0).abs() < 2e-13);
    }

    #[test]
    fn jacobian_is_the_derivative_of_exp() {
        let v = direction(0.2, -0.7, 0.4) * 1.3;
        let h = 1e-6;
        for axis in 0..3 {
            let mut d = Vector3::zeros();
            d[axis] = h;
            let numeric =
                (log(&(exp(&v).transpose() * exp(&(v + d)))) - log(&(exp(&v).transpose() * exp(&(v - d))))) / (2.0 * h);
            let exact = right_jacobian(&v).column(axis).into_owned();
            assert!((numeric - exact).amax() < 1e-9);
        }
    }

    #[test]
    fn log_past_pi_is_the_shorter_rotation() {
        let v = direction(1.0, 2.0, -2.0) * (core::f64::consts::PI + 1e-3);
        let shorter = direction(1.0, 2.0, -2.0) * (1e-3 - core::f64::consts::PI);
        assert!((log(&exp(&v)) - shorter).amax() < 4e-15);
    }

    #[test]
    fn works_in_single_precision_down_to_tiny_angles() {
        for angle in [0.0_f32, 1e-30, 1e-18, 1e-9, 1e-4, 1e-2, 0.1, 1.0, 3.0] {
            let v = Vector3::new(0.6_f32, -0.64, 0.48) * angle;
            let back = log(&exp(&v));
            assert!((back - v).amax() <= 1e-6 * angle, "{angle}: {back}");
        }
    }

    proptest! {
        #[test]
        fn log_undoes_exp(x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in 0.01..1.0_f64, angle in 0.0..core::f64::consts::PI - 1e-5) {
            let v = direction(x, y, z) * angle;
            prop_assert!((log(&exp(&v)) - v).amax() < 5e-15);
        }

        #[test]
        fn exp_is_orthonormal(x in -4.0..4.0_f64, y in -4.0..4.0_f64, z in -4.0..4.0_f64) {
            let c = exp(&Vector3::new(x, y, z));
            prop_assert!((c.transpose() * c - Matrix3::identity()).amax() < 2e-15);
        }
    }
}
