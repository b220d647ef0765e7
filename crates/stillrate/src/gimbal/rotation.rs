//! Rotations of the gimballed platform: the exponential of a rotation vector, its inverse, and sines of mounting angles.
//!
//! `exponential(v)` is exp(+[v x]) (Rodrigues: I + a [v x] + b [v x]^2 with a = sin t / t, b = (1 - cos t) / t^2, t = |v|), so
//! that a frame rotated by +phi has the direction cosine matrix exp(-[phi x]) = `exponential(-phi)`. The angles of one step
//! are small, so a and b come from their power series (Horner, error below 1e-17) up to half a radian.
//!
//! Beside [`so3`](crate::attitude::so3), which is exact at any angle in either number format, this is the same mathematics for one use: `f64` only,
//! no sine within a step, a vector turned without its matrix. The two round differently, so they are no substitute for each other bit for bit.

use nalgebra::{Matrix3, Vector3};

use crate::real::Real;

/// Squared angle up to which the series serve, rad^2.
const SERIES_LIMIT: f64 = 0.25;
/// Squared angle up to which four terms of them do (the fifth is below 3e-18 of the sum).
const SHORT_LIMIT: f64 = 1e-3;

/// sin t / t and (1 - cos t) / t^2 as functions of t^2.
#[inline(always)]
fn rodrigues(t2: f64) -> (f64, f64) {
    if t2 <= SHORT_LIMIT {
        let a = 1.0 + t2 * (-1.0 / 6.0 + t2 * (1.0 / 120.0 - t2 * (1.0 / 5040.0)));
        let b = 0.5 + t2 * (-1.0 / 24.0 + t2 * (1.0 / 720.0 - t2 * (1.0 / 40_320.0)));
        (a, b)
    } else if t2 <= SERIES_LIMIT {
        let a = 1.0
            + t2 * (-1.0 / 6.0
                + t2 * (1.0 / 120.0
                    + t2 * (-1.0 / 5040.0
                        + t2 * (1.0 / 362_880.0 + t2 * (-1.0 / 39_916_800.0 + t2 / 6_227_020_800.0)))));
        let b = 0.5
            + t2 * (-1.0 / 24.0
                + t2 * (1.0 / 720.0
                    + t2 * (-1.0 / 40_320.0
                        + t2 * (1.0 / 3_628_800.0 + t2 * (-1.0 / 479_001_600.0 + t2 / 87_178_291_200.0)))));
        (a, b)
    } else {
        let t = t2.root();
        let (sine, _) = t.sine_cosine();
        let (half, _) = (0.5 * t).sine_cosine();
        (sine / t, 2.0 * half * half / t2)
    }
}

/// exp(+[v x]) of a rotation vector in rad.
///
/// # Example
/// ```
/// use nalgebra::Vector3;
/// use stillrate::gimbal::rotation::exponential;
/// let quarter = exponential(&Vector3::new(0.0, 0.0, core::f64::consts::FRAC_PI_2));
/// assert!((quarter * Vector3::x() - Vector3::y()).abs().max() < 1e-15);
/// ```
#[must_use]
#[inline(always)]
pub fn exponential(v: &Vector3<f64>) -> Matrix3<f64> {
    let (x, y, z) = (v[0], v[1], v[2]);
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let (a, b) = rodrigues(xx + yy + zz);
    let (bxy, bxz, byz) = (b * x * y, b * x * z, b * y * z);
    let (ax, ay, az) = (a * x, a * y, a * z);
    Matrix3::new(
        1.0 - b * (yy + zz),
        bxy - az,
        bxz + ay,
        bxy + az,
        1.0 - b * (xx + zz),
        byz - ax,
        bxz - ay,
        byz + ax,
        1.0 - b * (xx + yy),
    )
}

/// exp(+[v x]) f without the matrix: f + a v x f + b v x (v x f).
#[must_use]
#[inline(always)]
pub(super) fn turned(v: &Vector3<f64>, f: &Vector3<f64>) -> Vector3<f64> {
    let (a, b) = rodrigues(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    let once = cross(v, f);
    let twice = cross(v, &once);
    Vector3::new(
        f[0] + (a * once[0] + b * twice[0]),
        f[1] + (a * once[1] + b * twice[1]),
        f[2] + (a * once[2] + b * twice[2]),
    )
}

/// The rotation vector v of least angle with `exponential(v)` equal to `r`; good below half a turn.
///
/// # Example
/// ```
/// use nalgebra::Vector3;
/// use stillrate::gimbal::rotation::{exponential, logarithm};
/// let v = Vector3::new(0.1, -0.2, 0.3);
/// assert!((logarithm(&exponential(&v)) - v).abs().max() < 1e-15);
/// ```
#[must_use]
pub fn logarithm(r: &Matrix3<f64>) -> Vector3<f64> {
    let twice = Vector3::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
    let sine = 0.5 * twice.dot(&twice).root();
    let cosine = 0.5 * (r[(0, 0)] + r[(1, 1)] + r[(2, 2)] - 1.0);
    let angle = sine.angle_over(cosine);
    // t / (2 sin t) tends to 1/2; the quotient is still accurate at 1e-8 rad, where t^2 / 12 is below rounding.
    let factor = if sine > 1e-8 { 0.5 * angle / sine } else { 0.5 };
    twice * factor
}

/// Sine and cosine of a mounting angle: the series below half a radian, else the general function.
#[must_use]
#[inline(always)]
pub(super) fn sine_cosine(angle: f64) -> (f64, f64) {
    let t2 = angle * angle;
    if t2 <= SERIES_LIMIT {
        let (a, b) = rodrigues(t2);
        (angle * a, 1.0 - t2 * b)
    } else {
        angle.sine_cosine()
    }
}

/// Cross product, written out.
#[must_use]
#[inline(always)]
pub(super) fn cross(a: &Vector3<f64>, b: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
}

/// Inverse of a matrix near the identity from its rows; the identity where they lie in one plane (absurd mounting angles).
pub(super) fn inverse_of_rows([a, b, c]: [&Vector3<f64>; 3]) -> Matrix3<f64> {
    let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
    let determinant = a.dot(&bc);
    if determinant.finite() && determinant.magnitude() > 1e-6 {
        Matrix3::from_columns(&[bc / determinant, ca / determinant, ab / determinant])
    } else {
        Matrix3::identity()
    }
}

/// Product of two 3x3 matrices, written out so that it stays in registers.
#[must_use]
#[inline(always)]
pub(super) fn product(a: &Matrix3<f64>, b: &Matrix3<f64>) -> Matrix3<f64> {
    let (a, b) = (&a.data.0, &b.data.0);
    let column =
        |j: usize| -> [f64; 3] { core::array::from_fn(|i| a[0][i] * b[j][0] + a[1][i] * b[j][1] + a[2][i] * b[j][2]) };
    let (c0, c1, c2) = (column(0), column(1), column(2));
    Matrix3::new(c0[0], c1[0], c2[0], c0[1], c1[1], c2[1], c0[2], c1[2], c2[2])
}

/// Product of a 3x3 matrix and a vector, written out.
#[must_use]
#[inline(always)]
pub(super) fn apply(a: &Matrix3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    let a = &a.data.0;
    let row = |i: usize| a[0][i] * v[0] + a[1][i] * v[1] + a[2][i] * v[2];
    Vector3::new(row(0), row(1), row(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_meet_the_closed_form_at_the_limit() {
        for t2 in [9.99e-4, 1.001e-3, 0.2499, 0.25] {
            let t = f64::root(t2);
            let (sine, half) = (t.sine_cosine().0, (0.5 * t).sine_cosine().0);
            let (a, b) = rodrigues(t2);
            assert!((a - sine / t).abs() < 3e-16);
            // 1 - cos t = 2 sin^2(t / 2) keeps its digits.
            assert!((b - 2.0 * half * half / t2).abs() < 3e-16);
        }
    }

    #[test]
    fn a_vector_turns_as_the_matrix_turns_it() {
        for v in [[1e-5, -3e-6, 2e-6], [0.01, 0.02, -0.005], [0.3, -0.2, 0.1], [2.0, -1.0, 3.0]] {
            let (v, f) = (Vector3::from(v), Vector3::new(0.3, 9.8, -4.0));
            assert!((turned(&v, &f) - exponential(&v) * f).abs().max() < 1e-14);
        }
    }

    #[test]
    fn an_exponential_is_a_rotation_for_any_angle() {
        for v in [[0.0, 0.0, 0.0], [1e-9, 0.0, 0.0], [0.3, -0.2, 0.1], [2.0, -1.0, 3.0], [40.0, 3.0, -7.0]] {
            let r = exponential(&Vector3::from(v));
            assert!((r * r.transpose() - Matrix3::identity()).abs().max() < 4e-15);
        }
    }
}
