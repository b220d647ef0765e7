//! Settings of the autoregressive Kalman filter, and which models it takes.

use super::ar_kf::{ArKf, HIGHEST_ORDER};
use crate::error::ConfigError;
use crate::noise::{GyroNoise, range};
use crate::ranges;
use crate::real::Real;
use crate::settings::{Settings, Visit};

/// phi of the published comparison.
const PUBLISHED_COEFFICIENT: f64 = 0.0004;
/// R / Q that reproduces it.
const PUBLISHED_RATIO: f64 = 0.768;

/// Settings of [`ArKf`]. Refused are an order that is not 1 to 8, a model that is not stationary, and a signal so large beside the
/// measurement noise that the precision cannot hold both.
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::ArKfSettings};
/// let mut settings = ArKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015));
/// settings.order = 2;
/// (settings.coefficients[0], settings.coefficients[1]) = (1.6, -0.9); // rings at 4.5 Hz
/// assert!(settings.build::<f64>().is_ok());
/// settings.coefficients[1] = -1.1; // grows as it rings
/// assert_eq!(settings.build::<f64>().unwrap_err().field, "coefficients");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ArKfSettings {
    /// Nominal sample rate, Hz: the rate the coefficients belong to.
    pub sample_rate_hz: f64,
    /// phi_1, phi_2, ...; those in use come first.
    pub coefficients: [f64; HIGHEST_ORDER],
    /// How many coefficients are in use.
    pub order: usize,
    /// Variance Q of the driving noise, (deg/s)^2.
    pub process_variance_dps2: f64,
    /// Variance R of the measurement noise, (deg/s)^2.
    pub measurement_variance_dps2: f64,
}

impl Settings for ArKfSettings {
    const METHOD: &'static str = "ar-kf";
    type Filter<T: Real> = ArKf<T>;

    /// The published AR(1), see the module; Q + R is the variance of the raw samples at rest.
    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        let process = noise.sample_variance(sample_rate_hz) / (1.0 + PUBLISHED_RATIO);
        let mut coefficients = [0.0; HIGHEST_ORDER];
        coefficients[0] = PUBLISHED_COEFFICIENT;
        Self {
            sample_rate_hz,
            coefficients,
            order: 1,
            process_variance_dps2: process,
            measurement_variance_dps2: PUBLISHED_RATIO * process,
        }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visitor.list("coefficients", &mut self.coefficients, &mut self.order);
        visitor.number("process_variance_dps2", &mut self.process_variance_dps2);
        visitor.number("measurement_variance_dps2", &mut self.measurement_variance_dps2);
    }

    fn build<T: Real>(&self) -> Result<ArKf<T>, ConfigError> {
        ranges::check(self)?;
        let period = 1.0 / self.sample_rate_hz;
        let used = match self.coefficients.get(..self.order) {
            Some(used) if !used.is_empty() => used,
            _ => return Err(ConfigError::new("coefficients", self.order as f64, "values", "a list of 1 to 8")),
        };
        let first = self.coefficients[0];
        let Some(gain) = power_gain(used) else {
            let range = "the first coefficient of a stationary model (all roots inside the unit circle)";
            return Err(ConfigError::new("coefficients", first, "", range));
        };
        if gain > LARGEST_POWER_GAIN {
            let range = "the first coefficient of a model whose signal has at most 1e6 times the driving variance";
            return Err(ConfigError::new("coefficients", first, "", range));
        }
        let (process, measurement) = (self.process_variance_dps2, self.measurement_variance_dps2);
        if process < 1e-12 * measurement {
            let range = "at least 1e-12 times measurement_variance_dps2, in";
            return Err(ConfigError::new("process_variance_dps2", process, "(deg/s)^2", range));
        }
        // An update leaves the measurement variance of a signal variance: beyond, nothing but rounding errors.
        if gain * process / measurement > 1.0 / T::EPSILON.widen() {
            let range = "so small that the signal has at most 8e6 times measurement_variance_dps2 (f64: 4e15), in";
            return Err(ConfigError::new("process_variance_dps2", process, "(deg/s)^2", range));
        }
        let unit = measurement.root();
        let mut coefficients = [T::ZERO; HIGHEST_ORDER];
        for (mine, &given) in coefficients.iter_mut().zip(used) {
            *mine = T::of(given);
        }
        Ok(ArKf {
            period_s: T::of(period),
            coefficients,
            drive: T::of(process / measurement),
            unit: T::of(unit),
            limit: range(unit),
        })
    }
}

/// Variance of the signal over that of its driving noise, by Levinson's recursion run backwards: the product of 1 / (1 - k^2) over the
/// reflections k. `None` where one of them is not inside the unit circle: then a root is not either, and the model not stationary.
fn power_gain(coefficients: &[f64]) -> Option<f64> {
    let mut gain = 1.0;
    let mut left = [0.0; HIGHEST_ORDER];
    for (copy, &coefficient) in left.iter_mut().zip(coefficients) {
        *copy = coefficient;
    }
    for order in (1..=coefficients.len().min(HIGHEST_ORDER)).rev() {
        let reflection = left[order - 1];
        let inside = reflection.magnitude() < 1.0;
        if !inside {
            return None;
        }
        gain /= 1.0 - reflection * reflection;
        let before = left;
        for i in 0..order - 1 {
            left[i] = (before[i] + reflection * before[order - 2 - i]) / (1.0 - reflection * reflection);
        }
    }
    Some(gain)
}

/// Variance of the signal over that of the driving noise at most: memories of a million samples, far from where rounding makes a model
/// unstable.
const LARGEST_POWER_GAIN: f64 = 1e6;
