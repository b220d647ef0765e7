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
use super::rotation::{inverse_of_rows, product, sine_cosine};
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

impl GyroAxes {
    /// Axes of a gyro with the given triad row and mounting angles (rad).
    ///
    /// # Example
    /// ```
    /// use nalgebra::Vector3;
    /// use stillrate::gimbal::GyroAxes;
    /// let nominal = GyroAxes::new(&[0, 1, 2], 0.0, 0.0);
    /// assert_eq!((nominal.input, nominal.output, nominal.spin), (Vector3::x(), Vector3::y(), Vector3::z()));
    /// // Mounted askew about its spin axis, the input axis leans towards the nominal output axis.
    /// let askew = GyroAxes::new(&[0, 1, 2], 0.0, 1e-3);
    /// assert!((askew.input - nominal.input - nominal.input_by_spin_angle * 1e-3).amax() < 1e-6);
    /// ```
    #[must_use]
    #[inline]
    pub fn new(triad: &[usize; 3], about_output: f64, about_spin: f64) -> Self {
        let (so, co) = sine_cosine(about_output);
        let (ss, cs) = sine_cosine(about_spin);
        Self {
            input: placed(triad, [cs * co, ss, -cs * so]),
            output: placed(triad, [-ss * co, cs, ss * so]),
            spin: placed(triad, [so, 0.0, co]),
            input_by_output_angle: placed(triad, [-cs * so, 0.0, -cs * co]),
            input_by_spin_angle: placed(triad, [-ss * co, cs, ss * so]),
        }
    }
}

impl ForceAxis {
    /// Input axis of an accelerometer with the given triad row and mounting angles (rad).
    ///
    /// # Example
    /// ```
    /// use nalgebra::Vector3;
    /// use stillrate::gimbal::ForceAxis;
    /// let axis = ForceAxis::new(&[0, 1, 2], 0.0, 0.0);
    /// // Input along x; an angle about the output axis (z) lifts it towards y, one about the pendulous axis (y) away from z.
    /// assert_eq!((axis.input, axis.by_output_angle, axis.by_pendulous_angle), (Vector3::x(), Vector3::y(), -Vector3::z()));
    /// ```
    #[must_use]
    #[inline]
    pub fn new(triad: &[usize; 3], about_pendulous: f64, about_output: f64) -> Self {
        let (sp, cp) = sine_cosine(about_pendulous);
        let (so, co) = sine_cosine(about_output);
        Self {
            input: placed(triad, [cp * co, cp * so, -sp]),
            by_pendulous_angle: placed(triad, [-sp * co, -sp * so, -cp]),
            by_output_angle: placed(triad, [-cp * so, cp * co, 0.0]),
        }
    }
}

/// What stays constant while the coefficients do; its methods are the exact model.
///
/// # Example
/// The motion: a drift of gyro x turns the platform about x.
/// ```
/// use nalgebra::{Matrix3, Vector3};
/// use stillrate::gimbal::{COUNT, Geometry, Model, coefficients::GYRO_BIAS};
/// let model = Model { earth_rate_rad_s: 0.0, ..Model::new(9.8, 0.7)? };
/// let mut truth = [0.0; COUNT];
/// truth[GYRO_BIAS] = 1e-6;
/// let geometry = Geometry::new(&model, &truth);
/// let (level, command) = (Matrix3::identity(), Vector3::zeros());
/// let rate = geometry.rate(&geometry.commanded_rate(&command), &model.force(&level));
/// assert_eq!(rate, Vector3::new(1e-6, 0.0, 0.0));
/// let step = geometry.step(&model, &level, &command, 0.25);
/// assert_eq!(geometry.rate_sensitivity(&model, &step, &command)[GYRO_BIAS], [1.0, 0.0, 0.0]);
/// assert!((geometry.turning(&model, &step, &command, 0.25)[GYRO_BIAS][0] - 0.25).abs() < 1e-12);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
/// The outputs: a tilt about x, away from the vertical y, shows on accelerometer z.
/// ```
/// use nalgebra::{Matrix3, Vector3};
/// use stillrate::gimbal::{COUNT, Geometry, Model, coefficients::ATTITUDE};
/// let model = Model { earth_rate_rad_s: 0.0, ..Model::new(9.8, 0.7)? };
/// let (geometry, level) = (Geometry::new(&model, &[0.0; COUNT]), Matrix3::identity());
/// assert_eq!(geometry.output(&model, &level), [0.0, 9.8, 0.0]);
/// let turning = Vector3::new(0.01, 0.0, 0.0);
/// let force_rate = geometry.force_rate(&model, &level, &turning);
/// let (value, row) = geometry.output_row(2, &model.force(&level), &force_rate);
/// assert_eq!((value, row[ATTITUDE], force_rate[2]), (0.0, -9.8, 0.01 * -9.8));
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
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

impl Geometry {
    /// Works out the axes of all instruments.
    #[must_use]
    pub fn new(model: &Model, coefficients: &Coefficients) -> Self {
        let x = coefficients;
        let Triads { gyro, accelerometer } = &model.triads;
        let gyros: [GyroAxes; 3] =
            core::array::from_fn(|i| GyroAxes::new(&gyro[i], x[GYRO_ABOUT_OUTPUT + i], x[GYRO_ABOUT_SPIN + i]));
        let forces = core::array::from_fn(|i| {
            ForceAxis::new(&accelerometer[i], x[FORCE_ABOUT_PENDULOUS + i], x[FORCE_ABOUT_OUTPUT + i])
        });
        let drift_to_rate = inverse_of_rows(gyros.each_ref().map(|axes| &axes.input));
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
