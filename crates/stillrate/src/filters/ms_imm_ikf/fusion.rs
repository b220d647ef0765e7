//! Fuse and follow: the mixture's mean and variance, and the manoeuvre frequency that follows it.

use super::state::{Pace, Wide};
use super::weighing::Weights;
use super::{MsImmIkf, RUNG_ALPHA, RUNGS};
use crate::filter::{ModelTrace, Observer};
use crate::real::Real;
use crate::reals::Lanes;

/// In a longer dropout the bank's own prediction teaches it nothing more about the motion: an oscillator that learns its
/// frequency from itself runs away exponentially. The longer of a time in seconds and a number of samples.
const LONGEST_ECHO_S: f64 = 0.5;
const LONGEST_ECHO_SAMPLES: f64 = 20.0;

impl<T: Real> MsImmIkf<T> {
    /// Mean and variance of the mixture; then the frequency follows it, wide rungs left out.
    #[inline(always)]
    pub(super) fn fuse_and_follow<const ORDINARY: bool, const W: usize>(&self, s: &mut Wide<T, W>, pace: &Pace<T>) {
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
    pub(super) fn show<const W: usize, O: Observer<T>>(
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
            let alpha = T::of(RUNG_ALPHA);
            tell(1 + j, 1 + j, s.rung_probability[j].0[0], alpha, s.rung[j].mean[0].0[0]);
        }
        for j in 0..self.oscillators() {
            let rate = s.oscillator[j].mean[0].0[0];
            tell(1 + self.rungs() + j, 1 + RUNGS + j, s.oscillator_probability[j].0[0], T::ZERO, rate);
        }
    }
}
