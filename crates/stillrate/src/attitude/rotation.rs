//! A rotation that knows which frame it comes from and which it goes to.
//!
//! `Rotation<T, Body, Navigation>` is the textbook's C_b_n: it takes coordinates in [`Body`] to coordinates in [`Navigation`].
//! Two rotations multiply only where the inner frames agree; everything else does not compile. The frames are empty
//! types, so the compiled code is that of the bare matrices.

use core::marker::PhantomData;
use core::ops::Mul;

use nalgebra::{Matrix3, Vector3};

use crate::attitude::quaternion::Quaternion;
use crate::attitude::{dcm, so3};
use crate::error::ConfigError;
use crate::real::Real;

/// A coordinate frame: an empty type.
///
/// # Example
/// A frame of one's own, for a camera on the vehicle:
/// ```
/// use stillrate::attitude::{Body, Frame, Rotation};
/// #[derive(Clone, Copy, Debug)]
/// struct Camera;
/// impl Frame for Camera {
///     const NAME: &'static str = "camera";
/// }
/// let looking_down = Rotation::<f64, Camera, Body>::from_euler(0.0, -core::f64::consts::FRAC_PI_2, 0.0);
/// assert!((looking_down * nalgebra::Vector3::x()).z > 0.999);
/// ```
pub trait Frame: Copy + Send + Sync + core::fmt::Debug + 'static {
    /// Its name in error messages and tables.
    const NAME: &'static str;
}

macro_rules! frames {
    ($($(#[$meta:meta])* $name:ident, $text:expr;)+) => {
        $(
            $(#[$meta])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub struct $name;
            impl Frame for $name {
                const NAME: &'static str = $text;
            }
        )+
    };
}

frames! {
    /// Body of the vehicle or of the reference: forward, right, down.
    ///
    /// # Example
    /// ```
    /// use stillrate::attitude::{Body, Navigation, Rotation};
    /// let nose_up = Rotation::<f64, Body, Navigation>::from_euler(0.0, 0.1, 0.0);
    /// assert!((nose_up * nalgebra::Vector3::x()).z < 0.0); // forward points away from down
    /// ```
    Body, "body";
    /// Axes of the inertial sensor, turned from [`Body`] by the mounting.
    ///
    /// # Example
    /// ```
    /// use stillrate::attitude::{Body, Rotation, Sensor};
    /// let mounting = Rotation::<f64, Body, Sensor>::from_euler(core::f64::consts::PI, 0.0, 0.0); // upside down
    /// assert!((mounting * nalgebra::Vector3::z()).z < 0.0);
    /// ```
    Sensor, "sensor";
    /// North, east, down at the present place.
    ///
    /// # Example
    /// ```
    /// use nalgebra::Vector3;
    /// use stillrate::attitude::{Navigation, Rotation, earth};
    /// let to_north_pole = earth::position(core::f64::consts::FRAC_PI_2, 0.0);
    /// let polar_axis = to_north_pole.inverse() * Vector3::z(); // in north, east, down
    /// assert!((polar_axis + Vector3::z()).amax() < 1e-15); // straight up
    /// ```
    Navigation, "navigation";
    /// Turns with the Earth: x through latitude and longitude 0, z through the north pole.
    ///
    /// # Example
    /// ```
    /// use stillrate::attitude::{EarthFixed, Navigation, Rotation, earth};
    /// let here: Rotation<f64, Navigation, EarthFixed> = earth::position(0.0, 0.0);
    /// assert_eq!(here * nalgebra::Vector3::x(), nalgebra::Vector3::z()); // north on the equator
    /// ```
    EarthFixed, "earth";
    /// [`EarthFixed`] as it stood at the start, not turning.
    ///
    /// # Example
    /// ```
    /// use stillrate::attitude::{EarthFixed, Inertial, Rotation, earth};
    /// let after_a_sidereal_day: Rotation<f64, EarthFixed, Inertial> = earth::turned(86_164.1);
    /// assert!(after_a_sidereal_day.log().norm() < 1e-6);
    /// ```
    Inertial, "inertial";
}

/// A rotation from the coordinates of frame `From` to those of frame `To`.
///
/// # Example
/// As an engineer writes it, C_b_e = C_n_e C_b_n:
/// ```
/// use nalgebra::Vector3;
/// use stillrate::attitude::{Body, EarthFixed, Navigation, Rotation, earth};
/// let c_b_n = Rotation::<f64, Body, Navigation>::from_euler(0.1, -0.2, 1.0);
/// let c_n_e = earth::position(0.9, 0.1);
/// let c_b_e: Rotation<f64, Body, EarthFixed> = c_n_e * c_b_n;
/// let forward = c_b_e * Vector3::x();
/// assert!((forward.norm() - 1.0).abs() < 1e-15);
/// ```
/// In other forms, checked on the way in:
/// ```
/// use nalgebra::Vector3;
/// use stillrate::attitude::{Body, Navigation, Rotation};
/// let turn = Rotation::<f64, Body, Navigation>::exp(&Vector3::new(0.3, -0.2, 1.0));
/// assert!((turn.log() - Vector3::new(0.3, -0.2, 1.0)).amax() < 1e-15);
/// assert!((Rotation::<f64, Body, Navigation>::from_quaternion(&turn.quaternion()).matrix() - turn.matrix()).amax() < 1e-15);
/// let four_digits = turn.matrix().map(|entry| (entry * 1e4).round() / 1e4);
/// assert!(Rotation::<f64, Body, Navigation>::checked(four_digits).is_err());
/// let nearest = Rotation::<f64, Body, Navigation>::projected(four_digits)?;
/// let off: Rotation<f64, Body, Body> = nearest.inverse() * turn;
/// assert!(off.log().norm() < 1e-4 && off != Rotation::identity());
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
/// Frames that do not meet do not compile:
/// ```compile_fail
/// use stillrate::attitude::{Body, Navigation, Rotation};
/// let c_b_n = Rotation::<f64, Body, Navigation>::from_euler(0.1, -0.2, 1.0);
/// let nonsense = c_b_n * c_b_n;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation<T, From, To> {
    matrix: Matrix3<T>,
    frames: PhantomData<(From, To)>,
}

impl<T: Real, From: Frame, To: Frame> Rotation<T, From, To> {
    /// No rotation: both frames have the same axes.
    #[must_use]
    pub fn identity() -> Self {
        Self::trusted(Matrix3::identity())
    }

    /// Wraps a matrix that is known to be a rotation.
    #[inline(always)]
    pub(crate) const fn trusted(matrix: Matrix3<T>) -> Self {
        Self { matrix, frames: PhantomData }
    }

    /// Takes a direction cosine matrix that is one.
    ///
    /// # Errors
    /// [`ConfigError`] as [`dcm::check_dcm`].
    pub fn checked(matrix: Matrix3<T>) -> Result<Self, ConfigError> {
        dcm::check_dcm(&matrix).map(Self::trusted)
    }

    /// Takes a rounded direction cosine matrix and projects it.
    ///
    /// # Errors
    /// [`ConfigError`] as [`dcm::project_to_rotation`].
    pub fn projected(matrix: Matrix3<T>) -> Result<Self, ConfigError> {
        dcm::project_to_rotation(&matrix).map(Self::trusted)
    }

    /// Takes a unit quaternion (scalar first).
    #[must_use]
    pub fn from_quaternion(quaternion: &Quaternion<T>) -> Self {
        Self::trusted(quaternion.matrix())
    }

    /// Exp of a rotation vector (rad).
    #[must_use]
    pub fn exp(v: &Vector3<T>) -> Self {
        Self::trusted(so3::exp(v))
    }

    /// Rz(yaw) Ry(pitch) Rx(roll), angles in rad: for `Body` to `Navigation` the usual attitude of a vehicle.
    #[must_use]
    pub fn from_euler(roll: T, pitch: T, yaw: T) -> Self {
        let (sr, cr) = roll.sine_cosine();
        let (sp, cp) = pitch.sine_cosine();
        let (sy, cy) = yaw.sine_cosine();
        Self::trusted(Matrix3::new(
            cy * cp,
            cy * sp * sr - sy * cr,
            cy * sp * cr + sy * sr,
            sy * cp,
            sy * sp * sr + cy * cr,
            sy * sp * cr - cy * sr,
            -sp,
            cp * sr,
            cp * cr,
        ))
    }

    /// Rotation vector: rad, length at most pi.
    #[must_use]
    pub fn log(&self) -> Vector3<T> {
        so3::log(&self.matrix)
    }

    /// The rotation back.
    #[must_use]
    pub fn inverse(&self) -> Rotation<T, To, From> {
        Rotation::trusted(self.matrix.transpose())
    }

    /// The bare matrix.
    #[must_use]
    pub const fn matrix(&self) -> &Matrix3<T> {
        &self.matrix
    }

    /// The unit quaternion (scalar first, not negative).
    #[must_use]
    pub fn quaternion(&self) -> Quaternion<T> {
        Quaternion::from_matrix(&self.matrix)
    }
}

impl<T: Real, A: Frame, B: Frame, C: Frame> Mul<Rotation<T, A, B>> for Rotation<T, B, C> {
    type Output = Rotation<T, A, C>;
    #[inline]
    fn mul(self, first: Rotation<T, A, B>) -> Rotation<T, A, C> {
        Rotation::trusted(self.matrix * first.matrix)
    }
}

impl<T: Real, From: Frame, To: Frame> Mul<Vector3<T>> for Rotation<T, From, To> {
    type Output = Vector3<T>;
    #[inline]
    fn mul(self, vector: Vector3<T>) -> Vector3<T> {
        self.matrix * vector
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn euler_angles_turn_yaw_last() {
        let c = Rotation::<f64, Body, Navigation>::from_euler(0.3, -0.4, 2.0);
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        let product = so3::exp(&(z * 2.0)) * so3::exp(&(y * -0.4)) * so3::exp(&(x * 0.3));
        assert!((c.matrix() - product).amax() < 1e-15);
    }

    #[test]
    fn a_rotation_times_its_inverse_is_none() {
        let c = Rotation::<f64, Body, Navigation>::from_euler(0.3, -0.4, 2.0);
        let none: Rotation<f64, Body, Body> = c.inverse() * c;
        assert!((none.matrix() - Matrix3::identity()).amax() < 1e-15);
    }
}
