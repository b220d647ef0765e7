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

/// Noise of the bench.
#[must_use]
pub fn noise() -> GyroNoise {
    GyroNoise::from_standard_deviation_at_rate(SIGMA_DPS, SAMPLE_RATE_HZ)
}

/// One row of the table: a filter and its RMS errors over sigma in the order of [`SCENARIOS`], then the lag in the mixed one, samples.
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
#[derive(Clone, Debug, PartialEq)]
pub struct Played(Vec<(Vec<f64>, Vec<f64>)>);

/// Plays a scenario on all seeds.
#[must_use]
pub fn play(scenario: Scenario, seeds: &[u64]) -> Played {
    let one = |&seed: &u64| {
        let clean = truth(scenario, seed);
        let noisy = measured(&clean, seed);
        (clean, noisy)
    };
    Played(seeds.iter().map(one).collect())
}

/// RMS error over sigma, over all seeds.
#[must_use]
pub fn relative_error<F: Filter<f64>>(filter: F, played: &Played) -> f64 {
    let mut sum = 0.0;
    let mut count = 0.0;
    for (clean, noisy) in &played.0 {
        let mut run = feed(filter);
        for (&value, rate) in noisy.iter().zip(clean) {
            let error = run(value) - rate;
            sum += error * error;
            count += 1.0;
        }
    }
    (sum / count).root() / SIGMA_DPS
}

fn row<F: Filter<f64>>(name: &str, filter: F, seeds: &[u64]) -> Row {
    let error = SCENARIOS.par_iter().map(|&(_, scenario)| relative_error(filter, &play(scenario, seeds))).collect();
    let lags: Vec<f64> = play(Scenario::Mixed, seeds)
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
#[must_use]
pub fn least_squares(order: f64, forgetting_factor: f64) -> RecursiveLeastSquaresSettings {
    let tau_s = closed_forms::tau_samples(forgetting_factor) / SAMPLE_RATE_HZ;
    let defaults = RecursiveLeastSquaresSettings::defaults(SAMPLE_RATE_HZ, noise());
    RecursiveLeastSquaresSettings { order, tau_s, forgetting_factor, ..defaults }
}

/// The table of section "adaptive filters": every filter in every scenario on `seeds`; one-euro as given.
///
/// # Errors
/// [`ConfigError`] if the one-euro settings cannot be used.
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
pub const QUIET_ALLOWED: f64 = 0.165;

/// The one-euro settings with the least mixed error among `draws` random ones that are as quiet as the others, then
/// among as many smaller changes of the best.
#[must_use]
pub fn tune_one_euro(draws: usize, search_seed: u64, seeds: &[u64]) -> OneEuroSettings {
    let mut random = Random::new(search_seed, 0);
    let (quiet, mixed) = (play(Scenario::Quiet, seeds), play(Scenario::Mixed, seeds));
    let score = |settings: &OneEuroSettings| -> f64 {
        let Ok(filter) = settings.build::<f64>() else { return f64::INFINITY };
        if relative_error(filter, &quiet) > QUIET_ALLOWED {
            return f64::INFINITY;
        }
        relative_error(filter, &mixed)
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
