//! The cycle of the recommended bank: mix, predict, update, weigh, fuse, follow the frequency.
//!
//! Each stage is a loop over the models with a loop over the channels inside; the latter is straight-line code that the compiler
//! turns into vector instructions. The order of every sum over models is fixed: random walk, rungs, oscillators.

use super::ms_imm_ikf::{MsImmIkf, OSCILLATORS, PROBABILITY_FLOOR, Pace, RUNGS, Wide};
use crate::filter::{Checked, Flags, ModelTrace, Observer};
use crate::gaussian::Gaussian2;
use crate::imm::{Sums2, Sums4};
use crate::kalman::{Evidence, Reading, predict_oscillator, predict_singer, sound2, sound4, update2, update4};
use crate::real::Real;
use crate::reals::{Lane, Lanes};

/// In a longer dropout the bank's own prediction teaches it nothing more about the motion: an oscillator that learns its
/// frequency from itself runs away exponentially. The longer of a time in seconds and a number of samples.
const LONGEST_ECHO_S: f64 = 0.5;
const LONGEST_ECHO_SAMPLES: f64 = 20.0;

const MODELS: usize = 1 + RUNGS + OSCILLATORS;

/// What every target of the mixing needs to know about the last posterior.
struct Sources<T, const W: usize> {
    /// Fused mean: the centre of all sums.
    centre: [Lane<T, W>; 4],
    /// All sources, as targets without an oscillation see them.
    plain: Sums2<Lane<T, W>>,
    /// All sources, as oscillators see them.
    widened: Sums4<Lane<T, W>>,
}

/// Likelihood of every model; the prior probability stands in the state until it is weighed.
struct Weights<T, const W: usize> {
    exponent: [[T; W]; MODELS],
    factor: [[T; W]; MODELS],
    innovation: [[T; W]; MODELS],
    variance: [[T; W]; MODELS],
    outlier: [T; W],
}

impl<T: Real, const W: usize> Weights<T, W> {
    #[inline(always)]
    fn set(&mut self, model: usize, c: usize, prior: T, evidence: &Evidence<T>) {
        self.exponent[model][c] = evidence.exponent;
        self.factor[model][c] = evidence.factor;
        self.innovation[model][c] = evidence.innovation;
        self.variance[model][c] = evidence.innovation_variance;
        self.outlier[c] += prior * evidence.outlier;
    }
}

/// A row of samples, sorted.
pub(crate) struct Readings<T, const W: usize> {
    value: [T; W],
    /// Whether the sample is to be used.
    used: [bool; W],
    /// Whether it is the first.
    first: [bool; W],
    flags: [Flags; W],
}

impl<T: Real, const W: usize> Readings<T, W> {
    /// A row in which every channel has a usable sample and none is the first.
    #[inline(always)]
    pub(crate) fn ordinary(value: &[T; W]) -> Self {
        Self { value: *value, used: [true; W], first: [false; W], flags: [Flags::NONE; W] }
    }

    /// Any row.
    #[inline(always)]
    pub(crate) fn checked(checked: &[Checked<T>; W], started: &Lane<T, W>) -> Self {
        let mut readings = Self::ordinary(&[T::ZERO; W]);
        for c in 0..W {
            readings.value[c] = checked[c].value;
            readings.used[c] = checked[c].present;
            readings.first[c] = checked[c].present && started.0[c] == T::ZERO;
            readings.flags[c] = checked[c].flags;
        }
        readings
    }
}

impl<T: Real> MsImmIkf<T> {
    /// One row through the whole cycle; returns the flags. `ORDINARY` promises a row made by [`Readings::ordinary`]
    /// and no outliers expected: every select is then decided at compile time.
    #[inline(always)]
    pub(crate) fn cycle<const ORDINARY: bool, const W: usize, O: Observer<T>>(
        &self,
        s: &mut Wide<T, W>,
        readings: &Readings<T, W>,
        pace: &Pace<T>,
        observer: &mut O,
    ) -> [Flags; W] {
        observer.frequency(s.motion.angle.0[0] / self.period_s);
        let sources = self.gather_sources(s, pace);
        let mut weights = Weights {
            exponent: [[T::ZERO; W]; MODELS],
            factor: [[T::ONE; W]; MODELS],
            innovation: [[T::ZERO; W]; MODELS],
            variance: [[T::ONE; W]; MODELS],
            outlier: [T::ZERO; W],
        };
        self.mix_and_predict(s, &sources, pace);
        let mut used = readings.used;
        let mut flags = readings.flags;
        if !ORDINARY && self.saturation < T::LARGEST {
            self.skip_beyond_the_rail(s, readings, &mut used, &mut flags);
        }
        self.update::<ORDINARY, W>(s, readings, &used, &mut weights);
        self.weigh::<ORDINARY, W>(s, &used, &mut weights);
        for c in 0..W {
            s.silent.0[c] = T::select(ORDINARY || readings.used[c], T::ZERO, s.silent.0[c]);
        }
        self.fuse_and_follow::<ORDINARY, W>(s, pace);
        if !ORDINARY {
            for c in 0..W {
                s.started.0[c] = T::select(readings.used[c], T::ONE, s.started.0[c]);
                flags[c] = flags[c].with(Flags::OUTLIER.when(used[c] && weights.outlier[c] > T::HALF));
            }
        }
        self.show(s, &used, &weights, observer);
        flags
    }

    #[inline(always)]
    fn gather_sources<const W: usize>(&self, s: &Wide<T, W>, pace: &Pace<T>) -> Sources<T, W> {
        let zero = Lane([T::ZERO; W]);
        let (rungs, oscillators) = (self.rungs(), self.oscillators());
        // Each source gives every other model mu_i e_i / (n - 1).
        let (given, given_at_rest) = (pace.leave * self.share, pace.leave_rest * self.share);
        let mut centre = [s.fused[0], s.fused[1], zero, zero];
        for j in 0..oscillators {
            for c in 0..W {
                centre[2].0[c] += s.oscillator_probability[j].0[c] * s.oscillator[j].mean[2].0[c];
                centre[3].0[c] += s.oscillator_probability[j].0[c] * s.oscillator[j].mean[3].0[c];
            }
        }
        let none2 = Sums2 { weight: zero, first: [zero; 2], second: [zero; 3] };
        let none4 = Sums4 { weight: zero, first: [zero; 4], second: [zero; 10] };
        let (mut plain, mut pulled, mut oscillating) = (none2, none2, none4);
        let mut cap = [T::ZERO; W];
        let uncapped = self.derivative_cap == T::LARGEST;
        for c in 0..W {
            let angle = s.motion.angle.0[c];
            let floor = self.noise_share * angle * angle;
            // An infinite cap is stored as the largest number: no product with it may become NaN.
            let finite = (self.derivative_cap * s.motion.acceleration_square.0[c] + floor).least(T::LARGEST);
            cap[c] = T::select(uncapped, T::LARGEST, finite);
        }
        for c in 0..W {
            let (mut sum, mut pulled_sum) = (plain.lane(c), pulled.lane(c));
            let weight = s.walk_probability.0[c] * given_at_rest;
            sum.add_and_pull(&mut pulled_sum, weight, &self.rest(s, c), centre.lane(c), cap[c]);
            plain.set_lane(c, sum);
            pulled.set_lane(c, pulled_sum);
        }
        for j in 0..rungs {
            for c in 0..W {
                let (mut sum, mut pulled_sum) = (plain.lane(c), pulled.lane(c));
                let weight = s.rung_probability[j].0[c] * given;
                sum.add_and_pull(&mut pulled_sum, weight, &s.rung[j].lane(c), centre.lane(c), cap[c]);
                plain.set_lane(c, sum);
                pulled.set_lane(c, pulled_sum);
            }
        }
        for j in 0..oscillators {
            for c in 0..W {
                let weight = s.oscillator_probability[j].0[c] * given;
                let mut sum = oscillating.lane(c);
                sum.add(weight, &s.oscillator[j].lane(c), centre.lane(c));
                oscillating.set_lane(c, sum);
            }
        }
        let mut widened = none4;
        for c in 0..W {
            let others = oscillating.lane(c);
            let seen = pulled.lane(c).widened(s.lacking.lane(c), centre.lane(c));
            widened.set_lane(c, seen.with(&others));
            plain.set_lane(c, plain.lane(c).with(&others));
        }
        Sources { centre, plain, widened }
    }

    /// The random walk with the acceleration it lacks.
    #[inline(always)]
    fn rest<const W: usize>(&self, s: &Wide<T, W>, c: usize) -> Gaussian2<T> {
        Gaussian2 { mean: [s.walk[0].0[c], T::ZERO], covariance: [s.walk[1].0[c], T::ZERO, self.missing_acceleration] }
    }

    #[inline(always)]
    fn mix_and_predict<const W: usize>(&self, s: &mut Wide<T, W>, sources: &Sources<T, W>, pace: &Pace<T>) {
        // A model stays with 1 - e_j; the common sum already holds its share for others.
        let extra = (T::ONE - pace.leave) - pace.leave * self.share;
        let extra_at_rest = (T::ONE - pace.leave_rest) - pace.leave_rest * self.share;
        for c in 0..W {
            let own = extra_at_rest * s.walk_probability.0[c];
            let (prior, mixed) = sources.plain.lane(c).mixed(own, &self.rest(s, c), sources.centre.lane(c));
            s.walk_probability.0[c] = prior;
            s.walk[0].0[c] = mixed.mean[0];
            s.walk[1].0[c] = mixed.covariance[0].most(T::ZERO) + pace.walk;
        }
        for j in 0..self.rungs() {
            for c in 0..W {
                let own = extra * s.rung_probability[j].0[c];
                let (prior, mixed) = sources.plain.lane(c).mixed(own, &s.rung[j].lane(c), sources.centre.lane(c));
                s.rung_probability[j].0[c] = prior;
                let predicted = predict_singer(&mixed, &pace.singer, self.rung_intensity[j]);
                s.rung[j].set_lane(c, sound2(&predicted, self.rung_intensity[j] * pace.singer.q22));
            }
        }
        for j in 0..self.oscillators() {
            for c in 0..W {
                let own = extra * s.oscillator_probability[j].0[c];
                let centre = sources.centre.lane(c);
                let (prior, mixed) = sources.widened.lane(c).mixed(own, &s.oscillator[j].lane(c), centre);
                s.oscillator_probability[j].0[c] = prior;
                let (step, intensity) = (s.step.lane(c), self.oscillator_intensity[j]);
                let predicted = predict_oscillator(&mixed, &step, intensity);
                let least = [step.noise[4] * intensity, step.noise[7] * intensity, step.noise[9] * intensity];
                s.oscillator[j].set_lane(c, sound4(&predicted, least));
            }
        }
        s.lacking = s.lacking_next;
        if pace.elapsed > T::ONE {
            self.widen_after_gap(s, pace.elapsed);
        }
    }

    /// An oscillator that has forgotten its phase knows no more than the size of the motion.
    #[cold]
    #[inline(never)]
    fn widen_after_gap<const W: usize>(&self, s: &mut Wide<T, W>, elapsed: T) {
        for c in 0..W {
            if s.motion.angle.0[c] * elapsed <= self.memory.angle_max {
                continue;
            }
            for model in s.oscillator.iter_mut().take(self.oscillators()) {
                model.covariance[0].0[c] += s.motion.rate_square.0[c];
                model.covariance[4].0[c] += s.motion.acceleration_square.0[c] + self.missing_acceleration;
                model.covariance[7].0[c] += s.lacking_next[0].0[c];
                model.covariance[9].0[c] += s.lacking_next[1].0[c];
            }
        }
    }

    /// A sample at the rail only says "at least this much": where the prediction lies beyond it, it says nothing.
    #[inline(always)]
    fn skip_beyond_the_rail<const W: usize>(
        &self,
        s: &Wide<T, W>,
        readings: &Readings<T, W>,
        used: &mut [bool; W],
        flags: &mut [Flags; W],
    ) {
        for c in 0..W {
            let z = readings.value[c];
            let mut predicted = s.walk_probability.0[c] * s.walk[0].0[c];
            for j in 0..self.rungs() {
                predicted += s.rung_probability[j].0[c] * s.rung[j].mean[0].0[c];
            }
            for j in 0..self.oscillators() {
                predicted += s.oscillator_probability[j].0[c] * s.oscillator[j].mean[0].0[c];
            }
            let at_rail = readings.used[c] && z.magnitude() >= self.saturation;
            let beyond = if z < T::ZERO { predicted < z } else { predicted > z };
            used[c] = used[c] && !(at_rail && beyond && s.started.0[c] != T::ZERO);
            flags[c] = flags[c].with(Flags::SATURATED.when(at_rail));
        }
    }

    #[inline(always)]
    fn update<const ORDINARY: bool, const W: usize>(
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
    fn weigh<const ORDINARY: bool, const W: usize>(
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

    /// Mean and variance of the mixture; then the frequency follows it, wide rungs left out.
    #[inline(always)]
    fn fuse_and_follow<const ORDINARY: bool, const W: usize>(&self, s: &mut Wide<T, W>, pace: &Pace<T>) {
        let longest = (T::of(LONGEST_ECHO_S) / self.period_s).most(T::of(LONGEST_ECHO_SAMPLES));
        let mut rate = [T::ZERO; W];
        let mut acceleration = [T::ZERO; W];
        let mut inner = [[T::ZERO; W]; 3];
        for c in 0..W {
            let mu = s.walk_probability.0[c];
            rate[c] = mu * s.walk[0].0[c];
            inner[0][c] = mu;
            inner[1][c] = rate[c];
        }
        for j in 0..self.rungs() {
            let counts = self.rung_counts_in[j];
            for c in 0..W {
                let mu = s.rung_probability[j].0[c];
                let (x, a) = (mu * s.rung[j].mean[0].0[c], mu * s.rung[j].mean[1].0[c]);
                rate[c] += x;
                acceleration[c] += a;
                inner[0][c] += counts * mu;
                inner[1][c] += counts * x;
                inner[2][c] += counts * a;
            }
        }
        for j in 0..self.oscillators() {
            for c in 0..W {
                let mu = s.oscillator_probability[j].0[c];
                let (x, a) = (mu * s.oscillator[j].mean[0].0[c], mu * s.oscillator[j].mean[1].0[c]);
                rate[c] += x;
                acceleration[c] += a;
                inner[0][c] += mu;
                inner[1][c] += x;
                inner[2][c] += a;
            }
        }
        let spread = |mu: T, x: T, p: T, mean: T| mu * (p + (x - mean) * (x - mean));
        let mut variance = [T::ZERO; W];
        for c in 0..W {
            variance[c] = spread(s.walk_probability.0[c], s.walk[0].0[c], s.walk[1].0[c], rate[c]);
        }
        for j in 0..self.rungs() {
            for c in 0..W {
                let model = &s.rung[j];
                variance[c] +=
                    spread(s.rung_probability[j].0[c], model.mean[0].0[c], model.covariance[0].0[c], rate[c]);
            }
        }
        for j in 0..self.oscillators() {
            for c in 0..W {
                let model = &s.oscillator[j];
                variance[c] +=
                    spread(s.oscillator_probability[j].0[c], model.mean[0].0[c], model.covariance[0].0[c], rate[c]);
            }
        }
        for c in 0..W {
            s.fused.set_lane(c, [rate[c], acceleration[c], variance[c]]);
            let inverse = T::ONE / inner[0][c];
            let motion = s.motion.lane(c);
            let followed = motion.follow(&self.memory, inner[1][c] * inverse, inner[2][c] * inverse, pace.elapsed);
            s.motion.set_lane(c, followed.or_else(ORDINARY || s.silent.0[c] <= longest, &motion));
        }
    }

    /// Tells the observer what every model did in the first channel.
    #[inline(always)]
    fn show<const W: usize, O: Observer<T>>(
        &self,
        s: &Wide<T, W>,
        used: &[bool; W],
        weights: &Weights<T, W>,
        observer: &mut O,
    ) {
        let mut tell = |index: usize, m: usize, probability: T, alpha: T, rate: T| {
            let innovation = T::select(used[0], weights.innovation[m][0], T::of(f64::NAN));
            let innovation_variance = weights.variance[m][0];
            observer
                .model(index, ModelTrace { probability, innovation, innovation_variance, fading: T::ONE, alpha, rate });
        };
        tell(0, 0, s.walk_probability.0[0], T::ZERO, s.walk[0].0[0]);
        for j in 0..self.rungs() {
            let alpha = T::of(super::ms_imm_ikf::RUNG_ALPHA);
            tell(1 + j, 1 + j, s.rung_probability[j].0[0], alpha, s.rung[j].mean[0].0[0]);
        }
        for j in 0..self.oscillators() {
            let rate = s.oscillator[j].mean[0].0[0];
            tell(1 + self.rungs() + j, 1 + RUNGS + j, s.oscillator_probability[j].0[0], T::ZERO, rate);
        }
    }
}

/// Component `k` of the predicted mean: (z, 0, 0, 0) at the first sample.
#[inline(always)]
fn first_mean<T: Real>(first: bool, value: T, predicted: T, k: usize) -> T {
    T::select(first, T::select(k == 0, value, T::ZERO), predicted)
}
