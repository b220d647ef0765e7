//! Where the platform stands, how its instruments are arranged, and the motion that the command alone would make.
//!
//! Frames: n is north-up-east, p the platform, R = C_np; f^n = (0, g, 0). The computed frame is the one of a head without errors.

use nalgebra::{Matrix3, Vector3};

use super::coefficients::Triads;
use super::rotation::{apply, exponential, product, turned};
use crate::attitude::earth::EARTH_RATE_RAD_S;
use crate::error::{ConfigError, positive};
use crate::real::Real;

/// Where the platform stands and how its instruments are arranged.
///
/// # Example
/// ```
/// use nalgebra::{Matrix3, Vector3};
/// use stillrate::gimbal::Model;
/// let model = Model::new(9.8, 0.698)?;
/// let earth_rate = model.earth_rate();
/// assert!(earth_rate[0] > earth_rate[1] && earth_rate[2] == 0.0); // more north than up at 40 degrees, none east
/// // A quarter turn about east in one second brings the axis that lay north to the vertical: it feels all of gravity.
/// let (level, quarter) = (Matrix3::identity(), Vector3::new(0.0, 0.0, core::f64::consts::FRAC_PI_2));
/// let turned = model.commanded_step(&level, &quarter, &Vector3::zeros(), 1.0);
/// assert!((model.force(&turned) - Vector3::new(9.8, 0.0, 0.0)).amax() < 1e-14);
/// assert!((model.commanded_force(&level, &quarter, &earth_rate, 1.0) - model.force(&turned)).amax() < 9.8 * 1e-4);
/// # Ok::<(), stillrate::ConfigError>(())
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
    /// Take the change of the rate within a step into account to fourth order (see [`Geometry::step`](super::Geometry::step)).
    pub refined: bool,
}

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
    #[inline(always)]
    pub(super) fn force_n(&self) -> Vector3<f64> {
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
