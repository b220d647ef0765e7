//! The exact motion of the platform: its rate, one step, and what every coefficient does to the attitude on the way.
//!
//! The stabilisation loops null what the gyros report, so the platform turns at w_p = A_g^-1 ((1 + tq) w + eps) with the command w and the
//! gyro error eps_i = kg0_i + (kgI_i I'.f + kgO_i O'.f + kgS_i S'.f) / g, f = R f^n; dR/dt = -[w_p x] R + R [w_ie x]. One step of T: rate at
//! the start, specific force at mid-step with it, rate there, R <- exp(-[w_p T x]) R exp([w_ie T x]); it agrees with a Runge-Kutta integration
//! to 1.3e-9 m/s^2 over 900 s at T = 0.25 s. Source: our reconstruction of DOI 10.3873/j.issn.1000-1328.2017.06.009.

use nalgebra::{Matrix3, Vector3};

use super::coefficients::{
    COUNT, G_INPUT, G_OUTPUT, G_SPIN, GYRO_ABOUT_OUTPUT, GYRO_ABOUT_SPIN, GYRO_BIAS, LATITUDE, TORQUER,
};
use super::geometry::Geometry;
use super::model::Model;
use super::rotation::{apply, cross, exponential, product, turned};

/// One step of the motion, as of [`Geometry::step`].
///
/// # Example
/// ```
/// use nalgebra::{Matrix3, Vector3};
/// use stillrate::gimbal::{Geometry, Model};
/// let model = Model { earth_rate_rad_s: 0.0, ..Model::new(9.8, 0.7)? };
/// let step = Geometry::new(&model, &[0.0; 41]).step(&model, &Matrix3::identity(), &Vector3::new(0.0, 0.0, 0.2), 0.5);
/// // A head without errors turns as it is told; half of the 0.1 rad has happened at mid-step.
/// assert_eq!(step.rate, Vector3::new(0.0, 0.0, 0.2));
/// assert!((step.force[0] - 9.8 * 0.05_f64.sin()).abs() < 1e-15);
/// assert_eq!(step.rotation, step.transition);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// R at the end.
    pub rotation: Matrix3<f64>,
    /// Platform rate at mid-step, rad/s.
    pub rate: Vector3<f64>,
    /// Specific force at mid-step in platform axes, m/s^2.
    pub force: Vector3<f64>,
    /// Phi = exp(-[w_p T x]): how an attitude error is carried along.
    pub transition: Matrix3<f64>,
}

/// d(attitude error at the end of a step) / d(coefficients): one column a coefficient, zero where it does not turn the platform.
pub type Turning = [[f64; 3]; COUNT];

/// Start of a step: platform rate under the command alone, specific force, and platform rate against the Earth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Departure {
    commanded: Vector3<f64>,
    force: Vector3<f64>,
    against_earth: Vector3<f64>,
}

impl Departure {
    /// Rate and specific force at mid-step, and the constant rate that turns as far as the changing one.
    #[inline(always)]
    fn mean_rate(&self, geometry: &Geometry, model: &Model, dt_s: f64) -> (Vector3<f64>, Vector3<f64>, Vector3<f64>) {
        let force = turned(&(self.against_earth * (-0.5 * dt_s)), &self.force);
        let rate = geometry.rate(&self.commanded, &force);
        if !model.refined {
            return (rate, force, rate);
        }
        let slope = cross(&force, &rate);
        let bend = cross(&slope, &rate);
        let (slope, bend) = (apply(&geometry.force_to_rate, &slope), apply(&geometry.force_to_rate, &bend));
        (rate, force, rate + (bend * 0.5 + cross(&rate, &slope)) * (dt_s * dt_s / 12.0))
    }
}

impl Geometry {
    /// (1 + tq) w + kg0 turned into a platform rate: the part that does not depend on the specific force.
    #[must_use]
    #[inline(always)]
    pub fn commanded_rate(&self, command: &Vector3<f64>) -> Vector3<f64> {
        let x = &self.coefficients;
        apply(
            &self.drift_to_rate,
            &Vector3::new(
                (1.0 + x[TORQUER]) * command[0] + x[GYRO_BIAS],
                (1.0 + x[TORQUER + 1]) * command[1] + x[GYRO_BIAS + 1],
                (1.0 + x[TORQUER + 2]) * command[2] + x[GYRO_BIAS + 2],
            ),
        )
    }

    /// w_p under a specific force, rad/s, from [`Geometry::commanded_rate`].
    #[must_use]
    #[inline(always)]
    pub fn rate(&self, commanded: &Vector3<f64>, force: &Vector3<f64>) -> Vector3<f64> {
        commanded + apply(&self.force_to_rate, force)
    }

    /// One step of `dt_s` (which may be negative) under a constant command.
    ///
    /// The rate changes with the specific force during the step. A refined model adds the next terms of Magnus' series,
    /// w + T^2/24 w'' + T^2/12 w x w' with w' = K f', f' = f x w: without them drifts of 1 deg/h per g leave 1e-7 m/s^2 after 900 s.
    #[must_use]
    #[inline(always)]
    pub fn step(&self, model: &Model, rotation: &Matrix3<f64>, command: &Vector3<f64>, dt_s: f64) -> Step {
        let (rate, force, mean) = self.departure(model, rotation, command).mean_rate(self, model, dt_s);
        let transition = exponential(&(mean * -dt_s));
        let turned = product(&product(&transition, rotation), &exponential(&(self.earth_rate * dt_s)));
        Step { rotation: turned, rate, force, transition }
    }

    /// What steps of any length from one attitude under one command share.
    #[inline(always)]
    pub(super) fn departure(&self, model: &Model, rotation: &Matrix3<f64>, command: &Vector3<f64>) -> Departure {
        let commanded = self.commanded_rate(command);
        let force = model.force(rotation);
        let first = self.rate(&commanded, &force);
        Departure { commanded, force, against_earth: first - apply(rotation, &self.earth_rate) }
    }

    /// f after a step, as of [`Geometry::step`] but without its matrices.
    #[inline(always)]
    pub(super) fn force_after(
        &self,
        model: &Model,
        rotation: &Matrix3<f64>,
        departure: &Departure,
        dt_s: f64,
    ) -> Vector3<f64> {
        let (_, _, mean) = departure.mean_rate(self, model, dt_s);
        turned(&(mean * -dt_s), &apply(rotation, &turned(&(self.earth_rate * dt_s), &model.force_n())))
    }

    /// dw_p/d(coefficients) at a step, rad/s per unit, without the factor T exp(-[w_p T/2 x]); the latitude enters elsewhere.
    #[must_use]
    pub fn rate_sensitivity(&self, model: &Model, step: &Step, command: &Vector3<f64>) -> Turning {
        self.spread(model, step, command, &self.drift_to_rate)
    }

    /// d(attitude error after the step)/d(coefficients): T exp(-[w_p T/2 x]) dw_p/d(coefficients), and the Earth rate's part.
    #[must_use]
    #[inline(always)]
    pub fn turning(&self, model: &Model, step: &Step, command: &Vector3<f64>, dt_s: f64) -> Turning {
        let weight = product(&exponential(&(step.rate * (-0.5 * dt_s))), &self.drift_to_rate) * dt_s;
        let mut turning = self.spread(model, step, command, &weight);
        // R' = R exp([dw_ie T x]) is R turned by -R dw_ie T.
        turning[LATITUDE] = (apply(&step.rotation, &self.earth_rate_by_latitude) * -dt_s).into();
        turning
    }

    /// Columns of gyro i times what each of its coefficients adds to its rate.
    #[inline(always)]
    fn spread(&self, model: &Model, step: &Step, command: &Vector3<f64>, weight: &Matrix3<f64>) -> Turning {
        let mut turning = [[0.0; 3]; COUNT];
        let force = step.force / model.gravity_m_s2;
        for i in 0..3 {
            let axes = &self.gyros[i];
            let column = weight.data.0[i];
            let times = |factor: f64| [column[0] * factor, column[1] * factor, column[2] * factor];
            turning[GYRO_BIAS + i] = column;
            turning[G_INPUT + i] = times(axes.input.dot(&force));
            turning[G_OUTPUT + i] = times(axes.output.dot(&force));
            turning[G_SPIN + i] = times(axes.spin.dot(&force));
            turning[GYRO_ABOUT_OUTPUT + i] = times(-axes.input_by_output_angle.dot(&step.rate));
            turning[GYRO_ABOUT_SPIN + i] = times(-axes.input_by_spin_angle.dot(&step.rate));
            turning[TORQUER + i] = times(command[i]);
        }
        turning
    }

    /// df/dt of the specific force in platform axes at a rate, m/s^3.
    #[must_use]
    #[inline(always)]
    pub fn force_rate(&self, model: &Model, rotation: &Matrix3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
        let force = model.force(rotation);
        cross(&force, rate) + apply(rotation, &cross(&self.earth_rate, &model.force_n()))
    }
}
