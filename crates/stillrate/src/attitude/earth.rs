//! The turning Earth: rate, position and attitude in an inertial frame, exact and safe at the poles.
//!
//! C_n_e(latitude, longitude) has the north, east and down axes as columns in Earth-fixed coordinates; no cosine of the latitude
//! is ever divided by, so a pole is a place like any other (longitude then says where "north" points).
//! C_b_i(t) = Rz(Omega (t - t0)) C_n_e C_b_n contains Earth rate and transport rate exactly, whatever the vehicle does
//! between two fixes (Groves, Principles of GNSS, Inertial, and Multisensor Integrated Navigation, 2nd ed., section 2.5).

use nalgebra::{Matrix3, Vector3};

use crate::attitude::rotation::{Body, EarthFixed, Inertial, Navigation, Rotation};
use crate::real::Real;

/// Angular rate of the Earth (WGS 84), rad/s.
pub const EARTH_RATE_RAD_S: f64 = 7.292_115e-5;

/// Where north, east and down point at a latitude and longitude (rad): C_n_e.
///
/// # Example
/// ```
/// use nalgebra::Vector3;
/// use stillrate::attitude::earth::position;
/// let down = position(0.0, 0.0) * Vector3::z();
/// assert_eq!(down, Vector3::new(-1.0, 0.0, 0.0)); // on the equator, down is towards the axis
/// ```
#[must_use]
pub fn position<T: Real>(latitude_rad: T, longitude_rad: T) -> Rotation<T, Navigation, EarthFixed> {
    let (sine, cosine) = latitude_rad.sine_cosine();
    let (sine_lon, cosine_lon) = longitude_rad.sine_cosine();
    Rotation::trusted(Matrix3::new(
        -sine * cosine_lon,
        -sine_lon,
        -cosine * cosine_lon,
        -sine * sine_lon,
        cosine_lon,
        -cosine * sine_lon,
        cosine,
        T::ZERO,
        -sine,
    ))
}

/// How far the Earth has turned after `elapsed_s` seconds: Rz(Omega t).
///
/// # Example
/// ```
/// use stillrate::attitude::earth::{EARTH_RATE_RAD_S, turned};
/// assert!((turned(3600.0_f64).log().z - 3600.0 * EARTH_RATE_RAD_S).abs() < 1e-15);
/// ```
#[must_use]
pub fn turned<T: Real>(elapsed_s: T) -> Rotation<T, EarthFixed, Inertial> {
    let (sine, cosine) = (T::of(EARTH_RATE_RAD_S) * elapsed_s).sine_cosine();
    Rotation::trusted(Matrix3::new(cosine, -sine, T::ZERO, sine, cosine, T::ZERO, T::ZERO, T::ZERO, T::ONE))
}

/// Attitude in the inertial frame: C_b_i = Rz(Omega t) C_n_e C_b_n.
///
/// # Example
/// ```
/// use stillrate::attitude::{Body, Navigation, Rotation, earth, so3};
/// let level = Rotation::<f64, Body, Navigation>::identity();
/// let start = earth::inertial_attitude(0.9, 0.1, level, 0.0);
/// let later = earth::inertial_attitude(0.9, 0.1, level, 10.0);
/// let turn = (start.inverse() * later).log();
/// assert!((turn.norm() / 10.0 - earth::EARTH_RATE_RAD_S).abs() < 1e-15);
/// ```
#[must_use]
pub fn inertial_attitude<T: Real>(
    latitude_rad: T,
    longitude_rad: T,
    attitude: Rotation<T, Body, Navigation>,
    elapsed_s: T,
) -> Rotation<T, Body, Inertial> {
    turned(elapsed_s) * (position(latitude_rad, longitude_rad) * attitude)
}

/// Earth rate in north, east, down at a latitude (rad), rad/s.
///
/// # Example
/// ```
/// use stillrate::attitude::earth::{EARTH_RATE_RAD_S, earth_rate_ned};
/// assert_eq!(earth_rate_ned(0.0), nalgebra::Vector3::new(EARTH_RATE_RAD_S, 0.0, -0.0));
/// ```
#[must_use]
pub fn earth_rate_ned<T: Real>(latitude_rad: T) -> Vector3<T> {
    let (sine, cosine) = latitude_rad.sine_cosine();
    let rate = T::of(EARTH_RATE_RAD_S);
    Vector3::new(rate * cosine, T::ZERO, -rate * sine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::FRAC_PI_2;

    #[test]
    fn earth_rate_in_local_axes_is_the_polar_axis() {
        for (latitude, longitude) in [(0.3, 2.0), (-1.2, -0.5), (FRAC_PI_2, 0.7), (-FRAC_PI_2, 3.0)] {
            let polar = Vector3::new(0.0, 0.0, EARTH_RATE_RAD_S);
            let local = position(latitude, longitude).inverse() * polar;
            assert!((local - earth_rate_ned(latitude)).amax() < 1e-19);
        }
    }

    #[test]
    fn crossing_a_pole_turns_nothing_but_the_names() {
        // A body that glides over the pole along a meridian: its attitude in inertial space is continuous
        // although its heading jumps by pi and its longitude by pi.
        let before = inertial_attitude(FRAC_PI_2 - 1e-9, 0.4, Rotation::identity(), 0.0);
        let heading_back = Rotation::from_euler(0.0, 0.0, core::f64::consts::PI);
        let after = inertial_attitude(FRAC_PI_2 - 1e-9, 0.4 + core::f64::consts::PI, heading_back, 0.0);
        assert!((before.inverse() * after).log().amax() < 3e-9);
    }
}
