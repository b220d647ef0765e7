//! Samples around an epoch minus what was predicted for them: by the commanded motion alone, or by the current model.
//!
//! Subtracting the commanded specific force g_c = C_nc f^n leaves the coefficients' own curvature and kinks where the command
//! jumps; subtracting the model output leaves white noise. In-window attitudes are exact steps of length j dT from the epoch, under
//! the command of the interval they fall in.

use nalgebra::{Matrix3, Vector3};

use super::coefficients::LATENCY;
use super::geometry::Geometry;
use super::model::Model;
use super::record::{Measurement, Record};

/// A command jump beyond this leaves a kink that the commanded motion cannot remove, rad/s.
pub const KINK_RAD_S: f64 = 1e-4;

/// What is subtracted from the samples around an epoch before the line is fitted.
///
/// # Example
/// ```
/// use stillrate::gimbal::Reference;
/// assert_eq!(Reference::default(), Reference::Model); // no epoch is lost to it
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reference {
    /// The specific force of the commanded motion; epochs where the command jumps are skipped.
    Commanded,
    /// The output of the model with the current coefficients; nothing is skipped.
    #[default]
    Model,
}

/// Command in force at an offset from epoch `k`.
#[inline(always)]
fn command_at(record: &Record<'_>, k: usize, offset_s: f64) -> Vector3<f64> {
    Vector3::from(if offset_s < 0.0 && k > 0 { record.command(k - 1) } else { record.command(k) })
}

/// Output measured at epoch `k` (m/s^2), with the commanded motion subtracted inside the window and added back at its centre.
///
/// `commanded` is the computed frame at the epoch, `earth_rate` in rad/s, `robust` whether spikes are looked for.
///
/// # Example
/// ```
/// use nalgebra::Matrix3;
/// use stillrate::gimbal::{Measurement, Model, Record, window::commanded};
/// let model = Model { earth_rate_rad_s: 0.0, ..Model::new(9.8, 0.7)? };
/// let (command, mut samples) = ([[0.0; 3]; 2], [[0.0, 9.8, 0.0]; 11]);
/// samples[6][0] = 1e3; // a spike beside epoch 1
/// let record = Record::new(&command, &samples, 0.25, 1e-6)?;
/// let measured = |k, robust| commanded(&model, &record, k, &Matrix3::identity(), &model.earth_rate(), robust);
/// assert_eq!(measured(1, true).value, [0.0, 9.8, 0.0]);
/// assert!(measured(1, false).value[0] > 100.0);
/// assert!((measured(1, true).variance[1] - 0.2e-12).abs() < 1e-27); // five samples
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[must_use]
pub fn commanded(
    model: &Model,
    record: &Record<'_>,
    k: usize,
    commanded: &Matrix3<f64>,
    earth_rate: &Vector3<f64>,
    robust: bool,
) -> Measurement {
    let centre = model.force(commanded);
    if record.half_window() == 0 {
        return record.intercept(k, robust, |_| [0.0; 3]);
    }
    if record.jumps(k, KINK_RAD_S) {
        return Measurement::NONE;
    }
    let mut measurement = record.intercept(k, robust, |j| {
        let dt_s = record.offset_s(j);
        let force = if j == 0 {
            centre
        } else {
            model.commanded_force(commanded, &command_at(record, k, dt_s), earth_rate, dt_s)
        };
        force.into()
    });
    for axis in 0..3 {
        measurement.value[axis] += centre[axis];
    }
    measurement
}

/// Residual at epoch `k` against the model: samples minus model outputs (m/s^2), as one intercept an axis.
///
/// `rotation` is the model's attitude at the epoch, `robust` whether spikes are looked for.
///
/// # Example
/// ```
/// use nalgebra::Matrix3;
/// use stillrate::gimbal::{COUNT, Geometry, Model, Record, window::against_model};
/// let model = Model { earth_rate_rad_s: 0.0, ..Model::new(9.8, 0.7)? };
/// let (command, samples) = ([[0.0; 3]; 2], [[1e-3, 9.8, 0.0]; 11]);
/// let record = Record::new(&command, &samples, 0.25, 1e-6)?;
/// let ideal = Geometry::new(&model, &[0.0; COUNT]);
/// let residual = against_model(&ideal, &model, &record, 1, &Matrix3::identity(), true);
/// assert_eq!(residual.value, [1e-3, 0.0, 0.0]); // the bias of accelerometer x
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[must_use]
#[inline(always)]
pub fn against_model(
    geometry: &Geometry,
    model: &Model,
    record: &Record<'_>,
    k: usize,
    rotation: &Matrix3<f64>,
    robust: bool,
) -> Measurement {
    let latency = geometry.coefficients[LATENCY];
    let before = geometry.departure(model, rotation, &command_at(record, k, -1.0));
    let after = geometry.departure(model, rotation, &command_at(record, k, 1.0));
    record.intercept(k, robust, |j| {
        let dt_s = record.offset_s(j) - latency;
        let from = if dt_s < 0.0 { &before } else { &after };
        geometry.output_under(&geometry.force_after(model, rotation, from, dt_s))
    })
}

/// Attitude that the samples claimed for epoch `k` really belong to: the epoch's own, or a latency earlier.
#[must_use]
#[inline]
pub(super) fn sampled_attitude(
    geometry: &Geometry,
    model: &Model,
    rotation: &Matrix3<f64>,
    command: &Vector3<f64>,
) -> Matrix3<f64> {
    let latency = geometry.coefficients[LATENCY];
    if latency == 0.0 { *rotation } else { geometry.step(model, rotation, command, -latency).rotation }
}
