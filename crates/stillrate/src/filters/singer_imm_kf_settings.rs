//! Settings of the two-model Singer bank.

use super::singer_imm_kf::SingerImmKf;
use super::singer_imm_model::SingerImmModel;
use super::singer_pair::{SingerPair, driving_density, probability_pair, transition_matrix};
use crate::error::ConfigError;
use crate::models::SingerCoefficients;
use crate::noise::{GyroNoise, RANGE_SIGMAS, range};
use crate::ranges;
use crate::real::Real;
use crate::settings::{Settings, Visit, visit_noise};

/// Settings of [`SingerImmKf`].
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::SingerImmKfSettings};
/// let settings = SingerImmKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015));
/// let filter = settings.build::<f64>()?;
/// assert_eq!(filter.leave, [0.05, 0.05]); // a model is kept for 20 samples on average
/// let mut leaky = settings;
/// leaky.pair.transition = [0.95, 0.04, 0.05, 0.95];
/// assert_eq!(leaky.build::<f64>().unwrap_err().field, "transition");
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SingerImmKfSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// The gyro's noise.
    pub noise: GyroNoise,
    /// The two models.
    pub pair: SingerPair,
}

impl Settings for SingerImmKfSettings {
    const METHOD: &'static str = "singer-imm-kf";
    type Filter<T: Real> = SingerImmKf<T>;

    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        Self { sample_rate_hz, noise, pair: SingerPair::defaults(noise.sample_variance(sample_rate_hz)) }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visit_noise(visitor, &mut self.noise);
        self.pair.visit(visitor);
    }

    fn build<T: Real>(&self) -> Result<SingerImmKf<T>, ConfigError> {
        ranges::check(self)?;
        let period = 1.0 / self.sample_rate_hz;
        let pair = &self.pair;
        pair.check()?;
        let mut model = [SingerImmModel::NONE; 2];
        for (i, model) in model.iter_mut().enumerate() {
            let (alpha, variance) = (pair.alpha_per_s[i], pair.measurement_variance[i]);
            let (rate, start) = (pair.initial_rate_variance[i], pair.initial_acceleration_variance[i]);
            let intensity = driving_density(alpha, pair.accel_max_dps2[i]);
            *model = SingerImmModel {
                alpha: T::of(alpha),
                step: SingerCoefficients::new(T::of(alpha), T::of(period)).driven_by(T::of(intensity)),
                measurement_variance: T::of(variance),
                start_variance: [T::of(rate), T::of(start)],
            };
        }
        let transition = transition_matrix(&pair.transition)?;
        let [start_probability, _] = probability_pair(&pair.initial_probability)?;
        Ok(SingerImmKf {
            period_s: T::of(period),
            model,
            leave: [transition[0][1], transition[1][0]],
            start_probability,
            limit: range(pair.largest_deviation().least(LARGEST_LEAP_DPS2 * period / RANGE_SIGMAS)),
        })
    }
}

/// A reading this far away after one period is none: mixing squares the acceleration it means, and time stamps may lie closer still.
const LARGEST_LEAP_DPS2: f64 = 1e12;
