//! Innovation likelihood of a bank of models (IMM), for tuning its noise without a truth.
//!
//! The likelihood of a sample is p = sum_j c_j L_j with prior probabilities c_j and L_j = N(innovation; 0, S_j). An observer sees the
//! posterior mu_j = c_j L_j / p. With one dwell time a model the prior follows from the posterior before:
//! c_j = (1 - e_j) mu_j + sum_{i != j} mu_i e_i/(n - 1). Value: -2 mean ln p, less ln 2 pi, to be comparable
//! with the concentrated form of the small filters.

use rayon::prelude::*;
use stillrate::{
    ConfigError, Filter, GyroNoise, ModelTrace, Observer, Real, Sample, Settings, filters::MsImmIkfSettings,
};

use crate::tune::gain_ratio::LN_10;
use crate::tune::objective::Objective;
use crate::tune::records::Record;

/// Probabilities below this are the bank's floor and not a likelihood.
const SMALLEST_LIKELIHOOD: f64 = 1e-300;

/// Collects what the likelihood of a sample needs.
struct Likelihood {
    /// Probability of leaving each model at a step.
    leave: Vec<f64>,
    /// Posterior probabilities of the sample before.
    before: Vec<f64>,
    /// Those of this sample.
    after: Vec<f64>,
    /// Likelihood of the sample in each model.
    each: Vec<f64>,
}

impl Observer<f64> for Likelihood {
    fn model(&mut self, index: usize, trace: ModelTrace<f64>) {
        let v = trace.innovation;
        let s = trace.innovation_variance;
        self.after[index] = trace.probability;
        // The factor 1/sqrt(2 pi) is left out throughout.
        self.each[index] = (-0.5 * v * v / s).exponential() / s.root();
    }
}

impl Likelihood {
    fn new(settings: &MsImmIkfSettings, models: usize) -> Self {
        let stay = |dwell_s: f64| (1.0 / (dwell_s * settings.sample_rate_hz)).min(1.0);
        let mut leave = vec![stay(settings.dwell_time_s); models];
        leave[0] = stay(settings.rest_dwell_time_s);
        let even = vec![1.0 / models as f64; models];
        Self { leave, before: even.clone(), after: even, each: vec![0.0; models] }
    }

    /// ln p of the sample just seen (none for a missing one); the posterior becomes the next prior.
    fn take(&mut self) -> Option<f64> {
        let n = self.before.len();
        let outflow: f64 = self.before.iter().zip(&self.leave).map(|(mu, e)| mu * e).sum();
        let share = 1.0 / (n.max(2) - 1) as f64;
        let p: f64 = (0..n)
            .map(|j| {
                let own = self.before[j] * self.leave[j];
                (self.before[j] - own + (outflow - own) * share) * self.each[j]
            })
            .sum();
        self.before.copy_from_slice(&self.after);
        p.is_finite().then(|| p.most(SMALLEST_LIKELIHOOD).logarithm())
    }
}

/// Objective over (log10 density in deg/s/sqrt(Hz), log10 rate random walk in deg/s/sqrt(s)) of the recommended bank.
pub(super) struct BankLikelihood<'a> {
    /// Records that share the noise.
    pub(super) records: &'a [Record<'a>],
    /// Settings of the bank; their noise is replaced.
    pub(super) settings: MsImmIkfSettings,
}

/// The noise of a point.
pub(super) fn noise_at(point: &[f64]) -> GyroNoise {
    GyroNoise::from_density_two_sided((LN_10 * point[0]).exponential())
        .with_rate_random_walk((LN_10 * point[1]).exponential())
}

impl BankLikelihood<'_> {
    /// Value of a point; an error if the bank cannot be built with its noise.
    fn value(&self, point: &[f64]) -> Result<f64, ConfigError> {
        let mut settings = self.settings.clone();
        settings.noise = noise_at(point);
        let filter = settings.build::<f64>()?;
        let dt = filter.period();
        let (mut sum, mut count) = (0.0, 0.0);
        for record in self.records {
            let mut state = filter.start();
            let mut likelihood = Likelihood::new(&settings, filter.models());
            let mut started = false;
            for &value in record.measured {
                filter.observe(&mut state, Sample { value, dt }, &mut likelihood);
                // The first sample starts the bank: its likelihood is that of the start, not of the noise.
                if let Some(ln_p) = likelihood.take().filter(|_| started && value.is_finite()) {
                    sum += ln_p;
                    count += 1.0;
                }
                started |= value.is_finite();
            }
        }
        Ok(-2.0 * sum / count)
    }
}

impl Objective for BankLikelihood<'_> {
    fn values(&mut self, points: &[f64], dimensions: usize) -> Vec<f64> {
        let points: Vec<&[f64]> = points.chunks_exact(dimensions).collect();
        points.par_iter().map(|point| self.value(point).unwrap_or(f64::INFINITY)).collect()
    }
}
