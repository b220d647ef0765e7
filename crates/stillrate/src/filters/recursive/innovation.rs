//! An innovation by the yardstick of the noise: what the filters look at that forget when they see motion.
//!
//! e = x - prediction, over sigma sqrt(1 + K) with K the gain of the sample before: white with variance 1 at rest.

use crate::filter::{Checked, Observer};
use crate::filters::recursive::level::Seen;
use crate::real::Real;

/// The innovation of one sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Innovation<T> {
    present: bool,
    value: T,
    /// Its standard deviation at rest.
    scale: T,
}

impl<T: Real> Innovation<T> {
    /// Of a sample against its prediction, for noise of standard deviation `sigma` and the gain before.
    #[inline(always)]
    pub(crate) fn new(checked: &Checked<T>, predicted: T, sigma: T, gain: T) -> Self {
        let scale = (T::ONE + gain).root() * sigma;
        Self { present: checked.present, value: checked.value - predicted, scale }
    }

    /// In its own standard deviations.
    #[inline(always)]
    pub(crate) fn scaled(&self) -> T {
        self.value / self.scale
    }

    /// Tells an observer what happened, where it listens.
    #[inline(always)]
    pub(crate) fn tell<O: Observer<T>>(&self, observer: &mut O, forgetting_factor: T, rate: T) {
        let innovation_variance = self.scale * self.scale;
        let seen = Seen { present: self.present, innovation: self.value, innovation_variance, forgetting_factor };
        seen.tell(observer, rate);
    }
}
