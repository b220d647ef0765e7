//! What a gyro does at rest, in two numbers: white noise density and rate random walk.
//!
//! Datasheets give these in many units, and mix one-sided with two-sided densities (they differ by the square root of
//! two), so every constructor names its unit. Inside, the density is two-sided: N in deg/s/sqrt(Hz), the same number
//! as the angle random walk in deg/sqrt(s), so that white samples at rate f have the standard deviation N sqrt(f).

use crate::error::ConfigError;
use crate::ranges::{NOISE_DENSITY, RATE_RANDOM_WALK};
use crate::real::Real;

/// White noise density N and rate random walk K of a gyro.
///
/// # Example
/// ```
/// use stillrate::GyroNoise;
/// let noise = GyroNoise::from_angle_random_walk_deg_sqrt_h(0.9).with_rate_random_walk(0.001);
/// assert!((noise.density_dps_sqrt_hz - 0.015).abs() < 1e-15);
/// ```
///
/// The same gyro in the units of other datasheets:
/// ```
/// use stillrate::GyroNoise;
/// let two_sided = GyroNoise::from_density_two_sided(0.015);
/// let one_sided = GyroNoise::from_density_one_sided(0.015 * 2.0_f64.sqrt());
/// let scatter = GyroNoise::from_standard_deviation_at_rate(0.15, 100.0);
/// for noise in [two_sided, one_sided, scatter] {
///     assert!((noise.sample_variance(100.0) - 0.15 * 0.15).abs() < 1e-15);
/// }
/// let coarse = GyroNoise::from_resolution(0.6, 100.0);
/// assert!((coarse.sample_variance(100.0) - 0.6 * 0.6 / 12.0).abs() < 1e-15);
/// let drifting = two_sided.with_rate_random_walk(0.0).with_bias(0.01, 20.0);
/// assert!((drifting.rate_random_walk_dps_sqrt_s - 1e-5_f64.sqrt()).abs() < 1e-15);
/// assert!(drifting.checked().is_ok() && two_sided.with_bias(0.01, -20.0).checked().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroNoise {
    /// Two-sided density N of the white part, deg/s/sqrt(Hz) (= angle random walk, deg/sqrt(s)).
    pub density_dps_sqrt_hz: f64,
    /// Rate random walk K, deg/s/sqrt(s).
    pub rate_random_walk_dps_sqrt_s: f64,
}

/// K as a fraction of N (per second) where nothing is known about the drift: slow enough never to blur a motion.
pub const SMALLEST_WALK_RATIO: f64 = 1e-3;

impl GyroNoise {
    /// From the two-sided density in deg/s/sqrt(Hz).
    #[must_use]
    pub fn from_density_two_sided(density_dps_sqrt_hz: f64) -> Self {
        Self { density_dps_sqrt_hz, rate_random_walk_dps_sqrt_s: SMALLEST_WALK_RATIO * density_dps_sqrt_hz }
    }

    /// From the one-sided density in deg/s/sqrt(Hz), as most MEMS datasheets state it.
    #[must_use]
    pub fn from_density_one_sided(density_dps_sqrt_hz: f64) -> Self {
        Self::from_density_two_sided(density_dps_sqrt_hz * core::f64::consts::FRAC_1_SQRT_2)
    }

    /// From the angle random walk in deg/sqrt(h).
    #[must_use]
    pub fn from_angle_random_walk_deg_sqrt_h(angle_random_walk: f64) -> Self {
        Self::from_density_two_sided(angle_random_walk / 60.0)
    }

    /// From the standard deviation in deg/s of white samples at a rate in Hz.
    #[must_use]
    pub fn from_standard_deviation_at_rate(standard_deviation_dps: f64, sample_rate_hz: f64) -> Self {
        Self::from_density_two_sided(standard_deviation_dps / sample_rate_hz.root())
    }

    /// From the resolution in deg/s of a noiseless but quantised sensor at a rate in Hz: uniform rounding error of one LSB.
    #[must_use]
    pub fn from_resolution(lsb_dps: f64, sample_rate_hz: f64) -> Self {
        Self::from_density_two_sided(lsb_dps / (12.0 * sample_rate_hz).root())
    }

    /// Sets the rate random walk K in deg/s/sqrt(s).
    #[must_use]
    pub fn with_rate_random_walk(mut self, rate_random_walk_dps_sqrt_s: f64) -> Self {
        self.rate_random_walk_dps_sqrt_s = rate_random_walk_dps_sqrt_s;
        self
    }

    /// Adds a bias instability described as a Gauss-Markov process of sigma in deg/s and tau in s: K^2 grows by 2 sigma^2 / tau.
    #[must_use]
    pub fn with_bias(mut self, bias_sigma_dps: f64, bias_time_s: f64) -> Self {
        let walk = self.rate_random_walk_dps_sqrt_s;
        self.rate_random_walk_dps_sqrt_s = (walk * walk + 2.0 * bias_sigma_dps * bias_sigma_dps / bias_time_s).root();
        self
    }

    /// Checks both figures.
    ///
    /// # Errors
    /// [`ConfigError`] if the density is not in [`NOISE_DENSITY`] or the walk not in [`RATE_RANDOM_WALK`].
    pub fn checked(self) -> Result<Self, ConfigError> {
        NOISE_DENSITY.check("noise.density_dps_sqrt_hz", self.density_dps_sqrt_hz)?;
        RATE_RANDOM_WALK.check("noise.rate_random_walk_dps_sqrt_s", self.rate_random_walk_dps_sqrt_s)?;
        Ok(self)
    }

    /// Variance of a white sample at a rate in Hz, (deg/s)^2.
    #[must_use]
    pub fn sample_variance(self, sample_rate_hz: f64) -> f64 {
        self.density_dps_sqrt_hz * self.density_dps_sqrt_hz * sample_rate_hz
    }
}

/// Readings beyond this many standard deviations of the noise are no rates at all: a 2000 deg/s sensor of
/// 0.001 deg/s noise stays a hundred times below.
pub const RANGE_SIGMAS: f64 = 2e8;

/// The same for filters that are not told the noise: above twice the largest count of a 32-bit converter, in whatever unit.
pub const RANGE: f64 = 1e10;

/// And whatever the noise: a hundred times the largest count of a 32-bit converter, and its fourth power over a variance is a number.
pub const RANGE_DPS: f64 = 1e12;

/// Largest magnitude that counts as a reading where samples have this standard deviation.
pub(crate) fn range<T: Real>(standard_deviation: f64) -> T {
    T::of((RANGE_SIGMAS * standard_deviation).least(RANGE_DPS))
}
