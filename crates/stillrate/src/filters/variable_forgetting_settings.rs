//! Settings of the recursive least squares that forget when they see motion.
//!
//! The defaults were found by random search on simulated motion with white noise of known sigma; a sigma of half the true one
//! doubles the noise that passes at rest, twice the true one adds 60 % error in motion.

use super::variable_forgetting::VariableForgetting;
use crate::error::ConfigError;
use crate::filters::hmm_rls::check_order;
use crate::filters::recursive::memory::tau_of;
use crate::noise::{GyroNoise, range};
use crate::ranges;
use crate::real::Real;
use crate::settings::{Settings, Visit, visit_noise};

/// Settings of [`VariableForgetting`]. The defaults depend on the order; all but the first two are pure numbers.
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::VariableForgettingSettings};
/// let noise = GyroNoise::from_standard_deviation_at_rate(0.05, 200.0);
/// let level = VariableForgettingSettings::defaults(200.0, noise);
/// let line = VariableForgettingSettings::defaults_of_order_2(200.0, noise);
/// assert!(line.forgetting_factor_max > level.forgetting_factor_max); // a slope costs noise: a longer memory pays for it
/// assert!(level.build::<f32>().is_ok() && line.build::<f32>().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct VariableForgettingSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Noise of the gyro: the yardstick for innovations.
    pub noise: GyroNoise,
    /// 1: level; 2: level and slope. Default 1.
    pub order: f64,
    /// Forgetting factor at rest; default 0.9507 (order 2: 0.98), a noise ratio of 0.16.
    pub forgetting_factor_max: f64,
    /// Forgetting factor in full motion; default 0.1 (order 2: 0.5).
    pub forgetting_factor_min: f64,
    /// beta, how fast the innovation is smoothed, in (0, 1]; default 0.45 (order 2: 0.36).
    pub smoothing: f64,
    /// Standard deviations of the smoothed innovation where forgetting begins; default 3.2 (order 2: 2.8).
    pub threshold: f64,
    /// Standard deviations from there to full motion; default 1.4 (order 2: 2.4).
    pub width: f64,
}

impl VariableForgettingSettings {
    /// Sensible settings of order 2.
    #[must_use]
    pub fn defaults_of_order_2(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        Self {
            order: 2.0,
            forgetting_factor_max: 0.98,
            forgetting_factor_min: 0.5,
            smoothing: 0.36,
            threshold: 2.8,
            width: 2.4,
            ..Self::defaults(sample_rate_hz, noise)
        }
    }
}

impl Settings for VariableForgettingSettings {
    const METHOD: &'static str = "variable-forgetting";
    type Filter<T: Real> = VariableForgetting<T>;

    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        Self {
            sample_rate_hz,
            noise,
            order: 1.0,
            forgetting_factor_max: 0.9507,
            forgetting_factor_min: 0.1,
            smoothing: 0.45,
            threshold: 3.2,
            width: 1.4,
        }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visit_noise(visitor, &mut self.noise);
        let before = self.order;
        visitor.number("order", &mut self.order);
        if self.order == 2.0 && before == 1.0 {
            *self = Self::defaults_of_order_2(self.sample_rate_hz, self.noise);
        }
        visitor.number("forgetting_factor_max", &mut self.forgetting_factor_max);
        visitor.number("forgetting_factor_min", &mut self.forgetting_factor_min);
        visitor.number("smoothing", &mut self.smoothing);
        visitor.number("threshold", &mut self.threshold);
        visitor.number("width", &mut self.width);
    }

    fn build<T: Real>(&self) -> Result<VariableForgetting<T>, ConfigError> {
        ranges::check(self)?;
        let (rate, noise) = (self.sample_rate_hz, self.noise);
        let second = check_order(self.order)?;
        let (least, most) = (self.forgetting_factor_min, self.forgetting_factor_max);
        if least > most {
            return Err(ConfigError::new("forgetting_factor_min", least, "", "at most forgetting_factor_max"));
        }
        let (smoothing, threshold, width) = (self.smoothing, self.threshold, self.width);
        // The smoothed innovation of white noise is smaller by sqrt(beta/(2 - beta)).
        let spread = ((2.0 - smoothing) / smoothing).root();
        let variance = noise.sample_variance(rate);
        Ok(VariableForgetting {
            period_s: T::of(1.0 / rate),
            order: if second { T::TWO } else { T::ONE },
            forgetting_factor_max: T::of(most),
            range: T::of(least - most),
            smoothing: T::of(smoothing),
            spread: T::of(spread),
            threshold: T::of(threshold),
            width: T::of(width),
            sigma: T::of(variance.root()),
            sample_variance: T::of(variance),
            quiet_tau_s: T::of(tau_of(most, rate)).least(T::LARGEST),
            limit: range(variance.root()),
        })
    }
}
