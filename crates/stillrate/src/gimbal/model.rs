//! The exact model of the gimballed sensor head: one step of its motion, its outputs, and the derivatives of both.
//!
//! Frames: n is north-up-east, p the platform, R = C_np. The stabilisation loops null what the gyros report, so the platform
//! turns at w_p = A_g^-1 ((1 + tq) w + eps) with the command w and the gyro error
//! eps_i = kg0_i + (kgI_i I'.f + kgO_i O'.f + kgS_i S'.f) / g, f = R f^n; dR/dt = -[w_p x] R + R [w_ie x]. Accelerometer i reads
//! z_i = ka0_i + (1 + ka1_i) u + ka2_i u^2 with u = a_i.f. One step of T: rate at the start, specific force at mid-step with it, rate
//! there, R <- exp(-[w_p T x]) R exp([w_ie T x]); it agrees with a Runge-Kutta integration to 1.3e-9 m/s^2 over 900 s at T = 0.25 s.
//! Source: our reconstruction of DOI 10.3873/j.issn.1000-1328.2017.06.009.

use nalgebra::{Matrix3, Vector3};

use super::coefficients::{
    ATTITUDE, COUNT, FORCE_ABOUT_OUTPUT, FORCE_ABOUT_PENDULOUS, FORCE_BIAS, FORCE_QUADRATIC, FORCE_SCALE, G_INPUT,
    G_OUTPUT, G_SPIN, GYRO_ABOUT_OUTPUT, GYRO_ABOUT_SPIN, GYRO_BIAS, LATENCY, LATITUDE, TORQUER, Triads,
};
use super::geometry::Geometry;
use super::rotation::{apply, cross, exponential, product, turned};
use crate::error::{ConfigError, positive};
use crate::real::Real;

/// Where the platform stands and how its instruments are arranged.
///
/// # Example
/// ```
/// use stillrate::gimbal::Model;
/// let model = Model::new(9.8, 0.698).unwrap();
/// assert!(model.earth_rate()[0] > model.earth_rate()[1]); // more north than up at 40 degrees
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Gravity, m/s^2.
    pub gravity_m_s2: f64,
    /// Latitude, rad.
    pub latitude_rad: f64,
    /// Rate of the Earth, rad/s.
    pub earth_rate_rad_s: f64,
    /// Arrangement of the instruments.
    pub triads: Triads,
    /// Take the change of the rate within a step into account to fourth order (see [`Geometry::step`]).
    pub refined: bool,
}

/// Rate of the Earth, rad/s.
pub const EARTH_RATE_RAD_S: f64 = 7.292_115e-5;

/// One step of the motion.
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
/// d(output) / d(attitude error, coefficients) of one accelerometer.
pub type Row = [f64; COUNT];

impl Model {
    /// The default arrangement at a place.
    ///
    /// # Errors
    /// [`ConfigError`] if gravity is not positive or the latitude not within +-pi/2.
    pub fn new(gravity_m_s2: f64, latitude_rad: f64) -> Result<Self, ConfigError> {
        positive("gravity_m_s2", gravity_m_s2, "m/s^2")?;
        if !(-core::f64::consts::FRAC_PI_2..=core::f64::consts::FRAC_PI_2).contains(&latitude_rad) {
            return Err(ConfigError::new("latitude_rad", latitude_rad, "rad", "within -pi/2 and pi/2"));
        }
        Ok(Self {
            gravity_m_s2,
            latitude_rad,
            earth_rate_rad_s: EARTH_RATE_RAD_S,
            triads: Triads::default(),
            refined: true,
        })
    }

    /// f^n: specific force at rest, north-up-east, m/s^2.
    #[must_use]
    #[inline(always)]
    pub fn force_n(&self) -> Vector3<f64> {
        Vector3::new(0.0, self.gravity_m_s2, 0.0)
    }

    /// Earth rate at the configured latitude, north-up-east, rad/s.
    #[must_use]
    pub fn earth_rate(&self) -> Vector3<f64> {
        let (sine, cosine) = self.latitude_rad.sine_cosine();
        Vector3::new(self.earth_rate_rad_s * cosine, self.earth_rate_rad_s * sine, 0.0)
    }

    /// f = R f^n, m/s^2.
    #[must_use]
    #[inline(always)]
    pub fn force(&self, rotation: &Matrix3<f64>) -> Vector3<f64> {
        rotation.column(1) * self.gravity_m_s2
    }

    /// The computed (error-free) frame after a step: C <- exp(-[w T x]) C exp([w_ie T x]).
    #[must_use]
    #[inline]
    pub fn commanded_step(
        &self,
        rotation: &Matrix3<f64>,
        command: &Vector3<f64>,
        earth_rate: &Vector3<f64>,
        dt_s: f64,
    ) -> Matrix3<f64> {
        product(&product(&exponential(&(command * -dt_s)), rotation), &exponential(&(earth_rate * dt_s)))
    }

    /// C f^n of the computed frame after a step, as of [`Model::commanded_step`] but without its matrices.
    #[must_use]
    #[inline(always)]
    pub fn commanded_force(
        &self,
        rotation: &Matrix3<f64>,
        command: &Vector3<f64>,
        earth_rate: &Vector3<f64>,
        dt_s: f64,
    ) -> Vector3<f64> {
        turned(&(command * -dt_s), &apply(rotation, &turned(&(earth_rate * dt_s), &self.force_n())))
    }
}

/// Start of a step: platform rate under the command alone, specific force, and platform rate against the Earth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Departure {
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
    pub(crate) fn departure(&self, model: &Model, rotation: &Matrix3<f64>, command: &Vector3<f64>) -> Departure {
        let commanded = self.commanded_rate(command);
        let force = model.force(rotation);
        let first = self.rate(&commanded, &force);
        Departure { commanded, force, against_earth: first - apply(rotation, &self.earth_rate) }
    }

    /// f after a step, as of [`Geometry::step`] but without its matrices.
    #[inline(always)]
    pub(crate) fn force_after(
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

    /// The three accelerometer outputs in an attitude, m/s^2.
    #[must_use]
    #[inline]
    pub fn output(&self, model: &Model, rotation: &Matrix3<f64>) -> [f64; 3] {
        self.output_under(&model.force(rotation))
    }

    /// The same under a specific force in platform axes.
    #[inline(always)]
    pub(crate) fn output_under(&self, force: &Vector3<f64>) -> [f64; 3] {
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

    /// df/dt of the specific force in platform axes at a rate, m/s^3.
    #[must_use]
    #[inline(always)]
    pub fn force_rate(&self, model: &Model, rotation: &Matrix3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
        let force = model.force(rotation);
        cross(&force, rate) + apply(rotation, &cross(&self.earth_rate, &model.force_n()))
    }
}
