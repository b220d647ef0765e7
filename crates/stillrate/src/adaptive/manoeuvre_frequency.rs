//! Manoeuvre frequency: the ratio of the signal's acceleration to its amplitude, followed with finite memory.
//!
//! With the fused rate x and acceleration a (wide rungs left out), mx follows x at half the pace, m0 the variance about it, m1 and m1r
//! the mean square acceleration with the memory of the prior variances and of the frequency; omega = sqrt(m1r / m0).

use crate::plain;
use crate::real::Real;
use crate::reals;

reals! {
    /// Moments of the fused motion, in periods.
    pub struct MotionMoments {
        /// Slow mean of the rate.
        pub mean_rate: T,
        /// Mean square of the rate about it.
        pub rate_square: T,
        /// Mean square acceleration, memory of the prior variances.
        pub acceleration_square: T,
        /// Mean square acceleration, memory of the frequency.
        pub acceleration_square_slow: T,
        /// Angular frequency, radians a period.
        pub angle: T,
    }
}

plain! {
    /// How the moments follow, in periods.
    pub struct FrequencyMemory<T> {
        /// Memory of the frequency.
        pub frequency_periods: T,
        /// Memory of the prior variances.
        pub variance_periods: T,
        /// Smallest angular frequency, radians a period.
        pub angle_min: T,
        /// Largest angular frequency, radians a period.
        pub angle_max: T,
        /// Below this mean square rate the frequency is held.
        pub rate_square_min: T,
    }
}

impl<T: Real> MotionMoments<T> {
    /// Takes the fused rate and acceleration of one sample; `elapsed` in periods.
    #[inline(always)]
    pub(crate) fn follow(&self, memory: &FrequencyMemory<T>, rate: T, acceleration: T, elapsed: T) -> Self {
        let pace = T::ONE.least(elapsed / memory.frequency_periods);
        let variance_pace = T::ONE.least(elapsed / memory.variance_periods);
        let square = acceleration * acceleration;
        let mean_rate = (self.mean_rate + T::HALF * pace * (rate - self.mean_rate)).flushed();
        let deviation = rate - mean_rate;
        let rate_square = (self.rate_square + pace * (deviation * deviation - self.rate_square)).flushed();
        let slow = (self.acceleration_square_slow + pace * (square - self.acceleration_square_slow)).flushed();
        let fast = (self.acceleration_square + variance_pace * (square - self.acceleration_square)).flushed();
        let known = rate_square > memory.rate_square_min;
        let ratio = slow / T::select(known, rate_square, T::ONE);
        let angle = T::select(known, ratio.root().limited(memory.angle_min, memory.angle_max), self.angle);
        Self { mean_rate, rate_square, acceleration_square: fast, acceleration_square_slow: slow, angle }
    }

    /// These moments where `condition` holds, else the others.
    #[inline(always)]
    pub(crate) fn or_else(&self, condition: bool, other: &Self) -> Self {
        Self {
            mean_rate: T::select(condition, self.mean_rate, other.mean_rate),
            rate_square: T::select(condition, self.rate_square, other.rate_square),
            acceleration_square: T::select(condition, self.acceleration_square, other.acceleration_square),
            acceleration_square_slow: T::select(
                condition,
                self.acceleration_square_slow,
                other.acceleration_square_slow,
            ),
            angle: T::select(condition, self.angle, other.angle),
        }
    }
}
