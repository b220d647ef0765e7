//! The step of [`SingerImmKf`] for small processors: the same operations in the same order, hence the same bits, as the
//! form that becomes vector instructions, but with branches instead of selects and one copy of what both models do.
//!
//! On a Cortex-M4F it takes half of the code and of the stack; where there are wide registers it would be the slower one.

use super::singer_imm_kf::{SingerImmKf, SingerImmKfState};
use super::singer_imm_model::SingerImmModel;
use crate::filter::{Estimate, Flags, Sample};
use crate::gaussian::Gaussian2;
use crate::imm::{mix2, normalised, prior2, shares};
use crate::kalman::{Reading, mix_ahead, update2};
use crate::models::SingerCoefficients;
use crate::real::Real;

impl<T: Real> SingerImmKf<T> {
    /// One sample.
    #[inline]
    pub(super) fn compact(&self, state: &mut SingerImmKfState<T>, sample: Sample<T>) -> Estimate<T> {
        let mut seen = [T::ZERO; 2];
        let mut flags = self.look(sample, &mut seen);
        let [value, unusual] = seen;
        let (present, restart) = (value.finite(), flags.has(Flags::RESTARTED));
        if restart && !present {
            state.started = T::ZERO;
        }
        if present && (restart || state.started == T::ZERO) {
            self.begin(state, value);
        }
        if state.started == T::ZERO {
            flags = flags.with(Flags::NO_DATA_YET);
        } else if !flags.has(Flags::BAD_TIME) {
            let share = self.meet(&mut state.weight);
            let [rest, motion] = &mut state.model;
            let (before, mut room) = (*rest, self.model[0].step);
            let step = self.model[0].over_unless_usual(unusual, &mut room);
            ahead(share[0], true, rest, motion, step);
            let step = self.model[1].over_unless_usual(unusual, &mut room);
            ahead(share[1], false, motion, &before, step);
            let [w_rest, w_motion] = &mut state.weight;
            let exponent = carry(rest, w_rest, value, self.model[0].measurement_variance);
            let rise = carry(motion, w_motion, value, self.model[1].measurement_variance) - exponent;
            *w_motion *= rise.doubling();
        }
        let [first, _] = normalised(&state.weight);
        let fused = mix2(first, &state.model[0], &state.model[1]);
        Estimate { rate: fused.mean[0], acceleration: fused.mean[1], variance: fused.covariance[0], flags }
    }

    /// The sample's flags. `seen` becomes its value, NaN where there is no usable one, and the time step where it isn't the usual one,
    /// else 0. A function of its own: in memory the two take less stack over all calls of the step than in registers.
    #[inline(never)]
    fn look(&self, sample: Sample<T>, seen: &mut [T; 2]) -> Flags {
        let checked = sample.check(self.limit, self.period_s);
        let dt = T::select(checked.restart, self.period_s, checked.dt);
        let value = T::select(checked.present, sample.value, T::of(f64::NAN));
        *seen = [value, T::select(dt == self.period_s, T::ZERO, dt)];
        checked.flags
    }

    /// The shares of the first model in both mixtures; leaves the probabilities before the sample.
    #[inline(never)]
    fn meet(&self, weight: &mut [T; 2]) -> [T; 2] {
        let [first, second] = self.leave;
        let transition = [[T::ONE - first, first], [second, T::ONE - second]];
        let share = shares(&transition, weight);
        *weight = prior2(&transition, &normalised(weight));
        share
    }

    /// Starts from a sample.
    #[inline(never)]
    fn begin(&self, state: &mut SingerImmKfState<T>, value: T) {
        for (own, model) in state.model.iter_mut().zip(&self.model) {
            own.mean = [value, T::ZERO];
            own.covariance = [model.start_variance[0], T::ZERO, model.start_variance[1]];
        }
        state.weight = [self.start_probability, T::ONE - self.start_probability];
        state.started = T::ONE;
    }
}

impl<T: Real> SingerImmModel<T> {
    /// The coefficients of an unusual time step, computed into `room`, or the usual ones where it is 0.
    #[inline(never)]
    fn over_unless_usual<'a>(&'a self, unusual: T, room: &'a mut SingerCoefficients<T>) -> &'a SingerCoefficients<T> {
        if unusual == T::ZERO {
            return &self.step;
        }
        *room = self.over(unusual);
        room
    }
}

/// Replaces a model by what is predicted from its mixture with another; `share` is that of the first of the pair, and which of the
/// two comes first in the sums doesn't change a bit.
#[inline(never)]
fn ahead<T: Real>(share: T, first: bool, own: &mut Gaussian2<T>, other: &Gaussian2<T>, step: &SingerCoefficients<T>) {
    let rest = T::ONE - share;
    let weight = if first { [share, rest] } else { [rest, share] };
    *own = mix_ahead(weight, own, other, step);
}

/// Updates one model with a value that is not NaN, in place. Multiplies its weight by the likelihood's factor and gives its exponent.
#[inline(never)]
fn carry<T: Real>(own: &mut Gaussian2<T>, weight: &mut T, value: T, variance: T) -> T {
    let mut exponent = T::ZERO;
    if value.finite() {
        let (updated, evidence) = update2(own, &Reading::plain(value, variance));
        *own = updated;
        *weight *= evidence.factor;
        exponent = evidence.exponent;
    }
    own.mean = own.mean.map(Real::flushed);
    exponent
}

#[cfg(test)]
mod tests {
    use crate::filters::SingerImmKfSettings;
    use crate::{Filter, GyroNoise, Real, Sample, Settings};

    fn gives_the_bits_of_the_wide_form<T: Real>(rate_hz: f64) {
        let filter =
            SingerImmKfSettings::defaults(rate_hz, GyroNoise::from_density_two_sided(0.015)).build::<T>().unwrap();
        let (mut compact, mut wide) = (filter.start(), filter.start());
        let odd = [f64::NAN, f64::INFINITY, 1e30, -1e30, 1e9, 0.0, -0.0, 1e-310];
        let period = 1.0 / rate_hz;
        let steps = [0.0, -period, f64::NAN, f64::INFINITY, 1e-9 * period, 2.5 * period, 9.0, 11.0, 1e9, 1e30];
        let mut bits = 1_u64;
        for k in 0..20_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let dice = (bits >> 40) as usize;
            let moving = if k % 3000 > 1500 { 30.0 * (0.1 * f64::from(k)).sine_cosine().0 } else { 0.0 };
            let noise = (bits >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
            let value = if dice.is_multiple_of(13) { odd[(dice / 13) % odd.len()] } else { moving + noise };
            let dt = if dice.is_multiple_of(11) { steps[(dice / 11) % steps.len()] } else { period };
            let sample = Sample { value: T::of(value), dt: T::of(dt) };
            let (ours, theirs) = (filter.compact(&mut compact, sample), filter.observe(&mut wide, sample, &mut ()));
            assert_eq!((ours, compact), (theirs, wide), "sample {k}: {sample:?}");
        }
    }

    #[test]
    fn compact_and_wide_form_give_the_same_bits() {
        for rate_hz in [0.2, 50.0, 8000.0] {
            gives_the_bits_of_the_wide_form::<f32>(rate_hz);
            gives_the_bits_of_the_wide_form::<f64>(rate_hz);
        }
    }
}
