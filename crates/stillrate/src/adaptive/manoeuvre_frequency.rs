//! Manoeuvre frequency: the ratio of the signal's acceleration to its amplitude, followed with finite memory.
//!
//! With the fused rate x and acceleration a (wide rungs left out), mx follows x at half the pace, m0 the variance about it, m1 and m1r
//! the mean square acceleration with the memory of the prior variances and of the frequency; omega = sqrt(m1r / m0).

use crate::plain;
use crate::real::Real;
use crate::reals;

reals! {
    /// Moments of the fused motion, in periods.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::MsImmIkfSettings, reals::Lanes};
    /// let filter = MsImmIkfSettings::defaults(100.0, GyroNoise::from_density_two_sided(0.015)).build::<f64>()?;
    /// let mut state = filter.start();
    /// for k in 0..2000 {
    ///     filter.step(&mut state, Sample { value: 20.0 * (0.18 * f64::from(k)).sin(), dt: 0.01 });
    /// }
    /// let motion = state.motion.lane(0);
    /// assert!((motion.angle - 0.18).abs() < 0.005); // 18 rad/s at 100 Hz
    /// assert!((motion.rate_square / (20.0 * 20.0 / 2.0) - 1.0).abs() < 0.1);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
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
    ///
    /// # Example
    /// ```
    /// use stillrate::{GyroNoise, Settings, filters::MsImmIkfSettings};
    /// let settings = MsImmIkfSettings { frequency_memory_s: 5.0, ..Settings::defaults(50.0, GyroNoise::from_density_two_sided(0.015)) };
    /// let memory = settings.build::<f64>()?.memory;
    /// assert_eq!(memory.frequency_periods, 250.0);
    /// assert_eq!(memory.angle_max, core::f64::consts::FRAC_PI_2); // a quarter of the sample rate
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
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
