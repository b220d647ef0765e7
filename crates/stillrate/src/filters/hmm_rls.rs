//! Recursive least squares with exponential forgetting ("HMM/RLS"; the HMM is just a level that may wander).
//!
//! Order 1 is the exponentially weighted mean of all samples so far, K(n) = (1 - lambda)/(1 - lambda^n); order 2 the
//! exponentially weighted straight line. Source: DOI 10.7690/bgzdh.2019.03.009; the recurrences stand in
//! `recursive/level.rs` and `recursive/line.rs`.
//!
//! Zero start-up delay: the first output is the first sample, and no warm-up follows. In the steady state order 1 lags by
//! lambda/(1 - lambda) samples like any causal average of the same noise reduction; order 2 has no lag on a ramp and pays
//! with 2.5 times the variance at the same lambda and 13 % overshoot.

use crate::error::ConfigError;
use crate::filter::{Checked, Estimate, Observer, Sample};
use crate::filters::recursive::averaging::{Averaging, Forgotten, Sensor};
use crate::filters::recursive::level::{LevelState, Seen};
use crate::filters::recursive::line::LineState;
use crate::filters::recursive::memory::{Forgetting, Memory, check_memory, factor_of, visit_memory};
use crate::filters::recursive::paced::{Paced, step_paced};
use crate::noise::{GyroNoise, range};
use crate::plain;
use crate::ranges;
use crate::real::Real;
use crate::reals;
use crate::settings::{Settings, Visit, visit_noise};

/// Default memory in seconds: 1.6 Hz at -3 dB, noise down by 16 dB at 200 Hz.
pub const DEFAULT_TAU_S: f64 = 0.1;

/// Settings of [`RecursiveLeastSquares`].
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::RecursiveLeastSquaresSettings};
/// let settings = RecursiveLeastSquaresSettings::defaults(200.0, GyroNoise::from_density_two_sided(0.01));
/// assert!((settings.forgetting_factor - (-0.05_f64).exp()).abs() < 1e-15); // exp(-1 / (0.1 s * 200 Hz))
/// assert!(settings.build::<f64>().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RecursiveLeastSquaresSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Noise of the gyro; only the reported variance depends on it.
    pub noise: GyroNoise,
    /// 1: weighted mean; 2: weighted straight line. Default 1.
    pub order: f64,
    /// Memory, s: the weight of a sample falls to 1/e in this time. Default 0.1 s, a tenth of a sample period at least.
    pub tau_s: f64,
    /// The same as a factor a sample, in (0, 1]: exp(-1/(tau_s sample_rate_hz)).
    pub forgetting_factor: f64,
}

impl Settings for RecursiveLeastSquaresSettings {
    const METHOD: &'static str = "hmm-rls";
    type Filter<T: Real> = RecursiveLeastSquares<T>;

    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        let tau_s = DEFAULT_TAU_S.most(0.1 / sample_rate_hz);
        Self { sample_rate_hz, noise, order: 1.0, tau_s, forgetting_factor: factor_of(tau_s, sample_rate_hz) }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visit_noise(visitor, &mut self.noise);
        visitor.number("order", &mut self.order);
        let (tau_s, forgetting_factor) = (&mut self.tau_s, &mut self.forgetting_factor);
        visit_memory(visitor, &mut Memory { sample_rate_hz: self.sample_rate_hz, tau_s, forgetting_factor });
    }

    fn build<T: Real>(&self) -> Result<RecursiveLeastSquares<T>, ConfigError> {
        ranges::check(self)?;
        let (rate, noise) = (self.sample_rate_hz, self.noise);
        let second = check_order(self.order)?;
        let factor = check_memory(self.tau_s, self.forgetting_factor, rate)?;
        Ok(RecursiveLeastSquares {
            mean: WeightedMean {
                period_s: T::of(1.0 / rate),
                loss: T::of(1.0 - factor),
                tau_s: T::of(self.tau_s).least(T::LARGEST),
                sample_variance: T::of(noise.sample_variance(rate)),
                limit: range(noise.sample_variance(rate).root()),
            },
            order: if second { T::TWO } else { T::ONE },
        })
    }
}

/// Whether the order is 2.
pub(crate) fn check_order(order: f64) -> Result<bool, ConfigError> {
    if order == 1.0 || order == 2.0 { Ok(order == 2.0) } else { Err(ConfigError::new("order", order, "", "1 or 2")) }
}

plain! {
    /// Order 1 on its own: the exponentially weighted mean.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::RecursiveLeastSquaresSettings};
    /// let noise = GyroNoise::from_density_two_sided(0.01);
    /// let both = RecursiveLeastSquaresSettings::defaults(200.0, noise).build::<f64>()?;
    /// let mean = both.mean; // a filter by itself
    /// let (mut state, mut alone) = (both.start(), mean.start());
    /// for value in [1.0, 2.0, 6.0] {
    ///     let sample = Sample { value, dt: 0.005 };
    ///     assert_eq!(both.step(&mut state, sample), mean.step(&mut alone, sample));
    /// }
    /// assert!(size_of_val(&alone) < size_of_val(&state) / 2);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct WeightedMean<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// 1 - lambda: what one nominal period takes off the weight of the past.
        pub loss: T,
        /// Memory, s.
        pub tau_s: T,
        /// Variance of one sample, (deg/s)^2.
        pub sample_variance: T,
        /// Values beyond this magnitude count as missing.
        pub limit: T,
    }
}

impl<T: Real> WeightedMean<T> {
    #[inline(always)]
    fn forgetting(&self) -> Forgetting<T> {
        Forgetting { period_s: self.period_s, loss: self.loss, tau_s: self.tau_s }
    }
}

impl<T: Real> Averaging for WeightedMean<T> {
    type Number = T;

    #[inline(always)]
    fn sensor(&self) -> Sensor<T> {
        Sensor { period_s: self.period_s, sample_variance: self.sample_variance, limit: self.limit }
    }
    #[inline(always)]
    fn nominal_loss(&self, _state: &LevelState<T>) -> T {
        self.loss
    }
    #[inline(always)]
    fn forget<const NOMINAL: bool>(&self, state: &LevelState<T>, checked: &Checked<T>) -> Forgotten<T> {
        Forgotten { loss: self.forgetting().loss_over::<NOMINAL>(checked), variance_ratio: state.noise_gain }
    }
    #[inline(always)]
    fn variance(&self, state: &LevelState<T>) -> T {
        state.noise_gain * self.sample_variance
    }
}

plain! {
    /// Exponentially weighted mean or line of all samples so far.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::RecursiveLeastSquaresSettings};
    /// let mut settings = RecursiveLeastSquaresSettings::defaults(200.0, GyroNoise::from_density_two_sided(0.01));
    /// settings.tau_s = f64::INFINITY; // forget nothing: the running mean
    /// settings.forgetting_factor = 1.0;
    /// let filter = settings.build::<f64>()?;
    /// let mut state = filter.start();
    /// let means: Vec<f64> =
    ///     [1.0, 2.0, 6.0].map(|value| filter.step(&mut state, Sample { value, dt: 0.005 }).rate).to_vec();
    /// assert_eq!(means, [1.0, 1.5, 3.0]);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct RecursiveLeastSquares<T> {
        /// Order 1, and what order 2 has in common with it.
        pub mean: WeightedMean<T>,
        /// 1 or 2.
        pub order: T,
    }
}

reals! {
    /// State of [`RecursiveLeastSquares`]: of the two orders only the configured one is in use.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings};
    /// use stillrate::filters::{RecursiveLeastSquaresSettings, closed_forms::rls_gain};
    /// let settings = RecursiveLeastSquaresSettings::defaults(200.0, GyroNoise::from_density_two_sided(0.01));
    /// let filter = settings.build::<f64>()?;
    /// let mut state = filter.start();
    /// for n in 1..100 {
    ///     filter.step(&mut state, Sample { value: 1.0, dt: 0.005 });
    ///     let gain = 1.0 / state.mean.weight;
    ///     assert!((gain / rls_gain(settings.forgetting_factor, n) - 1.0).abs() < 1e-12);
    /// }
    /// assert_eq!(state.line.moments, [0.0; 3]); // order 1: the line stays as it started
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct RecursiveLeastSquaresState {
        /// Order 1.
        pub mean: LevelState<T>,
        /// Order 2.
        pub line: LineState<T>,
    }
}

impl<T: Real> RecursiveLeastSquaresState<T> {
    /// Before the first sample.
    pub(crate) fn start() -> Self {
        Self { mean: LevelState::start(), line: LineState::start() }
    }
}

impl<T: Real> RecursiveLeastSquares<T> {
    #[inline(always)]
    fn follow_line<const NOMINAL: bool, O: Observer<T>>(
        &self,
        line: &mut LineState<T>,
        sample: Sample<T>,
        observer: &mut O,
    ) -> Estimate<T> {
        let config = &self.mean;
        let checked = sample.check(config.limit, config.period_s);
        let passage = line.pass(&checked, config.period_s);
        let loss = config.forgetting().loss_over::<NOMINAL>(&checked);
        let innovation_variance = config.sample_variance * (T::ONE + line.noise_gain());
        line.age(passage.periods, T::ONE - loss);
        let innovation = checked.value - line.level;
        line.correct(checked.value, checked.present);
        let forgetting_factor = T::ONE - loss;
        let seen = Seen { present: checked.present, innovation, innovation_variance, forgetting_factor };
        seen.tell(observer, line.level);
        line.estimate(config.sample_variance, config.tau_s, config.period_s, &checked, passage.restart)
    }
}

impl<T: Real> Paced for RecursiveLeastSquares<T> {
    type Number = T;
    type State = RecursiveLeastSquaresState<T>;

    fn begin(&self) -> RecursiveLeastSquaresState<T> {
        RecursiveLeastSquaresState::start()
    }

    fn admits(&self, state: &RecursiveLeastSquaresState<T>) -> bool {
        state.mean.sound(self.mean.limit) && state.line.sound(self.mean.period_s)
    }

    fn nominal_s(&self) -> T {
        self.mean.period_s
    }

    #[inline(always)]
    fn follow<const NOMINAL: bool, O: Observer<T>>(
        &self,
        state: &mut RecursiveLeastSquaresState<T>,
        sample: Sample<T>,
        observer: &mut O,
    ) -> Estimate<T> {
        if self.order == T::TWO {
            self.follow_line::<NOMINAL, O>(&mut state.line, sample, observer)
        } else {
            self.mean.follow::<NOMINAL, O>(&mut state.mean, sample, observer)
        }
    }

    #[inline(always)]
    fn follow_tile<const W: usize>(&self, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
        if self.order == T::TWO {
            step_paced(self, lanes, tile, dt);
        } else {
            // The mean's numbers come first in the state, so its own loop runs on them without touching the rest.
            self.mean.follow_tile(lanes, tile, dt);
        }
    }
}
