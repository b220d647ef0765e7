//! MS-IMM-IKF, the recommended bank: an interacting multiple model Kalman filter whose models span all bandwidths.
//!
//! One random walk (rest), a ladder of Singer models (motion of any bandwidth) and a group of double oscillators
//! (narrow-band motion) that share an on-line manoeuvre frequency. All bandwidths are relative to the noise, so
//! the filter needs no tuning besides the noise figures. The cycle is mix, predict, update, weigh, fuse (Blom and Bar-Shalom 1988);
//! then the frequency follows the fused motion. Derivatives are scaled by powers of the sample period, time by the period.
//!
//! Departures from the textbook cycle: the acceleration of other models is capped when an oscillator takes it over, the frequency
//! and the prior variances have memories of their own, and rest has a longer dwell time than motion.

use super::ms_imm_ikf_cycle::Readings;
use crate::adaptive::manoeuvre_frequency::{FrequencyMemory, MotionMoments};
use crate::block;
use crate::filter::{Estimate, Filter, Flags, LONGEST_GAP_S, Observer, Sample};
use crate::gaussian::{Gaussian2, Gaussian4};
use crate::models::SingerCoefficients;
use crate::models::oscillator::OscillatorStep;
use crate::plain;
use crate::real::Real;
use crate::reals;
use crate::reals::{Lane, Lanes};

/// Most rungs a ladder can have: up to 32 kHz.
pub const RUNGS: usize = 8;
/// Most oscillators a bank can have.
pub const OSCILLATORS: usize = 6;
/// Reciprocal time constant of the rungs, 1/s: hardly any decay, but stationary.
pub(crate) const RUNG_ALPHA: f64 = 1e-3;
/// Model probabilities never fall below this, so that a model can always come back.
pub(crate) const PROBABILITY_FLOOR: f64 = 1e-12;
/// Factor of the mean square acceleration in the variances of lacking derivatives.
const LACKING_FACTOR: f64 = 2.0;
/// Share of the noise density (a variance times a second) in those variances and in the cap, so that they never vanish.
pub(crate) const NOISE_SHARE: f64 = 1e-3;

plain! {
    /// The recommended filter; build it from [`MsImmIkfSettings`](super::MsImmIkfSettings).
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::MsImmIkfSettings};
    /// let noise = GyroNoise::from_density_two_sided(0.015).with_rate_random_walk(0.003);
    /// let filter = MsImmIkfSettings::defaults(50.0, noise).build::<f64>()?;
    /// let mut state = filter.start();
    /// let mut worst: f64 = 0.0;
    /// for k in 0..1000 {
    ///     let noise = if k % 2 == 0 { 0.1 } else { -0.1 };
    ///     let estimate = filter.step(&mut state, Sample { value: 3.0 + noise, dt: 0.02 });
    ///     if k > 500 {
    ///         worst = worst.max((estimate.rate - 3.0).abs());
    ///     }
    /// }
    /// assert!(worst < 0.01);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct MsImmIkf<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// Variance R of a sample.
        pub measurement_variance: T,
        /// Share of the noise that keeps prior variances above zero, per unit angle.
        pub noise_share: T,
        /// Values beyond this magnitude count as missing.
        pub limit: T,
        /// Variance of the random walk over a period.
        pub walk_variance: T,
        /// Variance of the acceleration that the random walk lacks.
        pub missing_acceleration: T,
        /// Variances of second and third derivative before the first sample.
        pub start_variance: [T; 2],
        /// Rungs in use.
        pub rung_count: u32,
        /// Oscillators in use.
        pub oscillator_count: u32,
        /// Process noise of each rung.
        pub rung_intensity: [T; RUNGS],
        /// 1 where a rung counts in the moments of the motion.
        pub rung_counts_in: [T; RUNGS],
        /// Process noise of each oscillator at unit angle.
        pub oscillator_intensity: [T; OSCILLATORS],
        /// Cap of 4.3a in units of the mean square acceleration.
        pub derivative_cap: T,
        /// How the moments of the motion are followed.
        pub memory: FrequencyMemory<T>,
        /// Manoeuvre frequency before anything is known, radians a period.
        pub start_angle: T,
        /// Samples between refreshes of the oscillators.
        pub refresh_samples: T,
        /// Prior probability of an outlier; 0 is off.
        pub outlier_probability: T,
        /// Full scale of the sensor.
        pub saturation: T,
        /// Dwell time of moving models in periods.
        pub dwell_periods: T,
        /// Dwell time of the random walk in periods.
        pub rest_dwell_periods: T,
        /// 1 / (number of models - 1).
        pub share: T,
        /// What follows from a step of one period.
        pub nominal: Pace<T>,
    }
}

plain! {
    /// What follows from the length of a step alone.
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
    #[inline(always)]
    pub(crate) fn rungs(&self) -> usize {
        (self.rung_count as usize).min(RUNGS)
    }

    #[inline(always)]
    pub(crate) fn oscillators(&self) -> usize {
        (self.oscillator_count as usize).min(OSCILLATORS)
    }

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

    fn start_wide<const W: usize>(&self) -> Wide<T, W> {
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

    /// Renews the oscillators' coefficients from the followed motion in every channel where they are due.
    #[inline(always)]
    fn renew<const W: usize>(&self, s: &mut Wide<T, W>, elapsed: T) {
        let share = self.noise_share;
        for c in 0..W {
            let due = (s.renew_in.0[c] <= T::ZERO) | (s.made_for.0[c] != elapsed);
            let angle = s.motion.angle.0[c];
            let square = angle * angle;
            let fourth = square * square;
            // Quadrature is made for up to a quarter turn; a longer step forgets the phase.
            let phase_known = (elapsed <= T::ONE) | (angle * elapsed <= self.memory.angle_max);
            let mut step = OscillatorStep::new(angle, elapsed).unless_forgotten(phase_known);
            for noise in &mut step.noise {
                *noise *= fourth;
            }
            s.step.set_lane(c, step.or_else(due, &s.step.lane(c)));
            let motion = T::of(LACKING_FACTOR) * s.motion.acceleration_square.0[c];
            let lacking = [square * motion + share * fourth, fourth * motion + share * fourth * square];
            for k in 0..2 {
                s.lacking_next[k].0[c] = T::select(due, lacking[k], s.lacking_next[k].0[c]);
            }
            s.renew_in.0[c] = T::select(due, self.refresh_samples, s.renew_in.0[c]);
            s.made_for.0[c] = T::select(due, elapsed, s.made_for.0[c]);
        }
    }

    /// One row of samples, one a channel. Every loop over channels is innermost and free of branches.
    #[inline(always)]
    fn row<const W: usize, O: Observer<T>>(
        &self,
        s: &mut Wide<T, W>,
        z: &[T; W],
        dt: T,
        observer: &mut O,
    ) -> [Flags; W] {
        let time = Sample { value: T::ZERO, dt }.check(self.limit, self.period_s);
        let mut ordinary = time.moves && !time.restart && self.outlier_probability == T::ZERO;
        for c in 0..W {
            let size = z[c].magnitude();
            ordinary &= (s.started.0[c] != T::ZERO) & (size <= self.limit) & (size < self.saturation);
        }
        if time.restart {
            *s = self.start_wide();
        }
        if !time.moves {
            return z.map(|value| Sample { value, dt }.check(self.limit, self.period_s).flags);
        }
        let elapsed = T::select(dt == self.period_s || time.restart, T::ONE, dt / self.period_s);
        let pace = if elapsed == T::ONE { self.nominal } else { self.pace(elapsed) };
        let lapsed = if ordinary { [Flags::NONE; W] } else { self.fall_silent(s, elapsed) };
        let mut due = false;
        for c in 0..W {
            due |= (s.renew_in.0[c] <= T::ZERO) | (s.made_for.0[c] != elapsed);
        }
        if due {
            self.renew(s, elapsed);
        }
        for c in 0..W {
            s.renew_in.0[c] -= T::ONE;
        }
        let mut flags = if ordinary {
            self.cycle::<true, W, O>(s, &Readings::ordinary(z), &pace, observer)
        } else {
            self.cycle_with_care(s, z, dt, &pace, observer)
        };
        let mut lost = false;
        for c in 0..W {
            lost |= !Self::holds(&s.fused.lane(c));
        }
        if lost {
            self.recover(s, &mut flags);
        }
        core::array::from_fn(|c| flags[c].with(lapsed[c]))
    }

    /// A row in which something needs care: a missing, absurd or saturated sample, the first one, or outliers expected.
    #[cold]
    #[inline(never)]
    fn cycle_with_care<const W: usize, O: Observer<T>>(
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

    /// What the state says about channel `c`.
    #[inline(always)]
    fn summary<const W: usize>(&self, s: &Wide<T, W>, c: usize, flags: Flags) -> Estimate<T> {
        let fused = s.fused.lane(c);
        Estimate {
            rate: fused[0],
            acceleration: fused[1] / self.period_s,
            variance: fused[2],
            flags: flags.with(Flags::NO_DATA_YET.when(s.started.0[c] == T::ZERO)),
        }
    }

    /// Counts the silence of every channel, and forgets those that have been silent for as long as the longest gap:
    /// coasting on would end in absurd numbers.
    #[cold]
    #[inline(never)]
    fn fall_silent<const W: usize>(&self, s: &mut Wide<T, W>, elapsed: T) -> [Flags; W] {
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
    fn holds([rate, acceleration, variance]: &[T; 3]) -> bool {
        (rate.magnitude() <= T::LARGEST.root()) & (acceleration.magnitude() <= T::LARGEST.root()) & variance.finite()
    }

    /// Starts channels anew that have lost their state.
    #[cold]
    #[inline(never)]
    fn recover<const W: usize>(&self, s: &mut Wide<T, W>, flags: &mut [Flags; W]) {
        let fresh = self.start_wide::<W>();
        for c in 0..W {
            if !Self::holds(&s.fused.lane(c)) {
                s.set_lane(c, fresh.lane(c));
                flags[c] = flags[c].with(Flags::DIVERGED);
            }
        }
    }
}

impl<T: Real> Filter<T> for MsImmIkf<T> {
    type State = MsImmIkfState<Lane<T, 1>>;

    fn start(&self) -> Self::State {
        self.start_wide()
    }

    fn accepts(&self, state: &Self::State) -> bool {
        self.accepts_bank(state)
    }

    fn period(&self) -> T {
        self.period_s
    }

    fn models(&self) -> usize {
        1 + self.rungs() + self.oscillators()
    }

    #[inline(always)]
    fn observe<O: Observer<T>>(&self, state: &mut Self::State, sample: Sample<T>, observer: &mut O) -> Estimate<T> {
        let flags = self.row(state, &[sample.value], sample.dt, observer);
        self.summary(state, 0, flags[0])
    }

    #[inline(always)]
    fn tile<const W: usize>(&self, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
        let mut state: Wide<T, W> = block::load_wide(lanes);
        for samples in tile {
            self.row(&mut state, samples, dt, &mut ());
            *samples = state.fused[0].0;
        }
        block::store_wide(&state, lanes);
    }
}
