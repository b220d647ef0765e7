//! What a state of the recommended bank can be.

use super::ms_imm_ikf::{MsImmIkf, MsImmIkfState, Wide};
use crate::real::Real;
use crate::reals::{Lanes, Reals};
use crate::sound::{at_most, finite, flag, mean, probabilities, variance, within};

impl<T: Real> MsImmIkf<T> {
    /// Whether steps can have left this behind.
    pub(crate) fn accepts_bank(&self, state: &Wide<T, 1>) -> bool {
        let s = state.lane(0);
        let mut all_finite = true;
        s.scatter(&mut |number: T| all_finite &= number.finite());
        let counts =
            flag(s.started) && at_most(s.renew_in, self.refresh_samples) && within(s.silent, T::ZERO, T::LARGEST);
        all_finite
            && counts
            && within(s.made_for, T::ZERO, T::LARGEST)
            && self.sound_models(&s)
            && self.sound_motion(&s)
    }

    fn sound_models(&self, s: &MsImmIkfState<T>) -> bool {
        let active = core::iter::once(s.walk_probability)
            .chain(s.rung_probability.into_iter().take(self.rungs()))
            .chain(s.oscillator_probability.into_iter().take(self.oscillators()));
        mean(s.walk[0])
            && variance(s.walk[1])
            && s.rung.iter().all(|model| finite(&model.mean, &model.covariance, &[0, 2]))
            && s.oscillator.iter().all(|model| finite(&model.mean, &model.covariance, &[0, 4, 7, 9]))
            && probabilities(active)
    }

    fn sound_motion(&self, s: &MsImmIkfState<T>) -> bool {
        let motion = &s.motion;
        let variances = [
            s.lacking[0],
            s.lacking[1],
            s.lacking_next[0],
            s.lacking_next[1],
            s.fused[2],
            motion.rate_square,
            motion.acceleration_square,
            motion.acceleration_square_slow,
        ];
        let step = &s.step;
        let coefficients =
            step.from_rate.iter().chain(&step.from_acceleration).chain(&step.response).chain(&step.noise);
        variances.into_iter().all(variance)
            && at_most(s.fused[0], T::LARGEST.root())
            && at_most(s.fused[1], T::LARGEST.root())
            && mean(motion.mean_rate)
            && within(motion.angle, self.memory.angle_min, self.memory.angle_max)
            && coefficients.into_iter().all(|&coefficient| at_most(coefficient, T::of(1e16)))
    }
}
