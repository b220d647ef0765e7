//! RMS error of the filters on the bench, and the search that tunes a rival fairly: on other seeds than it is judged on.

use rayon::prelude::*;
use stillrate::filters::{
    CusumForgettingSettings, FirLowPassSettings, OneEuroSettings, RecursiveLeastSquaresSettings,
    VariableForgettingSettings, closed_forms,
};
use stillrate::{ConfigError, Filter, GyroNoise, Real, Settings};

use super::response::feed;
use super::scenarios::{SAMPLE_RATE_HZ, SCENARIOS, SIGMA_DPS, Scenario, measured, truth};
use crate::metrics::lag_ms;
use crate::random::{Generator, Random};

/// Noise of the bench, white with [`SIGMA_DPS`] a sample.
///
/// # Example
/// ```
/// use stillrate_lab::recursive::bench::noise;
/// assert!((noise().sample_variance(200.0).sqrt() - 0.05).abs() < 1e-15); // deg/s at 200 Hz
/// ```
#[must_use]
pub fn noise() -> GyroNoise {
    GyroNoise::from_standard_deviation_at_rate(SIGMA_DPS, SAMPLE_RATE_HZ)
}

/// One row of the table: a filter and its RMS errors over sigma in the order of [`SCENARIOS`], then the lag in the mixed one, samples.
///
/// # Example
/// ```
/// use stillrate::filters::OneEuroSettings;
/// use stillrate::Settings;
/// use stillrate_lab::recursive::bench::{noise, table};
/// let rows = table(&[1], &OneEuroSettings::defaults(200.0, noise()))?;
/// let moving_mean = &rows[2];
/// assert_eq!(moving_mean.name, "boxcar 40");
/// assert!((moving_mean.error[0] - 40.0_f64.sqrt().recip()).abs() < 0.01); // at rest: one over root n
/// assert!((moving_mean.lag - 19.5).abs() < 1.0); // (n - 1)/2 samples
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the filter.
    pub name: String,
    /// RMS error over sigma by scenario.
    pub error: Vec<f64>,
    /// Lag in the mixed scenario, samples.
    pub lag: f64,
}

/// A scenario played out: truth and measurement, once a seed.
///
/// # Example
/// ```
/// use stillrate::{Settings, filters::VariableForgettingSettings};
/// use stillrate_lab::recursive::{bench::{Played, noise}, scenarios::{SAMPLE_RATE_HZ, Scenario}};
/// let filter = VariableForgettingSettings::defaults(SAMPLE_RATE_HZ, noise()).build::<f64>()?;
/// let error = |scenario| Played::of(scenario, &[1]).relative_error(filter);
/// assert!(error(Scenario::Quiet) < 0.17); // a sixth of the noise at rest
/// assert!(error(Scenario::Sine(1.0)) < 1.4); // and little more than the noise in motion
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Played(Vec<(Vec<f64>, Vec<f64>)>);

impl Played {
    /// Plays a scenario on all seeds.
    #[must_use]
    pub fn of(scenario: Scenario, seeds: &[u64]) -> Self {
        let one = |&seed: &u64| {
            let clean = truth(scenario, seed);
            let noisy = measured(&clean, seed);
            (clean, noisy)
        };
        Self(seeds.iter().map(one).collect())
    }

    /// RMS error of a filter over sigma, over all seeds.
    #[must_use]
    pub fn relative_error<F: Filter<f64>>(&self, filter: F) -> f64 {
        let mut sum = 0.0;
        let mut count = 0.0;
        for (clean, noisy) in &self.0 {
            let mut run = feed(filter);
            for (&value, rate) in noisy.iter().zip(clean) {
                let error = run(value) - rate;
                sum += error * error;
                count += 1.0;
            }
        }
        (sum / count).root() / SIGMA_DPS
    }
}

fn row<F: Filter<f64>>(name: &str, filter: F, seeds: &[u64]) -> Row {
    let error = SCENARIOS.par_iter().map(|&(_, scenario)| Played::of(scenario, seeds).relative_error(filter)).collect();
    let lags: Vec<f64> = Played::of(Scenario::Mixed, seeds)
        .0
        .into_iter()
        .map(|(clean, noisy)| {
            let estimate: Vec<f64> = noisy.into_iter().map(feed(filter)).collect();
            lag_ms(&estimate, &clean, SAMPLE_RATE_HZ, 0.5) * SAMPLE_RATE_HZ / 1000.0
        })
        .collect();
    Row { name: name.into(), error, lag: lags.iter().sum::<f64>() / lags.len() as f64 }
}

/// A fixed filter of order 1 or 2 with a given forgetting factor at the bench's rate.
pub(super) fn least_squares(order: f64, forgetting_factor: f64) -> RecursiveLeastSquaresSettings {
    let tau_s = closed_forms::tau_samples(forgetting_factor) / SAMPLE_RATE_HZ;
    let defaults = RecursiveLeastSquaresSettings::defaults(SAMPLE_RATE_HZ, noise());
    RecursiveLeastSquaresSettings { order, tau_s, forgetting_factor, ..defaults }
}

/// The table of section "adaptive filters": every filter in every scenario on `seeds`; one-euro as given.
///
/// # Errors
/// [`ConfigError`] if the one-euro settings cannot be used.
///
/// # Example
/// ```
/// use stillrate::{Settings, filters::OneEuroSettings};
/// use stillrate_lab::recursive::bench::{noise, table};
/// let rows = table(&[1], &OneEuroSettings::defaults(200.0, noise()))?;
/// assert!(rows[0].error.iter().all(|error| (error - 1.0).abs() < 0.02)); // without a filter the error is the noise
/// let [average, adaptive] = ["EMA .9512", "VFF"].map(|name| rows.iter().find(|row| row.name == name).unwrap());
/// assert!(average.error[7] > 30.0 && adaptive.error[7] < 1.05); // mixed motion
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub fn table(seeds: &[u64], one_euro: &OneEuroSettings) -> Result<Vec<Row>, ConfigError> {
    let (fs, noise) = (SAMPLE_RATE_HZ, noise());
    let fir = FirLowPassSettings::defaults(fs, noise);
    let open = FirLowPassSettings { length: 1.0, ..fir.clone() };
    let boxcar = FirLowPassSettings { length: 40.0, ..fir.clone() };
    let hamming = FirLowPassSettings { window: 2, length: 56.0, ..fir };
    Ok(vec![
        row("no filter", open.build::<f64>()?, seeds),
        row("EMA .9512", least_squares(1.0, 0.9512).build::<f64>()?, seeds),
        row("boxcar 40", boxcar.build::<f64>()?, seeds),
        row("FIR Hamming 56", hamming.build::<f64>()?, seeds),
        row("RLS2 .98003", least_squares(2.0, 0.980_030_864_152_712).build::<f64>()?, seeds),
        row("one-euro (tuned)", one_euro.build::<f64>()?, seeds),
        row("VFF", VariableForgettingSettings::defaults(fs, noise).build::<f64>()?, seeds),
        row("CUSUM", CusumForgettingSettings::defaults(fs, noise).build::<f64>()?, seeds),
        row("VFF2", VariableForgettingSettings::defaults_of_order_2(fs, noise).build::<f64>()?, seeds),
    ])
}

/// Quiet noise ratio that a tuned filter may have: that of the others.
const QUIET_ALLOWED: f64 = 0.165;

/// The one-euro settings with the least mixed error among `draws` random ones that are as quiet as the others, then
/// among as many smaller changes of the best.
///
/// # Example
/// ```
/// use stillrate::{Settings, filters::OneEuroSettings};
/// use stillrate_lab::recursive::{bench::{Played, noise, tune_one_euro}, scenarios::Scenario};
/// let tuned = tune_one_euro(8, 1, &[911]);
/// let mixed = Played::of(Scenario::Mixed, &[911]);
/// let error = |settings: &OneEuroSettings| mixed.relative_error(settings.build::<f64>().unwrap());
/// assert!(error(&tuned) <= error(&OneEuroSettings::defaults(200.0, noise()))); // the search starts from the defaults
/// ```
#[must_use]
pub fn tune_one_euro(draws: usize, search_seed: u64, seeds: &[u64]) -> OneEuroSettings {
    let mut random = Random::new(search_seed, 0);
    let (quiet, mixed) = (Played::of(Scenario::Quiet, seeds), Played::of(Scenario::Mixed, seeds));
    let score = |settings: &OneEuroSettings| -> f64 {
        let Ok(filter) = settings.build::<f64>() else { return f64::INFINITY };
        if quiet.relative_error(filter) > QUIET_ALLOWED {
            return f64::INFINITY;
        }
        mixed.relative_error(filter)
    };
    let between = |random: &mut Random, low: f64, high: f64| {
        (low.logarithm() + (high.logarithm() - low.logarithm()) * random.uniform()).exponential()
    };
    let mut best = OneEuroSettings::defaults(SAMPLE_RATE_HZ, noise());
    let mut least = score(&best);
    for narrow in [false, true] {
        let near = best.clone();
        let candidates: Vec<OneEuroSettings> = (0..draws)
            .map(|_| {
                let mut pick = |centre: f64, low: f64, high: f64| {
                    if narrow {
                        between(&mut random, centre / 1.5, centre * 1.5)
                    } else {
                        between(&mut random, low, high)
                    }
                };
                OneEuroSettings {
                    sample_rate_hz: SAMPLE_RATE_HZ,
                    minimum_cutoff_hz: pick(near.minimum_cutoff_hz, 0.1, 2.0),
                    beta: pick(near.beta, 0.001, 20.0),
                    derivative_cutoff_hz: pick(near.derivative_cutoff_hz, 0.1, 60.0),
                }
            })
            .collect();
        let scores: Vec<f64> = candidates.par_iter().map(score).collect();
        for (candidate, value) in candidates.into_iter().zip(scores) {
            if value < least {
                (best, least) = (candidate, value);
            }
        }
    }
    best
}
