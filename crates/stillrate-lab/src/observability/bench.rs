//! The worked example: an IMU on the bench, standing still in one attitude after the other, with zero-velocity updates.
//!
//! Twelve error states in north-east-down: velocity, attitude phi (C_hat = (I - [phi x]) C), gyro bias, accelerometer bias:
//! dv' = -2 w x dv + [f x] phi + C ba, phi' = -w x phi - C bg, with Earth rate w and specific force f = (0, 0, -g).

use nalgebra::{DMatrix, Matrix3, Vector3};
use stillrate::attitude::{Body, Navigation, Rotation, earth, so3};

/// Names of the twelve states.
pub const BENCH_STATES: [&str; 12] =
    ["dvN", "dvE", "dvD", "phN", "phE", "phD", "bgx", "bgy", "bgz", "bax", "bay", "baz"];

/// A of the bench IMU for one attitude (roll, pitch, yaw, rad) at a latitude (rad) under a gravity (m/s^2).
///
/// # Example
/// ```
/// use stillrate_lab::observability::{BENCH_STATES, bench_imu, bench_measurement};
/// let a = bench_imu([0.0; 3], 0.8, 9.81);
/// assert_eq!((a.nrows(), bench_measurement().nrows(), BENCH_STATES[6]), (12, 3, "bgx"));
/// assert_eq!(a[(0, 4)], 9.81); // a pitch error tilts gravity into north
/// ```
#[must_use]
pub fn bench_imu(euler_rad: [f64; 3], latitude_rad: f64, gravity_m_s2: f64) -> DMatrix<f64> {
    let [roll, pitch, yaw] = euler_rad;
    let attitude = *Rotation::<f64, Body, Navigation>::from_euler(roll, pitch, yaw).matrix();
    let turning = so3::cross_matrix(&earth::earth_rate_ned(latitude_rad));
    let force = so3::cross_matrix(&Vector3::new(0.0, 0.0, -gravity_m_s2));
    let mut a = DMatrix::zeros(12, 12);
    let mut put = |row: usize, column: usize, block: Matrix3<f64>| {
        a.view_mut((row, column), (3, 3)).copy_from(&block);
    };
    put(0, 0, turning * -2.0);
    put(0, 3, force);
    put(0, 9, attitude);
    put(3, 3, -turning);
    put(3, 6, -attitude);
    a
}

/// H of a zero-velocity update: the three velocities.
///
/// # Example
/// ```
/// let measurement = stillrate_lab::observability::bench_measurement();
/// assert_eq!((measurement.shape(), measurement[(2, 2)], measurement.sum()), ((3, 12), 1.0, 3.0));
/// ```
#[must_use]
pub fn bench_measurement() -> DMatrix<f64> {
    DMatrix::from_fn(3, 12, |i, j| f64::from(u8::from(i == j)))
}
