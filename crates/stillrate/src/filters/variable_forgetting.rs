//! Recursive least squares that forgets when it sees motion (VFF), of order 1 or 2.
//!
//! The innovation e = x - w over its standard deviation is smoothed, z <- (1 - beta) z + beta e/(sigma sqrt(1 + K)) with K the gain of the sample before, and
//! compared with its own spread at rest: a = clamp((|z| sqrt((2 - beta)/beta) - threshold)/width, 0, 1). The forgetting factor of this sample
//! is lambda = lambda_max + (lambda_min - lambda_max) a. At rest it averages like a fixed filter, in motion it lets the signal through:
//! under strong motion it is slightly noisier than no filter at all, and its lag stays below one sample.
//!
//! The defaults were found by random search on simulated motion with white noise of known sigma; a sigma of half the true one
//! doubles the noise that passes at rest, twice the true one adds 60 % error in motion.

use crate::error::{ConfigError, between, not_negative, positive};
use crate::filter::{Checked, Estimate, Observer, Sample};
use crate::filters::hmm_rls::{RecursiveLeastSquaresState, check_order};
use crate::filters::recursive::innovation::Innovation;
use crate::filters::recursive::level::LevelState;
use crate::filters::recursive::line::LineState;
use crate::filters::recursive::memory::{check_factor, tau_of};
use crate::filters::recursive::paced::{Paced, step_paced};
use crate::noise::{GyroNoise, range};
use crate::plain;
use crate::real::Real;
use crate::reals;
use crate::settings::{Settings, Visit, visit_noise};

/// Settings of [`VariableForgetting`]. The defaults depend on the order; all but the first two are pure numbers.
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::VariableForgettingSettings};
/// let noise = GyroNoise::from_standard_deviation_at_rate(0.05, 200.0);
/// assert!(VariableForgettingSettings::defaults(200.0, noise).build::<f32>().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct VariableForgettingSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Noise of the gyro: the yardstick for innovations.
    pub noise: GyroNoise,
    /// 1: level; 2: level and slope. Default 1.
    pub order: f64,
    /// Forgetting factor at rest; default 0.9507 (order 2: 0.98), a noise ratio of 0.16.
    pub forgetting_factor_max: f64,
    /// Forgetting factor in full motion; default 0.1 (order 2: 0.5).
    pub forgetting_factor_min: f64,
    /// beta, how fast the innovation is smoothed, in (0, 1]; default 0.45 (order 2: 0.36).
    pub smoothing: f64,
    /// Standard deviations of the smoothed innovation where forgetting begins; default 3.2 (order 2: 2.8).
    pub threshold: f64,
    /// Standard deviations from there to full motion; default 1.4 (order 2: 2.4).
    pub width: f64,
}

impl VariableForgettingSettings {
    /// Sensible settings of order 2.
    #[must_use]
    pub fn defaults_of_order_2(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        Self {
            order: 2.0,
            forgetting_factor_max: 0.98,
            forgetting_factor_min: 0.5,
            smoothing: 0.36,
            threshold: 2.8,
            width: 2.4,
            ..Self::defaults(sample_rate_hz, noise)
        }
    }
}

impl Settings for VariableForgettingSettings {
    const METHOD: &'static str = "variable-forgetting";
    type Filter<T: Real> = VariableForgetting<T>;

    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        Self {
            sample_rate_hz,
            noise,
            order: 1.0,
            forgetting_factor_max: 0.9507,
            forgetting_factor_min: 0.1,
            smoothing: 0.45,
            threshold: 3.2,
            width: 1.4,
        }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visit_noise(visitor, &mut self.noise);
        let before = self.order;
        visitor.number("order", &mut self.order);
        if self.order == 2.0 && before == 1.0 {
            *self = Self::defaults_of_order_2(self.sample_rate_hz, self.noise);
        }
        visitor.number("forgetting_factor_max", &mut self.forgetting_factor_max);
        visitor.number("forgetting_factor_min", &mut self.forgetting_factor_min);
        visitor.number("smoothing", &mut self.smoothing);
        visitor.number("threshold", &mut self.threshold);
        visitor.number("width", &mut self.width);
    }

    fn build<T: Real>(&self) -> Result<VariableForgetting<T>, ConfigError> {
        let rate = positive("sample_rate_hz", self.sample_rate_hz, "Hz")?;
        let noise = self.noise.checked()?;
        let second = check_order(self.order)?;
        let most = check_factor("forgetting_factor_max", self.forgetting_factor_max)?;
        let least = check_factor("forgetting_factor_min", self.forgetting_factor_min)?;
        if least > most {
            return Err(ConfigError::new("forgetting_factor_min", least, "", "at most forgetting_factor_max"));
        }
        let smoothing = between("smoothing", self.smoothing, 0.0, 1.0 + f64::EPSILON, "", "above 0 and at most 1")?;
        let threshold = not_negative("threshold", self.threshold, "")?;
        let width = positive("width", self.width, "")?;
        // The smoothed innovation of white noise is smaller by sqrt(beta/(2 - beta)).
        let spread = ((2.0 - smoothing) / smoothing).root();
        let variance = noise.sample_variance(rate);
        Ok(VariableForgetting {
            period_s: T::of(1.0 / rate),
            order: if second { T::TWO } else { T::ONE },
            forgetting_factor_max: T::of(most),
            range: T::of(least - most),
            smoothing: T::of(smoothing),
            spread: T::of(spread),
            threshold: T::of(threshold),
            width: T::of(width),
            sigma: T::of(variance.root()),
            sample_variance: T::of(variance),
            quiet_tau_s: T::of(tau_of(most, rate)).least(T::LARGEST),
            limit: range(variance.root()),
        })
    }
}

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
            (nominal.logarithm() * (checked.dt / self.period_s)).exponential()
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
        let sums = RecursiveLeastSquaresState { mean: LevelState::start(), line: LineState::start() };
        VariableForgettingState { sums, gain: T::ONE, smoothed: T::ZERO }
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
        // Once a tile, not once a sample: the order that is not in use then costs nothing.
        if self.order == T::TWO {
            step_paced(&OfOrder::<true, T>(*self), lanes, tile, dt);
        } else {
            step_paced(&OfOrder::<false, T>(*self), lanes, tile, dt);
        }
    }
}

/// The filter where the compiler knows whether its order is 2.
#[derive(Clone, Copy, Debug)]
struct OfOrder<const SECOND: bool, T>(VariableForgetting<T>);

impl<const SECOND: bool, T: Real> Paced for OfOrder<SECOND, T> {
    type Number = T;
    type State = VariableForgettingState<T>;

    fn begin(&self) -> VariableForgettingState<T> {
        self.0.begin()
    }

    fn nominal_s(&self) -> T {
        self.0.period_s
    }

    #[inline(always)]
    fn follow<const NOMINAL: bool, O: Observer<T>>(
        &self,
        state: &mut VariableForgettingState<T>,
        sample: Sample<T>,
        observer: &mut O,
    ) -> Estimate<T> {
        if SECOND {
            self.0.follow_line::<NOMINAL, O>(state, sample, observer)
        } else {
            self.0.follow_level::<NOMINAL, O>(state, sample, observer)
        }
    }
}
