//! Update and weigh: what a sample says about every model's motion, and about the model itself.

use super::care::Readings;
use super::state::Wide;
use super::{MsImmIkf, OSCILLATORS, RUNGS};
use crate::gaussian::Gaussian2;
use crate::kalman::{Evidence, Reading, update2, update4};
use crate::real::Real;
use crate::reals::Lanes;

/// Model probabilities never fall below this, so that a model can always come back.
const PROBABILITY_FLOOR: f64 = 1e-12;
const MODELS: usize = 1 + RUNGS + OSCILLATORS;

/// Likelihood of every model; the prior probability stands in the state until it is weighed.
pub(super) struct Weights<T, const W: usize> {
    exponent: [[T; W]; MODELS],
    factor: [[T; W]; MODELS],
    pub(super) innovation: [[T; W]; MODELS],
    pub(super) variance: [[T; W]; MODELS],
    pub(super) outlier: [T; W],
}

impl<T: Real, const W: usize> Weights<T, W> {
    /// Before a sample has said anything.
    #[inline(always)]
    pub(super) fn even() -> Self {
        Self {
            exponent: [[T::ZERO; W]; MODELS],
            factor: [[T::ONE; W]; MODELS],
            innovation: [[T::ZERO; W]; MODELS],
            variance: [[T::ONE; W]; MODELS],
            outlier: [T::ZERO; W],
        }
    }

    #[inline(always)]
    pub(super) fn set(&mut self, model: usize, c: usize, prior: T, evidence: &Evidence<T>) {
        self.exponent[model][c] = evidence.exponent;
        self.factor[model][c] = evidence.factor;
        self.innovation[model][c] = evidence.innovation;
        self.variance[model][c] = evidence.innovation_variance;
        self.outlier[c] += prior * evidence.outlier;
    }
}

impl<T: Real> MsImmIkf<T> {
    #[inline(always)]
    pub(super) fn update<const ORDINARY: bool, const W: usize>(
        &self,
        s: &mut Wide<T, W>,
        readings: &Readings<T, W>,
        used: &[bool; W],
        weights: &mut Weights<T, W>,
    ) {
        let outlier_probability = if ORDINARY { T::ZERO } else { self.outlier_probability };
        let reading =
            |c: usize| Reading { value: readings.value[c], variance: self.measurement_variance, outlier_probability };
        // The first sample sets every model to (z, 0, 0, 0).
        let first = |c: usize| !ORDINARY && used[c] && readings.first[c];
        let used = |c: usize| ORDINARY || used[c];
        for c in 0..W {
            let predicted = Gaussian2 {
                mean: [T::select(first(c), readings.value[c], s.walk[0].0[c]), T::ZERO],
                covariance: [s.walk[1].0[c], T::ZERO, self.missing_acceleration],
            };
            let (updated, evidence) = update2(&predicted, &reading(c));
            weights.set(0, c, s.walk_probability.0[c], &evidence);
            s.walk[0].0[c] = T::select(used(c), updated.mean[0], s.walk[0].0[c]).flushed();
            s.walk[1].0[c] = T::select(used(c), updated.covariance[0], s.walk[1].0[c]);
        }
        for j in 0..self.rungs() {
            for c in 0..W {
                let old = s.rung[j].lane(c);
                let mut predicted = old;
                predicted.mean = core::array::from_fn(|k| first_mean(first(c), readings.value[c], old.mean[k], k));
                let (updated, evidence) = update2(&predicted, &reading(c));
                weights.set(1 + j, c, s.rung_probability[j].0[c], &evidence);
                let kept = Gaussian2 {
                    mean: core::array::from_fn(|k| T::select(used(c), updated.mean[k], old.mean[k]).flushed()),
                    covariance: core::array::from_fn(|k| T::select(used(c), updated.covariance[k], old.covariance[k])),
                };
                s.rung[j].set_lane(c, kept);
            }
        }
        for j in 0..self.oscillators() {
            for c in 0..W {
                let old = s.oscillator[j].lane(c);
                let mut predicted = old;
                predicted.mean = core::array::from_fn(|k| first_mean(first(c), readings.value[c], old.mean[k], k));
                let (mut updated, evidence) = update4(&predicted, &reading(c));
                weights.set(1 + RUNGS + j, c, s.oscillator_probability[j].0[c], &evidence);
                updated.mean = core::array::from_fn(|k| T::select(used(c), updated.mean[k], old.mean[k]).flushed());
                updated.covariance =
                    core::array::from_fn(|k| T::select(used(c), updated.covariance[k], old.covariance[k]));
                s.oscillator[j].set_lane(c, updated);
            }
        }
    }

    /// Posterior probabilities: log-domain exponents against the largest, floor, normalise. A missing sample leaves the prior.
    #[inline(always)]
    pub(super) fn weigh<const ORDINARY: bool, const W: usize>(
        &self,
        s: &mut Wide<T, W>,
        used: &[bool; W],
        weights: &mut Weights<T, W>,
    ) {
        let active = (0..=self.rungs()).chain(1 + RUNGS..1 + RUNGS + self.oscillators());
        let mut highest = weights.exponent[0];
        for m in active.clone() {
            for c in 0..W {
                highest[c] = highest[c].most(weights.exponent[m][c]);
            }
        }
        let mut sum = [T::ZERO; W];
        for m in active.clone() {
            let prior = match m {
                0 => s.walk_probability.0,
                m if m <= RUNGS => s.rung_probability[m - 1].0,
                m => s.oscillator_probability[m - 1 - RUNGS].0,
            };
            for c in 0..W {
                let likelihood = (weights.exponent[m][c] - highest[c]).doubling() * weights.factor[m][c];
                let weight = prior[c] * T::select(ORDINARY || used[c], likelihood, T::ONE);
                weights.factor[m][c] = weight;
                sum[c] += weight;
            }
        }
        for c in 0..W {
            sum[c] = T::ONE / sum[c];
        }
        let mut floored = [T::ZERO; W];
        for m in active.clone() {
            for c in 0..W {
                let probability = (weights.factor[m][c] * sum[c]).most(T::of(PROBABILITY_FLOOR));
                weights.factor[m][c] = probability;
                floored[c] += probability;
            }
        }
        for c in 0..W {
            floored[c] = T::ONE / floored[c];
            s.walk_probability.0[c] = weights.factor[0][c] * floored[c];
        }
        for j in 0..self.rungs() {
            for c in 0..W {
                s.rung_probability[j].0[c] = weights.factor[1 + j][c] * floored[c];
            }
        }
        for j in 0..self.oscillators() {
            for c in 0..W {
                s.oscillator_probability[j].0[c] = weights.factor[1 + RUNGS + j][c] * floored[c];
            }
        }
    }
}

/// Component `k` of the predicted mean: (z, 0, 0, 0) at the first sample.
#[inline(always)]
fn first_mean<T: Real>(first: bool, value: T, predicted: T, k: usize) -> T {
    T::select(first, T::select(k == 0, value, T::ZERO), predicted)
}
