//! The step of [`SingerImmKf`] for small processors: the same operations in the same order, hence the same bits, as the
//! form that becomes vector instructions, but with branches instead of selects and one copy of what both models do.
//!
//! On a Cortex-M4F it takes half of the code and of the stack; where there are wide registers it would be the slower one.

use super::singer_imm_kf::{SingerImmKf, SingerImmKfState, SingerImmModel};
use crate::filter::{Estimate, Flags, Sample};
use crate::gaussian::Gaussian2;
use crate::imm::{interact, mix2, weigh2};
use crate::kalman::{Reading, predict_singer, update2};
use crate::real::Real;

impl<T: Real> SingerImmKf<T> {
    /// One sample.
    #[inline]
    pub(super) fn compact(&self, state: &mut SingerImmKfState<T>, sample: Sample<T>) -> Estimate<T> {
        let checked = sample.check(self.limit, self.period_s);
        state.started = checked.known(state.started);
        if checked.present && (state.started == T::ZERO || checked.restart) {
            self.begin(state, checked.value);
        }
        let started = state.started != T::ZERO;
        if checked.moves && started {
            let [first, second] = self.leave;
            let transition = [[T::ONE - first, first], [second, T::ONE - second]];
            let (prior, weight) = interact(&transition, &state.probability);
            let rest = mixed(weight[0], &state.model);
            state.model[1] = mixed(weight[1], &state.model);
            state.model[0] = rest;
            let dt = T::select(checked.restart, self.period_s, checked.dt);
            let value = checked.present.then_some(checked.value);
            let (exponent_0, factor_0) = self.model[0].carry(&mut state.model[0], dt, self.period_s, value);
            let (exponent_1, factor_1) = self.model[1].carry(&mut state.model[1], dt, self.period_s, value);
            let (exponent, factor) = ([exponent_0, exponent_1], [factor_0, factor_1]);
            state.probability = weigh2(&prior, &exponent, &factor, checked.present).map(Real::flushed);
        }
        let fused = mixed(state.probability[0], &state.model);
        Estimate {
            rate: fused.mean[0],
            acceleration: fused.mean[1],
            variance: fused.covariance[0],
            flags: checked.flags.with(Flags::NO_DATA_YET.when(!started)),
        }
    }

    /// Starts from a sample.
    #[inline(never)]
    fn begin(&self, state: &mut SingerImmKfState<T>, value: T) {
        for (own, model) in state.model.iter_mut().zip(&self.model) {
            own.mean = [value, T::ZERO];
            own.covariance = [model.start_variance[0], T::ZERO, model.start_variance[1]];
        }
        state.probability = [self.start_probability, T::ONE - self.start_probability];
        state.started = T::ONE;
    }
}

impl<T: Real> SingerImmModel<T> {
    /// Predicts and updates one model in place; the evidence of the sample, if there is one.
    #[inline(never)]
    fn carry(&self, own: &mut Gaussian2<T>, dt: T, period_s: T, value: Option<T>) -> (T, T) {
        let unusual;
        let step = if dt == period_s {
            &self.step
        } else {
            unusual = self.over(dt);
            &unusual
        };
        *own = predict_singer(own, step, T::ONE);
        let mut said = (T::ZERO, T::ONE);
        if let Some(value) = value {
            let (updated, evidence) = update2(own, &Reading::plain(value, self.measurement_variance));
            *own = updated;
            said = (evidence.exponent, evidence.factor);
        }
        own.mean = own.mean.map(Real::flushed);
        said
    }
}

/// Mixture of both models, the first with weight `w`.
#[inline(never)]
fn mixed<T: Real>(w: T, models: &[Gaussian2<T>; 2]) -> Gaussian2<T> {
    mix2(w, &models[0], &models[1])
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
            let moving = if k % 3000 > 1500 { 30.0 * (0.1 * k as f64).sine_cosine().0 } else { 0.0 };
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
