//! A level that may wander: the weighted mean of all samples so far, and its two gain laws.
//!
//! With S the weight of everything seen and K = 1/S the gain, a sample x does
//! S <- (1 - loss) S + 1, w <- w + (x - w) / S. What differs is the loss of old weight in one period:
//!
//! * recursive least squares ("HMM/RLS"): loss = 1 - lambda, hence K(n) = (1 - lambda)/(1 - lambda^n). In the usual form
//!   this is P <- P/(lambda + P). `Erratum:` the source prints P <- (1/lambda)(P + P^2/(lambda + P)) (DOI 10.7690/bgzdh.2019.03.009); with that
//!   plus the gain grows without bound, with a minus it is the same as here.
//! * random-walk Kalman filter ("HMM/KF") with q = Q/R: loss = q S/(1 + q S), that is 1/S <- 1/S + q before the sample.
//!
//! S is summed with a compensation term: an `f32` gain is then right to 1e-6 even for lambda = 1 after ten million samples, where the
//! usual form is 17 % off. A missing sample loses weight and adds none; the output holds.

use crate::filter::{Checked, Estimate, Flags, ModelTrace, Observer};
use crate::real::Real;
use crate::reals;
use crate::sound;

reals! {
    /// State of a weighted mean.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::RandomWalkKfSettings};
    /// let noise = GyroNoise::from_density_two_sided(0.01);
    /// let settings = RandomWalkKfSettings { variance_ratio: 0.0, ..RandomWalkKfSettings::defaults(200.0, noise) }; // a constant
    /// let filter = settings.build::<f64>()?;
    /// let mut state = filter.start();
    /// for value in [1.0, 2.0, 6.0] {
    ///     filter.step(&mut state, Sample { value, dt: 0.005 });
    /// }
    /// assert_eq!((state.level, state.weight), (3.0, 3.0)); // the mean of three samples
    /// assert!((state.noise_gain - 1.0 / 3.0).abs() < 1e-15);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct LevelState {
        /// The mean.
        pub level: T,
        /// Weight S of all samples so far, in samples; its reciprocal is the gain. 0 before the first.
        pub weight: T,
        /// What rounding took from the weight.
        pub weight_low: T,
        /// Variance of the mean over that of one sample, for a constant rate in white noise.
        pub noise_gain: T,
    }
}

impl<T: Real> LevelState<T> {
    /// Before the first sample.
    pub(crate) fn start() -> Self {
        Self { level: T::ZERO, weight: T::ZERO, weight_low: T::ZERO, noise_gain: T::ZERO }
    }
    /// Whether nothing has been seen yet.
    #[inline(always)]
    pub(crate) fn empty(&self) -> bool {
        self.weight == T::ZERO
    }

    /// Whether steps can have left this behind where readings are at most `limit`.
    pub(crate) fn sound(&self, limit: T) -> bool {
        let weight = self.weight == T::ZERO || sound::within(self.weight, T::TINY.root(), T::of(1e18));
        sound::at_most(self.level, T::TWO * limit)
            && weight
            && sound::at_most(self.weight_low, self.weight.least(T::ONE))
            && sound::within(self.noise_gain, T::ZERO, T::of(1.001))
    }

    /// S <- (1 - loss) S, plus 1 where a sample is present; keeps the rounding error for the next time.
    #[inline(always)]
    pub(crate) fn weigh(&mut self, loss: T, present: bool) {
        let old = self.weight;
        let added = T::select(present, T::ONE, T::ZERO);
        let change = added - loss * old + (self.weight_low - loss * self.weight_low);
        let sum = old + change;
        let low = (old - sum) + change;
        // In the steady state it dies away; what can no longer reach the weight (at least 1) is dropped, so that the pair comes to rest.
        self.weight_low = T::select(low.magnitude() < T::EPSILON * T::EPSILON, T::ZERO, low);
        // After an endless gap almost nothing is left, but a filter that has seen data never becomes an empty one. (The root: a
        // variance over this weight is still a number.)
        self.weight = T::select(old > T::ZERO, sum.most(T::TINY.root()), sum);
    }

    /// w <- w + (x - w) / S; without a sample nothing moves. Returns the gain that was used.
    #[inline(always)]
    pub(crate) fn correct(&mut self, value: T, present: bool) -> T {
        let gain = T::select(present, T::ONE / self.weight, T::ZERO);
        self.move_by(gain, value);
        self.level = self.level.flushed();
        gain
    }

    /// [`LevelState::weigh`] and [`LevelState::correct`] where the weight is settled; a level that decays is not flushed. Returns it.
    #[inline(always)]
    pub(crate) fn glide(&mut self, value: T) -> T {
        self.move_by(T::ONE / self.weight, value);
        self.level
    }

    #[inline(always)]
    fn move_by(&mut self, gain: T, value: T) {
        self.level = self.level + gain * (value - self.level);
        let rest = T::ONE - gain;
        self.noise_gain = rest * rest * self.noise_gain + gain * gain;
    }

    /// Whether a further sample at this loss would leave weight and gain as they are, to the last bit: so it is after 40 to 80 memories.
    #[inline(always)]
    pub(crate) fn settled(&self, loss: T) -> bool {
        let mut next = *self;
        next.weigh(loss, true);
        (self.weight > T::ZERO) & (next.weight == self.weight) & (next.weight_low == self.weight_low)
    }

    /// The estimate after a sample.
    #[inline(always)]
    pub(crate) fn estimate(&self, variance: T, checked: &Checked<T>) -> Estimate<T> {
        Estimate {
            rate: self.level,
            acceleration: T::ZERO,
            variance,
            // A weighted mean bridges a gap of any length by itself; it has nothing to start anew.
            flags: Flags(checked.flags.0 & !Flags::RESTARTED.0).with(Flags::NO_DATA_YET.when(self.empty())),
        }
    }
}

/// What one step saw, for an observer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen<T> {
    pub(crate) present: bool,
    pub(crate) innovation: T,
    pub(crate) innovation_variance: T,
    pub(crate) forgetting_factor: T,
}

impl<T: Real> Seen<T> {
    /// Tells an observer, where it listens, of this and of the rate after it.
    #[inline(always)]
    pub(crate) fn tell<O: Observer<T>>(&self, observer: &mut O, rate: T) {
        observer.model(
            0,
            ModelTrace {
                probability: T::ONE,
                innovation: T::select(self.present, self.innovation, T::of(f64::NAN)),
                innovation_variance: self.innovation_variance,
                fading: self.forgetting_factor,
                alpha: T::ZERO,
                rate,
            },
        );
    }
}
