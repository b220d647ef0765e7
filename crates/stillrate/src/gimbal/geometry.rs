//! Axes of the instruments for one set of coefficients, and everything else of the model that stays constant with them.
//!
//! Gyro i has input, output and spin axis I, O, S (platform axes by its triad); its mounting turns it by ds about S, then
//! by do about O: I' = cos ds cos do I + sin ds O - cos ds sin do S, O' = -sin ds cos do I + cos ds O + sin ds sin do S,
//! S' = sin do I + cos do S. Accelerometer i has a = cos thp cos tho I + cos thp sin tho P - sin thp O. The rows I' form A_g.

use nalgebra::{Matrix3, Vector3};

use super::coefficients::{
    Coefficients, FORCE_ABOUT_OUTPUT, FORCE_ABOUT_PENDULOUS, G_INPUT, G_OUTPUT, G_SPIN, GYRO_ABOUT_OUTPUT,
    GYRO_ABOUT_SPIN, LATITUDE, Triads,
};
use super::model::Model;
use super::rotation::{cross, product, sine_cosine};
use crate::real::Real;

/// Axes of one gyro and the derivatives of its input axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroAxes {
    /// Input axis I'.
    pub input: Vector3<f64>,
    /// Output axis O'.
    pub output: Vector3<f64>,
    /// Spin axis S'.
    pub spin: Vector3<f64>,
    /// dI'/d(do).
    pub input_by_output_angle: Vector3<f64>,
    /// dI'/d(ds).
    pub input_by_spin_angle: Vector3<f64>,
}

/// Input axis of one accelerometer and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceAxis {
    /// Input axis a.
    pub input: Vector3<f64>,
    /// da/d(thp).
    pub by_pendulous_angle: Vector3<f64>,
    /// da/d(tho).
    pub by_output_angle: Vector3<f64>,
}

/// p, q, r of a triad row put on the platform axes that the row names.
#[inline(always)]
fn placed(axes: &[usize; 3], values: [f64; 3]) -> Vector3<f64> {
    let mut v = Vector3::zeros();
    for (&axis, value) in axes.iter().zip(values) {
        if let Some(slot) = v.as_mut_slice().get_mut(axis) {
            *slot = value;
        }
    }
    v
}

/// Axes of a gyro with the given triad row and mounting angles (rad).
///
/// # Example
/// ```
/// use nalgebra::Vector3;
/// let axes = stillrate::gimbal::geometry::gyro_axes(&[0, 1, 2], 0.0, 0.0);
/// assert_eq!(axes.input, Vector3::x());
/// ```
#[must_use]
#[inline]
pub fn gyro_axes(triad: &[usize; 3], about_output: f64, about_spin: f64) -> GyroAxes {
    let (so, co) = sine_cosine(about_output);
    let (ss, cs) = sine_cosine(about_spin);
    GyroAxes {
        input: placed(triad, [cs * co, ss, -cs * so]),
        output: placed(triad, [-ss * co, cs, ss * so]),
        spin: placed(triad, [so, 0.0, co]),
        input_by_output_angle: placed(triad, [-cs * so, 0.0, -cs * co]),
        input_by_spin_angle: placed(triad, [-ss * co, cs, ss * so]),
    }
}

/// Input axis of an accelerometer with the given triad row and mounting angles (rad).
///
/// # Example
/// ```
/// use nalgebra::Vector3;
/// let axis = stillrate::gimbal::geometry::force_axis(&[0, 1, 2], 0.0, 0.0);
/// assert_eq!(axis.by_output_angle, Vector3::y());
/// ```
#[must_use]
#[inline]
pub fn force_axis(triad: &[usize; 3], about_pendulous: f64, about_output: f64) -> ForceAxis {
    let (sp, cp) = sine_cosine(about_pendulous);
    let (so, co) = sine_cosine(about_output);
    ForceAxis {
        input: placed(triad, [cp * co, cp * so, -sp]),
        by_pendulous_angle: placed(triad, [-sp * co, -sp * so, -cp]),
        by_output_angle: placed(triad, [-cp * so, cp * co, 0.0]),
    }
}

/// What stays constant while the coefficients do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// The coefficients it was made from.
    pub coefficients: Coefficients,
    /// The three gyros.
    pub gyros: [GyroAxes; 3],
    /// The three accelerometers.
    pub forces: [ForceAxis; 3],
    /// A_g^-1: columns are what one rad/s of each gyro's drift does to the platform.
    pub drift_to_rate: Matrix3<f64>,
    /// d(platform rate) / d(specific force), (rad/s)/(m/s^2).
    pub force_to_rate: Matrix3<f64>,
    /// Earth rate north, up, east, rad/s.
    pub earth_rate: Vector3<f64>,
    /// d(Earth rate)/d(latitude), rad/s per rad.
    pub earth_rate_by_latitude: Vector3<f64>,
}

/// Inverse of a matrix near the identity; the identity if the mounting angles are absurd (three input axes in one plane).
fn inverse(m: &Matrix3<f64>) -> Matrix3<f64> {
    let row = |i: usize| Vector3::new(m[(i, 0)], m[(i, 1)], m[(i, 2)]);
    let (a, b, c) = (row(0), row(1), row(2));
    let (bc, ca, ab) = (cross(&b, &c), cross(&c, &a), cross(&a, &b));
    let determinant = a.dot(&bc);
    if determinant.finite() && determinant.magnitude() > 1e-6 {
        Matrix3::from_columns(&[bc / determinant, ca / determinant, ab / determinant])
    } else {
        Matrix3::identity()
    }
}

impl Geometry {
    /// Works out the axes of all instruments.
    #[must_use]
    pub fn new(model: &Model, coefficients: &Coefficients) -> Self {
        let x = coefficients;
        let Triads { gyro, accelerometer } = &model.triads;
        let gyros: [GyroAxes; 3] =
            core::array::from_fn(|i| gyro_axes(&gyro[i], x[GYRO_ABOUT_OUTPUT + i], x[GYRO_ABOUT_SPIN + i]));
        let forces = core::array::from_fn(|i| {
            force_axis(&accelerometer[i], x[FORCE_ABOUT_PENDULOUS + i], x[FORCE_ABOUT_OUTPUT + i])
        });
        let inputs = Matrix3::from_fn(|i, j| gyros[i].input[j]);
        let drift_to_rate = inverse(&inputs);
        let sensitive = Matrix3::from_fn(|i, j| {
            let axes = &gyros[i];
            (x[G_INPUT + i] * axes.input[j] + x[G_OUTPUT + i] * axes.output[j] + x[G_SPIN + i] * axes.spin[j])
                / model.gravity_m_s2
        });
        let (sine, cosine) = (model.latitude_rad + x[LATITUDE]).sine_cosine();
        Self {
            coefficients: *coefficients,
            gyros,
            forces,
            drift_to_rate,
            force_to_rate: product(&drift_to_rate, &sensitive),
            earth_rate: Vector3::new(model.earth_rate_rad_s * cosine, model.earth_rate_rad_s * sine, 0.0),
            earth_rate_by_latitude: Vector3::new(-model.earth_rate_rad_s * sine, model.earth_rate_rad_s * cosine, 0.0),
        }
    }
}
