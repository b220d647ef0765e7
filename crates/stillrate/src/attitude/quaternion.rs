//! Unit quaternions, scalar first, Hamilton product: another form of a rotation matrix.
//!
//! q = (w, x, y, z) = (cos a/2, n sin a/2) turns vectors like Exp(a n). From a matrix by Shepperd's largest pivot
//! (J. Guidance and Control 1, 1978), which never divides by a small number.

use nalgebra::{Matrix3, Vector3};

use crate::error::ConfigError;
use crate::real::Real;

/// A unit quaternion, scalar first.
///
/// # Example
/// ```
/// use stillrate::attitude::Quaternion;
/// let half_turn = Quaternion::checked([0.0, 0.0, 0.0, 1.0])?;
/// assert_eq!(half_turn.matrix()[(0, 0)], -1.0_f64);
/// let quarter_turn = Quaternion::checked([core::f64::consts::FRAC_1_SQRT_2, 0.0, 0.0, core::f64::consts::FRAC_1_SQRT_2])?;
/// let three_quarters = half_turn.times(&quarter_turn);
/// // The long way round is the short way back: a quarter turn about -z.
/// assert!((three_quarters.log().z + core::f64::consts::FRAC_PI_2).abs() < 1e-15);
/// assert!(Quaternion::from_matrix(&three_quarters.matrix()).w > 0.0 && three_quarters.w < 0.0); // q and -q are one rotation
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Quaternion<T> {
    /// Scalar part.
    pub w: T,
    /// First component of the vector part.
    pub x: T,
    /// Second component of the vector part.
    pub y: T,
    /// Third component of the vector part.
    pub z: T,
}

/// How far from 1 the length of a given quaternion may be; rounding to four digits stays inside.
pub const LENGTH_TOLERANCE: f64 = 1e-3;

impl<T: Real> Quaternion<T> {
    /// Takes (w, x, y, z) and scales it to length one.
    ///
    /// # Errors
    /// [`ConfigError`] where a component is not finite or the length is further than [`LENGTH_TOLERANCE`] from 1.
    pub fn checked([w, x, y, z]: [T; 4]) -> Result<Self, ConfigError> {
        let length = (w * w + x * x + y * y + z * z).root();
        if length.finite() && (length - T::ONE).magnitude() <= T::of(LENGTH_TOLERANCE) {
            Ok(Self { w: w / length, x: x / length, y: y / length, z: z / length })
        } else {
            Err(ConfigError::new("quaternion length", length.widen(), "", "finite and within 0.001 of 1"))
        }
    }

    /// The rotation matrix.
    #[must_use]
    #[inline]
    pub fn matrix(&self) -> Matrix3<T> {
        let Self { w, x, y, z } = *self;
        let two = T::TWO;
        Matrix3::new(
            T::ONE - two * (y * y + z * z),
            two * (x * y - w * z),
            two * (x * z + w * y),
            two * (x * y + w * z),
            T::ONE - two * (x * x + z * z),
            two * (y * z - w * x),
            two * (x * z - w * y),
            two * (y * z + w * x),
            T::ONE - two * (x * x + y * y),
        )
    }

    /// The quaternion of a rotation matrix, with a scalar part that is not negative.
    #[must_use]
    #[inline]
    pub fn from_matrix(c: &Matrix3<T>) -> Self {
        let (xx, yy, zz) = (c[(0, 0)], c[(1, 1)], c[(2, 2)]);
        // Four times the square of each component; the largest of them is at least 1.
        let ww4 = T::ONE + xx + yy + zz;
        let xx4 = T::ONE + xx - yy - zz;
        let yy4 = T::ONE - xx + yy - zz;
        let zz4 = T::ONE - xx - yy + zz;
        let wx = c[(2, 1)] - c[(1, 2)];
        let wy = c[(0, 2)] - c[(2, 0)];
        let wz = c[(1, 0)] - c[(0, 1)];
        let xy = c[(1, 0)] + c[(0, 1)];
        let xz = c[(0, 2)] + c[(2, 0)];
        let yz = c[(2, 1)] + c[(1, 2)];
        let raw = if ww4 >= xx4 && ww4 >= yy4 && ww4 >= zz4 {
            Self { w: ww4, x: wx, y: wy, z: wz }
        } else if xx4 >= yy4 && xx4 >= zz4 {
            Self { w: wx, x: xx4, y: xy, z: xz }
        } else if yy4 >= zz4 {
            Self { w: wy, x: xy, y: yy4, z: yz }
        } else {
            Self { w: wz, x: xz, y: yz, z: zz4 }
        };
        let length = (raw.w * raw.w + raw.x * raw.x + raw.y * raw.y + raw.z * raw.z).root();
        let scale = T::select(raw.w < T::ZERO, -T::ONE, T::ONE) / length;
        Self { w: raw.w * scale, x: raw.x * scale, y: raw.y * scale, z: raw.z * scale }
    }

    /// Rotation vector (rad, length at most pi).
    #[must_use]
    #[inline]
    pub fn log(&self) -> Vector3<T> {
        let sign = T::select(self.w < T::ZERO, -T::ONE, T::ONE);
        let w = self.w * sign;
        let sine2 = self.x * self.x + self.y * self.y + self.z * self.z;
        let t = sine2 / (w * w);
        let scale = if t < T::of(1e-4) {
            // 2 atan(s)/s with s = |vector|/w: s itself may be too small to be squared and rooted again.
            T::TWO / w * (T::ONE - t * (T::of(1.0 / 3.0) - t * (T::of(0.2) - t * T::of(1.0 / 7.0))))
        } else {
            let sine = sine2.root();
            T::TWO * sine.angle_over(w) / sine
        };
        Vector3::new(self.x, self.y, self.z) * (scale * sign)
    }

    /// The product: first `other`, then `self`.
    #[must_use]
    #[inline]
    pub fn times(&self, other: &Self) -> Self {
        let (a, b) = (self, other);
        Self {
            w: a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
            x: a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            y: a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            z: a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude::so3;
    use proptest::prelude::*;

    #[test]
    fn refuses_what_is_not_a_unit_quaternion() {
        assert!(Quaternion::checked([0.9, 0.0, 0.0, 0.0]).is_err());
        assert!(Quaternion::checked([f64::NAN, 0.0, 0.0, 1.0]).is_err());
        assert!(Quaternion::checked([0.0_f64; 4]).is_err());
    }

    proptest! {
        #[test]
        fn products_match_matrices(a in prop::array::uniform3(-2.0..2.0_f64), b in prop::array::uniform3(-2.0..2.0_f64)) {
            let (a, b) = (so3::exp(&a.into()), so3::exp(&b.into()));
            let product = Quaternion::from_matrix(&a).times(&Quaternion::from_matrix(&b)).matrix();
            prop_assert!((product - a * b).amax() < 4e-15);
        }
    }
}
