//! All that is not ordinary: a missing, absurd or saturated sample, the first one, a long silence, a lost or a foreign state.

use super::MsImmIkf;
use super::state::{MsImmIkfState, Pace, Wide};
use crate::filter::{Checked, Flags, LONGEST_GAP_S, Observer, Sample};
use crate::real::Real;
use crate::reals::{Lane, Lanes, Reals};
use crate::sound::{at_most, finite, flag, mean, probabilities, variance, within};

/// A row of samples, sorted.
pub(super) struct Readings<T, const W: usize> {
    pub(super) value: [T; W],
    /// Whether the sample is to be used.
    pub(super) used: [bool; W],
    /// Whether it is the first.
    pub(super) first: [bool; W],
    pub(super) flags: [Flags; W],
}

impl<T: Real, const W: usize> Readings<T, W> {
    /// A row in which every channel has a usable sample and none is the first.
    #[inline(always)]
    pub(super) fn ordinary(value: &[T; W]) -> Self {
        Self { value: *value, used: [true; W], first: [false; W], flags: [Flags::NONE; W] }
    }

    /// Any row.
    #[inline(always)]
    pub(super) fn checked(checked: &[Checked<T>; W], started: &Lane<T, W>) -> Self {
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
    /// A row in which something needs care: a missing, absurd or saturated sample, the first one, or outliers expected.
    #[cold]
    #[inline(never)]
    pub(super) fn cycle_with_care<const W: usize, O: Observer<T>>(
        &self,
        s: &mut Wide<T, W>,
        z: &[T; W],
        dt: T,
        pace: &Pace<T>,
        observer: &mut O,
    ) -> [Flags; W] {
        let checked = z.map(|value| Sample { value, dt }.check(self.limit, self.period_s));
        self.cycle::<false, W, O>(s, &Readings::checked(&checked, &s.started), pace, observer)
    }

    /// Counts the silence of every channel, and forgets those that have been silent for as long as the longest gap:
    /// coasting on would end in absurd numbers.
    #[cold]
    #[inline(never)]
    pub(super) fn fall_silent<const W: usize>(&self, s: &mut Wide<T, W>, elapsed: T) -> [Flags; W] {
        let longest = T::of(LONGEST_GAP_S).most(self.period_s * T::of(3.0)) / self.period_s;
        core::array::from_fn(|c| {
            s.silent.0[c] += elapsed;
            if s.silent.0[c] <= longest {
                return Flags::NONE;
            }
            let flags = Flags::RESTARTED.when(s.started.0[c] != T::ZERO);
            s.set_lane(c, self.start_wide::<1>().lane(0));
            flags
        })
    }

    /// Whether a fused estimate is one: finite, and so far within the numbers that it can be squared or divided by a period.
    #[inline(always)]
    pub(super) fn holds([rate, acceleration, variance]: &[T; 3]) -> bool {
        (rate.magnitude() <= T::LARGEST.root()) & (acceleration.magnitude() <= T::LARGEST.root()) & variance.finite()
    }

    /// Starts channels anew that have lost their state.
    #[cold]
    #[inline(never)]
    pub(super) fn recover<const W: usize>(&self, s: &mut Wide<T, W>, flags: &mut [Flags; W]) {
        let fresh = self.start_wide::<W>();
        for c in 0..W {
            if !Self::holds(&s.fused.lane(c)) {
                s.set_lane(c, fresh.lane(c));
                flags[c] = flags[c].with(Flags::DIVERGED);
            }
        }
    }

    /// A sample at the rail only says "at least this much": where the prediction lies beyond it, it says nothing.
    #[inline(always)]
    pub(super) fn skip_beyond_the_rail<const W: usize>(
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
