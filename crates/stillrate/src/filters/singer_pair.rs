//! Two Singer models, one for rest and one for motion: what a two-model filter is told about them, and the checks that all filters of
//! Singer models share.

use crate::error::ConfigError;
use crate::ranges;
use crate::real::Real;
use crate::settings::Visit;

/// Settings of two interacting Singer models: two of everything, rest first.
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::{SingerImmKfSettings, SingerPair}};
/// let mut settings = SingerImmKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015));
/// settings.pair = SingerPair { accel_max_dps2: [1.5, 300.0], ..settings.pair }; // a more agile vehicle
/// assert!(settings.build::<f64>().is_ok());
/// settings.pair.initial_probability = [0.5, 0.4];
/// assert_eq!(settings.build::<f64>().unwrap_err().field, "initial_probability");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SingerPair {
    /// Reciprocal manoeuvre time constants, 1/s; default .001, .01.
    pub alpha_per_s: [f64; 2],
    /// Largest accelerations, deg/s^2; default 1.5, 30.
    pub accel_max_dps2: [f64; 2],
    /// Transition probabilities a sample, row by row (from first to first, from first to second, ...); default .95 .05 .05 .95.
    pub transition: [f64; 4],
    /// Probabilities before the first sample; default .5, .5.
    pub initial_probability: [f64; 2],
    /// Variances of a sample, (deg/s)^2; default that of the noise at the sample rate.
    pub measurement_variance: [f64; 2],
    /// Variances of the rate before the first sample, (deg/s)^2; default the same.
    pub initial_rate_variance: [f64; 2],
    /// Variances of the acceleration before the first sample, (deg/s^2)^2; default 1, 100.
    pub initial_acceleration_variance: [f64; 2],
}

impl SingerPair {
    /// The defaults for samples of a variance.
    pub(crate) fn defaults(sample_variance: f64) -> Self {
        Self {
            alpha_per_s: [0.001, 0.01],
            accel_max_dps2: [1.5, 30.0],
            transition: [0.95, 0.05, 0.05, 0.95],
            initial_probability: [0.5, 0.5],
            measurement_variance: [sample_variance; 2],
            initial_rate_variance: [sample_variance; 2],
            initial_acceleration_variance: [1.0, 100.0],
        }
    }

    pub(crate) fn visit<V: Visit>(&mut self, visitor: &mut V) {
        let mut pair = |name, values: &mut [f64]| visit_pair(visitor, name, values);
        pair("alpha_per_s", &mut self.alpha_per_s);
        pair("accel_max_dps2", &mut self.accel_max_dps2);
        pair("transition", &mut self.transition);
        pair("initial_probability", &mut self.initial_probability);
        pair("measurement_variance", &mut self.measurement_variance);
        pair("initial_rate_variance", &mut self.initial_rate_variance);
        pair("initial_acceleration_variance", &mut self.initial_acceleration_variance);
    }

    /// Checks what depends on both models.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        check_variances(&self.measurement_variance)?;
        let (alpha_per_s, accel_max_dps2) = (&self.alpha_per_s, &self.accel_max_dps2);
        let initial_variance = &self.initial_acceleration_variance;
        SingerFigures { alpha_per_s, accel_max_dps2, initial_variance }.check()
    }

    /// The larger standard deviation of a sample, deg/s.
    pub(crate) fn largest_deviation(&self) -> f64 {
        self.measurement_variance.iter().fold(0.0, |largest: f64, variance| largest.most(variance.root()))
    }
}

/// Visits a list of fixed length. One value given serves all entries; a wrong count is refused when the filter is built.
pub(crate) fn visit_pair<V: Visit>(visitor: &mut V, name: &'static str, values: &mut [f64]) {
    let mut count = values.len();
    visitor.list(name, values, &mut count);
    match (count, values.first().copied()) {
        (1, Some(value)) => values.fill(value),
        (count, _) if count != values.len() => values.fill(f64::NAN),
        _ => {}
    }
}

/// Checks that both models speak of the same sensor.
fn check_variances(pair: &[f64; 2]) -> Result<(), ConfigError> {
    let range = "within a factor of 1e6 of that of the first model, in";
    if pair[1].most(pair[0]) <= 1e6 * pair[0].least(pair[1]) {
        Ok(())
    } else {
        Err(ConfigError::new("measurement_variance", pair[1], "(deg/s)^2", range))
    }
}

/// What Singer models are made of, each figure in its range.
pub(crate) struct SingerFigures<'a> {
    pub(crate) alpha_per_s: &'a [f64],
    pub(crate) accel_max_dps2: &'a [f64],
    pub(crate) initial_variance: &'a [f64],
}

impl SingerFigures<'_> {
    /// Checks the figures against each other; those of all models, because what one gathers another may carry on.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        let slowest = self.alpha_per_s.iter().fold(f64::INFINITY, |least, &alpha| alpha.least(least));
        for &accel_max in self.accel_max_dps2 {
            ranges::check_swing("accel_max_dps2", accel_max, accel_max, slowest)?;
        }
        for &variance in self.initial_variance {
            ranges::check_swing("initial_acceleration_variance", variance, variance.root(), slowest)?;
        }
        Ok(())
    }
}

/// Density of the driving noise, 2 alpha A_max^2 / 3.
pub(crate) fn driving_density(alpha_per_s: f64, accel_max_dps2: f64) -> f64 {
    2.0 * alpha_per_s * (accel_max_dps2 * accel_max_dps2 / 3.0)
}

/// Checks a 2 x 2 transition matrix, row by row.
pub(crate) fn transition_matrix<T: Real>(rows: &[f64; 4]) -> Result<[[T; 2]; 2], ConfigError> {
    let range = "probabilities whose rows (from each model) sum to 1";
    let refuse = |value| Err(ConfigError::new("transition", value, "", range));
    for (stay, leave) in [(rows[0], rows[1]), (rows[2], rows[3])] {
        if !(0.0..=1.0).contains(&stay) {
            return refuse(stay);
        }
        let sum_off = (stay + leave - 1.0).magnitude();
        if !(0.0..=1.0).contains(&leave) || sum_off > 1e-9 {
            return refuse(leave);
        }
    }
    Ok([[T::of(rows[0]), T::of(rows[1])], [T::of(rows[2]), T::of(rows[3])]])
}

/// Checks two probabilities that sum to 1.
pub(crate) fn probability_pair<T: Real>(pair: &[f64; 2]) -> Result<[T; 2], ConfigError> {
    let valid = pair.iter().all(|p| (0.0..=1.0).contains(p)) && (pair[0] + pair[1] - 1.0).magnitude() <= 1e-9;
    if valid {
        Ok(pair.map(T::of))
    } else {
        Err(ConfigError::new("initial_probability", pair[0], "", "two probabilities that sum to 1"))
    }
}
