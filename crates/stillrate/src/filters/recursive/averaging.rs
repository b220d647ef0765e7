//! Filters that are a weighted mean of all samples and differ only in their law of forgetting.
//!
//! An implementation says what the past loses before a sample and what variances follow from that; the step, and its
//! short form for a settled gain (`glide.rs`), are the same for all.

use crate::filter::{Checked, Estimate, Observer, Sample};
use crate::filters::recursive::level::{LevelState, Seen};
use crate::filters::recursive::paced::{Paced, step_paced};
use crate::glide::{self, Glide};
use crate::real::Real;
use crate::reals::Lane;

/// A law of forgetting; whoever has one is a [`Filter`](crate::Filter).
pub(crate) trait Averaging: Copy + Send + Sync {
    /// What its numbers are.
    type Number: Real;
    /// The figures that every law needs.
    fn sensor(&self) -> Sensor<Self::Number>;
    /// What one nominal period takes off the weight.
    fn nominal_loss(&self, state: &LevelState<Self::Number>) -> Self::Number;
    /// What the time before a sample does; with `NOMINAL` it is one nominal period.
    fn forget<const NOMINAL: bool>(
        &self,
        state: &LevelState<Self::Number>,
        checked: &Checked<Self::Number>,
    ) -> Forgotten<Self::Number>;
    /// Variance of the mean.
    fn variance(&self, state: &LevelState<Self::Number>) -> Self::Number;
}

/// What is being averaged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sensor<T> {
    /// Nominal sample period, s.
    pub(crate) period_s: T,
    /// Variance of one sample.
    pub(crate) sample_variance: T,
    /// Values beyond this magnitude count as missing.
    pub(crate) limit: T,
}

/// What the time before a sample did.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Forgotten<T> {
    /// Share of the weight that was lost; 0 where no time passed.
    pub(crate) loss: T,
    /// Variance of the prediction over that of one sample.
    pub(crate) variance_ratio: T,
}

impl<T: Real, F: Averaging<Number = T>> Paced for F {
    type Number = T;
    type State = LevelState<T>;

    fn begin(&self) -> LevelState<T> {
        LevelState::start()
    }

    fn nominal_s(&self) -> T {
        self.sensor().period_s
    }

    #[inline(always)]
    fn follow<const NOMINAL: bool, O: Observer<T>>(
        &self,
        state: &mut LevelState<T>,
        sample: Sample<T>,
        observer: &mut O,
    ) -> Estimate<T> {
        let Sensor { period_s, sample_variance, limit } = self.sensor();
        let checked = sample.check(limit, period_s);
        let Forgotten { loss, variance_ratio } = self.forget::<NOMINAL>(state, &checked);
        let seen = Seen {
            present: checked.present,
            innovation: checked.value - state.level,
            innovation_variance: sample_variance * (T::ONE + variance_ratio),
            forgetting_factor: T::ONE - loss,
        };
        state.weigh(loss, checked.present);
        state.correct(checked.value, checked.present);
        seen.tell(observer, state.level);
        state.estimate(self.variance(state), &checked)
    }

    #[inline(always)]
    fn follow_tile<const W: usize>(&self, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
        glide::tile(self, lanes, tile, dt);
    }
}

impl<T: Real, F: Averaging<Number = T>> Glide<T> for F {
    type Wide<const W: usize> = LevelState<Lane<T, W>>;

    #[inline(always)]
    fn runs(&self, state: &LevelState<T>) -> bool {
        state.settled(self.nominal_loss(state))
    }
    #[inline(always)]
    fn limit(&self) -> T {
        self.sensor().limit
    }
    #[inline(always)]
    fn glide(&self, state: &mut LevelState<T>, value: T) -> T {
        state.glide(value)
    }
    #[inline(always)]
    fn margin(&self, state: &LevelState<T>) -> T {
        glide::margin(state.level)
    }
    #[inline(always)]
    fn full<const W: usize>(&self, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
        step_paced(self, lanes, tile, dt);
    }
}
