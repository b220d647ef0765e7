//! Recursive least squares that forgets when it sees motion (VFF), of order 1 or 2.
//!
//! The innovation e = x - w over its standard deviation is smoothed, z <- (1 - beta) z + beta e/(sigma sqrt(1 + K)) with K the gain of the sample before, and
//! compared with its own spread at rest: a = clamp((|z| sqrt((2 - beta)/beta) - threshold)/width, 0, 1). The forgetting factor of this sample
//! is lambda = lambda_max + (lambda_min - lambda_max) a. At rest it averages like a fixed filter, in motion it lets the signal through:
//! under strong motion it is slightly noisier than no filter at all, and its lag stays below one sample.

use crate::filter::{Checked, Estimate, Observer, Sample};
use crate::filters::hmm_rls::RecursiveLeastSquaresState;
use crate::filters::recursive::innovation::Innovation;
use crate::filters::recursive::paced::{Paced, step_paced};
use crate::plain;
use crate::real::Real;
use crate::reals;
use crate::sound;

plain! {
    /// Recursive least squares whose forgetting factor follows the innovation.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::VariableForgettingSettings};
    /// let noise = GyroNoise::from_standard_deviation_at_rate(0.05, 200.0);
    /// let filter = VariableForgettingSettings::defaults(200.0, noise).build::<f64>()?;
    /// let mut state = filter.start();
    /// for k in 0..200 {
    ///     let value = if k < 150 { 0.0 } else { 5.0 }; // at rest, then a sudden turn
    ///     let estimate = filter.step(&mut state, Sample { value, dt: 0.005 });
    ///     if k == 152 {
    ///         assert!((estimate.rate - 5.0).abs() < 0.1); // followed within three samples
    ///     }
    /// }
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct VariableForgetting<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// 1 or 2.
        pub order: T,
        /// Forgetting factor at rest, a nominal period.
        pub forgetting_factor_max: T,
        /// What full motion adds to it (negative).
        pub range: T,
        /// beta.
        pub smoothing: T,
        /// sqrt((2 - beta)/beta).
        pub spread: T,
        /// Where forgetting begins, standard deviations.
        pub threshold: T,
        /// From there to full motion, standard deviations.
        pub width: T,
        /// Standard deviation of one sample, deg/s.
        pub sigma: T,
        /// Its square.
        pub sample_variance: T,
        /// Memory at rest, s: an order-2 line is followed through a gap for so long.
        pub quiet_tau_s: T,
        /// Values beyond this magnitude count as missing.
        pub limit: T,
    }
}

reals! {
    /// State of [`VariableForgetting`].
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::VariableForgettingSettings};
    /// let noise = GyroNoise::from_standard_deviation_at_rate(0.05, 200.0);
    /// let filter = VariableForgettingSettings::defaults(200.0, noise).build::<f64>()?;
    /// let mut state = filter.start();
    /// for _ in 0..100 {
    ///     filter.step(&mut state, Sample { value: 0.0, dt: 0.005 });
    /// }
    /// assert!(state.gain < 0.06); // twenty samples' worth of memory
    /// filter.step(&mut state, Sample { value: 5.0, dt: 0.005 });
    /// assert!(state.smoothed > 10.0 && state.gain > 0.3); // 100 standard deviations: the past counts no more
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct VariableForgettingState {
        /// The weighted mean or line.
        pub sums: RecursiveLeastSquaresState<T>,
        /// Gain of the sample before (order 2: its g1).
        pub gain: T,
        /// Smoothed innovation in standard deviations.
        pub smoothed: T,
    }
}

impl<T: Real> VariableForgetting<T> {
    /// Smooths the innovation; nothing to smooth for the first sample or a missing one.
    #[inline(always)]
    fn smooth(&self, smoothed: T, scaled_innovation: T, usable: bool) -> T {
        let next = (T::ONE - self.smoothing) * smoothed + self.smoothing * scaled_innovation;
        // A wild but finite sample must not outlive itself by much: beyond 1e6 sigma there is nothing to tell apart.
        let bounded = next.limited(T::of(-1e6), T::of(1e6));
        T::select(usable, bounded, smoothed).flushed()
    }

    /// lambda for a smoothed innovation, over the time that passed.
    #[inline(always)]
    fn forgetting_factor<const NOMINAL: bool>(&self, smoothed: T, checked: &Checked<T>) -> T {
        let excess = (smoothed.magnitude() * self.spread - self.threshold) / self.width;
        let nominal = self.forgetting_factor_max + self.range * excess.limited(T::ZERO, T::ONE);
        let factor = if NOMINAL || checked.dt == self.period_s {
            nominal
        } else {
            // An endless memory (0) over an endless gap must not become NaN.
            let periods = (checked.dt / self.period_s).least(T::LARGEST.root());
            (nominal.logarithm() * periods).exponential()
        };
        T::select(checked.moves, factor, T::ONE)
    }

    #[inline(always)]
    fn follow_level<const NOMINAL: bool, O: Observer<T>>(
        &self,
        state: &mut VariableForgettingState<T>,
        sample: Sample<T>,
        observer: &mut O,
    ) -> Estimate<T> {
        let checked = sample.check(self.limit, self.period_s);
        let mean = &mut state.sums.mean;
        let usable = checked.present && !mean.empty();
        let innovation = Innovation::new(&checked, mean.level, self.sigma, state.gain);
        state.smoothed = self.smooth(state.smoothed, innovation.scaled(), usable);
        let factor = self.forgetting_factor::<NOMINAL>(state.smoothed, &checked);
        mean.weigh(T::ONE - factor, checked.present);
        let gain = mean.correct(checked.value, checked.present);
        state.gain = T::select(checked.present, gain, state.gain);
        innovation.tell(observer, factor, mean.level);
        mean.estimate(mean.noise_gain * self.sample_variance, &checked)
    }

    #[inline(always)]
    fn follow_line<const NOMINAL: bool, O: Observer<T>>(
        &self,
        state: &mut VariableForgettingState<T>,
        sample: Sample<T>,
        observer: &mut O,
    ) -> Estimate<T> {
        let checked = sample.check(self.limit, self.period_s);
        let line = &mut state.sums.line;
        let passage = line.pass(&checked, self.period_s);
        let usable = checked.present && !line.empty();
        state.smoothed = T::select(passage.restart, T::ZERO, state.smoothed);
        let predicted = line.level + passage.periods * line.slope;
        let innovation = Innovation::new(&checked, predicted, self.sigma, state.gain);
        state.smoothed = self.smooth(state.smoothed, innovation.scaled(), usable);
        let factor = self.forgetting_factor::<NOMINAL>(state.smoothed, &checked);
        line.age(passage.periods, factor);
        let gain = line.correct(checked.value, checked.present).level;
        state.gain = T::select(checked.present, gain, state.gain);
        innovation.tell(observer, factor, line.level);
        line.estimate(self.sample_variance, self.quiet_tau_s, self.period_s, &checked, passage.restart)
    }
}

impl<T: Real> Paced for VariableForgetting<T> {
    type Number = T;
    type State = VariableForgettingState<T>;

    fn begin(&self) -> VariableForgettingState<T> {
        VariableForgettingState { sums: RecursiveLeastSquaresState::start(), gain: T::ONE, smoothed: T::ZERO }
    }

    fn admits(&self, state: &VariableForgettingState<T>) -> bool {
        state.sums.mean.sound(self.limit)
            && state.sums.line.sound(self.period_s)
            && sound::within(state.gain, T::ZERO, T::of(1.001))
            && sound::at_most(state.smoothed, T::of(1e6))
    }

    fn nominal_s(&self) -> T {
        self.period_s
    }

    #[inline(always)]
    fn follow<const NOMINAL: bool, O: Observer<T>>(
        &self,
        state: &mut VariableForgettingState<T>,
        sample: Sample<T>,
        observer: &mut O,
    ) -> Estimate<T> {
        if self.order == T::TWO {
            self.follow_line::<NOMINAL, O>(state, sample, observer)
        } else {
            self.follow_level::<NOMINAL, O>(state, sample, observer)
        }
    }
    #[inline(always)]
    fn follow_tile<const W: usize>(&self, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
        // Once a tile, not once a sample: where the compiler knows the order, the one that is not in use costs nothing.
        let mut filter = *self;
        if self.order == T::TWO {
            filter.order = T::TWO;
            step_paced(&filter, lanes, tile, dt);
        } else {
            filter.order = T::ONE;
            step_paced(&filter, lanes, tile, dt);
        }
    }
}
