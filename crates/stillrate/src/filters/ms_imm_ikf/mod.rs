//! MS-IMM-IKF, the recommended bank: an interacting multiple model Kalman filter whose models span all bandwidths.
//!
//! One random walk (rest), a ladder of Singer models (motion of any bandwidth) and a group of double oscillators
//! (narrow-band motion) that share an on-line manoeuvre frequency. All bandwidths are relative to the noise, so
//! the filter needs no tuning besides the noise figures. The cycle is mix, predict, update, weigh, fuse (Blom and Bar-Shalom 1988);
//! then the frequency follows the fused motion. Derivatives are scaled by powers of the sample period, time by the period.
//!
//! Departures from the textbook cycle: the acceleration of other models is capped when an oscillator takes it over, the frequency
//! and the prior variances have memories of their own, and rest has a longer dwell time than motion.
//!
//! Here stand the numbers of the filter, the cycle and what a row of samples goes through; a stage a file beside it: [`mixing`], [`weighing`],
//! [`fusion`], and [`care`] for all that is not ordinary. Each stage is a loop over the models with a loop over the channels inside;
//! the latter is straight-line code that the compiler turns into vector instructions. The order of every sum over models is
//! fixed: random walk, rungs, oscillators.

mod care;
mod fusion;
mod mixing;
mod settings;
mod state;
mod weighing;

pub use settings::MsImmIkfSettings;
pub use state::{MsImmIkfState, Pace};

use crate::adaptive::manoeuvre_frequency::FrequencyMemory;
use crate::block;
use crate::filter::{Estimate, Filter, Flags, Observer, Sample};
use crate::plain;
use crate::real::Real;
use crate::reals::{Lane, Lanes, Reals};
use care::Readings;
use state::Wide;
use weighing::Weights;

/// Most rungs a ladder can have: up to 32 kHz.
pub const RUNGS: usize = 8;
/// Most oscillators a bank can have.
pub const OSCILLATORS: usize = 6;
/// Reciprocal time constant of the rungs, 1/s: hardly any decay, but stationary.
const RUNG_ALPHA: f64 = 1e-3;

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

impl<T: Real> MsImmIkf<T> {
    #[inline(always)]
    fn rungs(&self) -> usize {
        (self.rung_count as usize).min(RUNGS)
    }

    #[inline(always)]
    fn oscillators(&self) -> usize {
        (self.oscillator_count as usize).min(OSCILLATORS)
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

    /// One row through the whole cycle; returns the flags. `ORDINARY` promises a row made by [`Readings::ordinary`]
    /// and no outliers expected: every select is then decided at compile time.
    #[inline(always)]
    fn cycle<const ORDINARY: bool, const W: usize, O: Observer<T>>(
        &self,
        s: &mut Wide<T, W>,
        readings: &Readings<T, W>,
        pace: &Pace<T>,
        observer: &mut O,
    ) -> [Flags; W] {
        observer.frequency(s.motion.angle.0[0] / self.period_s);
        let sources = self.gather_sources(s, pace);
        let mut weights = Weights::even();
        self.mix_and_predict(s, &sources, pace);
        let mut used = readings.used;
        let mut flags = readings.flags;
        if !ORDINARY && self.saturation < T::LARGEST {
            self.skip_beyond_the_rail(s, readings, &mut used, &mut flags);
        }
        self.update::<ORDINARY, W>(s, readings, &used, &mut weights);
        self.weigh::<ORDINARY, W>(s, &used, &mut weights);
        for c in 0..W {
            s.silent.0[c] = T::select(ORDINARY || readings.used[c], T::ZERO, s.silent.0[c]);
        }
        self.fuse_and_follow::<ORDINARY, W>(s, pace);
        if !ORDINARY {
            for c in 0..W {
                s.started.0[c] = T::select(readings.used[c], T::ONE, s.started.0[c]);
                flags[c] = flags[c].with(Flags::OUTLIER.when(used[c] && weights.outlier[c] > T::HALF));
            }
        }
        self.show(s, &used, &weights, observer);
        flags
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
        let tile = if lanes.len() < <Self::State as Reals<T>>::COUNT { &mut [] } else { tile };
        let mut state: Wide<T, W> = block::load_wide(lanes);
        for samples in tile {
            self.row(&mut state, samples, dt, &mut ());
            *samples = state.fused[0].0;
        }
        block::store_wide(&state, lanes);
    }
}
