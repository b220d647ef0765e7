//! What the accelerometers read, and the derivatives of it.
//!
//! z_i = ka0_i + (1 + ka1_i) u + ka2_i u^2 with u = a_i.f; an attitude error psi moves f by f x psi, so dz/dpsi = (1 + ka1 + 2 ka2 u) a x f.

use nalgebra::{Matrix3, Vector3};

use super::coefficients::{
    ATTITUDE, COUNT, FORCE_ABOUT_OUTPUT, FORCE_ABOUT_PENDULOUS, FORCE_BIAS, FORCE_QUADRATIC, FORCE_SCALE, LATENCY,
};
use super::geometry::Geometry;
use super::model::Model;
use super::rotation::cross;

/// d(output) / d(attitude error, coefficients) of one accelerometer.
pub type Row = [f64; COUNT];

impl Geometry {
    /// The three accelerometer outputs in an attitude, m/s^2.
    #[must_use]
    #[inline]
    pub fn output(&self, model: &Model, rotation: &Matrix3<f64>) -> [f64; 3] {
        self.output_under(&model.force(rotation))
    }

    /// The same under a specific force in platform axes.
    #[inline(always)]
    pub(super) fn output_under(&self, force: &Vector3<f64>) -> [f64; 3] {
        let x = &self.coefficients;
        core::array::from_fn(|i| {
            let u = self.forces[i].input.dot(force);
            x[FORCE_BIAS + i] + (1.0 + x[FORCE_SCALE + i] + x[FORCE_QUADRATIC + i] * u) * u
        })
    }

    /// Output of accelerometer `i` under a specific force, and its derivatives; `force_rate` is df/dt (for the latency).
    #[must_use]
    #[inline(always)]
    pub fn output_row(&self, i: usize, force: &Vector3<f64>, force_rate: &Vector3<f64>) -> (f64, Row) {
        let x = &self.coefficients;
        let axis = &self.forces[i];
        let u = axis.input.dot(force);
        let slope = 1.0 + x[FORCE_SCALE + i] + 2.0 * x[FORCE_QUADRATIC + i] * u;
        let tilt = cross(&axis.input, force) * slope;
        let mut row = [0.0; COUNT];
        row[ATTITUDE] = tilt[0];
        row[ATTITUDE + 1] = tilt[1];
        row[ATTITUDE + 2] = tilt[2];
        row[FORCE_BIAS + i] = 1.0;
        row[FORCE_SCALE + i] = u;
        row[FORCE_ABOUT_PENDULOUS + i] = slope * axis.by_pendulous_angle.dot(force);
        row[FORCE_ABOUT_OUTPUT + i] = slope * axis.by_output_angle.dot(force);
        row[FORCE_QUADRATIC + i] = u * u;
        row[LATENCY] = -slope * axis.input.dot(force_rate);
        (x[FORCE_BIAS + i] + (1.0 + x[FORCE_SCALE + i] + x[FORCE_QUADRATIC + i] * u) * u, row)
    }
}
