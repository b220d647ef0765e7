//! State of the recommended bank, and what follows from the length of a step.

use super::{MsImmIkf, OSCILLATORS, RUNG_ALPHA, RUNGS};
use crate::adaptive::manoeuvre_frequency::MotionMoments;
use crate::gaussian::{Gaussian2, Gaussian4};
use crate::models::SingerCoefficients;
use crate::models::oscillator::OscillatorStep;
use crate::plain;
use crate::real::Real;
use crate::reals;
use crate::reals::Lane;

plain! {
    /// What follows from the length of a step alone; a filter holds that of its nominal period.
    ///
    /// # Example
    /// ```
    /// use stillrate::{GyroNoise, Settings, filters::MsImmIkfSettings};
    /// let noise = GyroNoise::from_density_two_sided(0.015);
    /// let pace = MsImmIkfSettings::defaults(50.0, noise).build::<f64>()?.nominal;
    /// assert!(pace.elapsed == 1.0 && (pace.leave - 0.02 / 20.0).abs() < 1e-6); // 20 s in a moving model
    /// assert!((pace.leave_rest - 0.02 / 100.0).abs() < 1e-7); // 100 s at rest
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct Pace<T> {
        /// Length in periods.
        pub elapsed: T,
        /// Coefficients shared by all rungs.
        pub singer: SingerCoefficients<T>,
        /// Probability of leaving a moving model.
        pub leave: T,
        /// Probability of leaving the random walk.
        pub leave_rest: T,
        /// Variance of the random walk over the step.
        pub walk: T,
    }
}

reals! {
    /// State of [`MsImmIkf`]: moments of every model, probabilities, followed motion, oscillator coefficients.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::MsImmIkfSettings};
    /// let filter = MsImmIkfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015)).build::<f64>()?;
    /// let mut state = filter.start();
    /// for _ in 0..500 {
    ///     filter.step(&mut state, Sample { value: 0.0, dt: 0.02 });
    /// }
    /// assert!(state.walk_probability.0[0] > 0.99); // ten seconds of nothing are rest
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct MsImmIkfState {
        /// 1 once a sample has been seen.
        pub started: T,
        /// Random walk: rate and its variance.
        pub walk: [T; 2],
        /// Rungs: rate and acceleration.
        pub rung: [Gaussian2<T>; 8],
        /// Oscillators: rate and three derivatives.
        pub oscillator: [Gaussian4<T>; 6],
        /// Probability of the random walk.
        pub walk_probability: T,
        /// Probabilities of the rungs.
        pub rung_probability: [T; 8],
        /// Probabilities of the oscillators.
        pub oscillator_probability: [T; 6],
        /// Variances of second and third derivative in the models that lack them, last step.
        pub lacking: [T; 2],
        /// The same for the coming steps.
        pub lacking_next: [T; 2],
        /// Fused rate, acceleration and variance of the rate.
        pub fused: [T; 3],
        /// Followed motion.
        pub motion: MotionMoments<T>,
        /// Coefficients of the oscillators.
        pub step: OscillatorStep<T>,
        /// Samples until they are renewed.
        pub renew_in: T,
        /// Step length they were made for, in periods.
        pub made_for: T,
        /// Periods since the last sample that was used.
        pub silent: T,
    }
}

pub(crate) type Wide<T, const W: usize> = MsImmIkfState<Lane<T, W>>;

impl<T: Real> Pace<T> {
    pub(crate) const ZERO: Self = Self {
        elapsed: T::ZERO,
        singer: SingerCoefficients { r: T::ZERO, s: T::ZERO, q11: T::ZERO, q12: T::ZERO, q22: T::ZERO },
        leave: T::ZERO,
        leave_rest: T::ZERO,
        walk: T::ZERO,
    };
}

impl<T: Real> MsImmIkf<T> {
    /// Coefficients for a step of `elapsed` periods.
    pub(crate) fn pace(&self, elapsed: T) -> Pace<T> {
        let leave = |dwell: T| -(-elapsed / dwell).exponential_less_one();
        Pace {
            elapsed,
            singer: SingerCoefficients::new(T::of(RUNG_ALPHA) * self.period_s, elapsed),
            leave: leave(self.dwell_periods),
            leave_rest: leave(self.rest_dwell_periods),
            walk: self.walk_variance * elapsed,
        }
    }

    pub(super) fn start_wide<const W: usize>(&self) -> Wide<T, W> {
        let all = |value: T| Lane([value; W]);
        let zero = all(T::ZERO);
        let (r, v1, [v2, v3]) = (self.measurement_variance, self.missing_acceleration, self.start_variance);
        let mut covariance = [zero; 10];
        (covariance[0], covariance[4], covariance[7], covariance[9]) = (all(r), all(v1), all(v2), all(v3));
        let even = all(T::ONE / T::of((1 + self.rungs() + self.oscillators()) as f64));
        MsImmIkfState {
            started: zero,
            walk: [zero, all(r)],
            rung: [Gaussian2 { mean: [zero; 2], covariance: [all(r), zero, all(v1)] }; RUNGS],
            oscillator: [Gaussian4 { mean: [zero; 4], covariance }; OSCILLATORS],
            walk_probability: even,
            rung_probability: [even; RUNGS],
            oscillator_probability: [even; OSCILLATORS],
            lacking: [all(v2), all(v3)],
            lacking_next: [zero; 2],
            fused: [zero, zero, all(r)],
            motion: MotionMoments {
                mean_rate: zero,
                rate_square: zero,
                acceleration_square: zero,
                acceleration_square_slow: zero,
                angle: all(self.start_angle),
            },
            step: OscillatorStep {
                from_rate: [zero; 4],
                from_acceleration: [zero; 4],
                response: [zero; 5],
                noise: [zero; 10],
            },
            renew_in: zero,
            made_for: zero,
            silent: zero,
        }
    }
}
