//! Mix and predict: what every model takes over from the others, and its motion over a step.
//!
//! With one dwell time a model the transition matrix has equal entries beside its diagonal, so the mixed moments of all targets come from
//! common sums over the sources, to which a target adds its own share again.

use super::MsImmIkf;
use super::state::{Pace, Wide};
use crate::gaussian::Gaussian2;
use crate::imm::{Sums2, Sums4};
use crate::kalman::{predict_oscillator, predict_singer, sound2, sound4};
use crate::models::oscillator::OscillatorStep;
use crate::real::Real;
use crate::reals::{Lane, Lanes};

/// Factor of the mean square acceleration in the variances of lacking derivatives.
const LACKING_FACTOR: f64 = 2.0;

/// What every target of the mixing needs to know about the last posterior.
pub(super) struct Sources<T, const W: usize> {
    /// Fused mean: the centre of all sums.
    centre: [Lane<T, W>; 4],
    /// All sources, as targets without an oscillation see them.
    plain: Sums2<Lane<T, W>>,
    /// All sources, as oscillators see them.
    widened: Sums4<Lane<T, W>>,
}

impl<T: Real> MsImmIkf<T> {
    /// Renews the oscillators' coefficients from the followed motion in every channel where they are due.
    #[inline(always)]
    pub(super) fn renew<const W: usize>(&self, s: &mut Wide<T, W>, elapsed: T) {
        let share = self.noise_share;
        for c in 0..W {
            let due = (s.renew_in.0[c] <= T::ZERO) | (s.made_for.0[c] != elapsed);
            let angle = s.motion.angle.0[c];
            let square = angle * angle;
            let fourth = square * square;
            // Quadrature is made for up to a quarter turn; a longer step forgets the phase.
            let phase_known = (elapsed <= T::ONE) | (angle * elapsed <= self.memory.angle_max);
            let mut step = OscillatorStep::new(angle, elapsed).unless_forgotten(phase_known);
            for noise in &mut step.noise {
                *noise *= fourth;
            }
            s.step.set_lane(c, step.or_else(due, &s.step.lane(c)));
            let motion = T::of(LACKING_FACTOR) * s.motion.acceleration_square.0[c];
            let lacking = [square * motion + share * fourth, fourth * motion + share * fourth * square];
            for k in 0..2 {
                s.lacking_next[k].0[c] = T::select(due, lacking[k], s.lacking_next[k].0[c]);
            }
            s.renew_in.0[c] = T::select(due, self.refresh_samples, s.renew_in.0[c]);
            s.made_for.0[c] = T::select(due, elapsed, s.made_for.0[c]);
        }
    }

    #[inline(always)]
    pub(super) fn gather_sources<const W: usize>(&self, s: &Wide<T, W>, pace: &Pace<T>) -> Sources<T, W> {
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
    pub(super) fn mix_and_predict<const W: usize>(&self, s: &mut Wide<T, W>, sources: &Sources<T, W>, pace: &Pace<T>) {
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
}
