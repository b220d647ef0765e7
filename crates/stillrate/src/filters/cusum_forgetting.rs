//! Recursive least squares that a change detector opens again (CUSUM forgetting).
//!
//! A two-sided cumulative sum of s = e/(sigma sqrt(1 + K)): g+ <- max(0, g+ + s - drift), g- <- max(0, g- - s - drift). Where one passes
//! the threshold, both restart at zero and all but `samples_kept` samples' worth of the past is forgotten: K <- max(K, 1/samples_kept). Page, Biometrika
//! 41 (1954); Gustafsson, Adaptive Filtering and Change Detection, chapter 3. Best where the rate jumps; `variable-forgetting` is best where it flows.

use crate::error::ConfigError;
use crate::filter::{Estimate, Flags, Observer, Sample};
use crate::filters::recursive::innovation::Innovation;
use crate::filters::recursive::level::LevelState;
use crate::filters::recursive::memory::{Forgetting, Memory, check_memory, tau_of, visit_memory};
use crate::filters::recursive::paced::Paced;
use crate::noise::{GyroNoise, range};
use crate::plain;
use crate::ranges;
use crate::real::Real;
use crate::reals;
use crate::settings::{Settings, Visit, visit_noise};
use crate::sound;

/// Forgetting factor at rest: a noise ratio of 0.16.
const DEFAULT_FORGETTING_FACTOR: f64 = 0.951;

/// Settings of [`CusumForgetting`].
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::CusumForgettingSettings};
/// let noise = GyroNoise::from_standard_deviation_at_rate(0.05, 200.0);
/// let settings = CusumForgettingSettings::defaults(200.0, noise);
/// assert!((settings.tau_s * 200.0 - 19.9).abs() < 0.01); // samples
/// let torn = CusumForgettingSettings { tau_s: 1.0, ..settings }; // and still 0.951 a sample
/// assert_eq!(torn.build::<f64>().unwrap_err().field, "forgetting_factor");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CusumForgettingSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Noise of the gyro: the yardstick for innovations.
    pub noise: GyroNoise,
    /// Memory between changes, s; default twenty samples.
    pub tau_s: f64,
    /// The same as a factor a sample, in (0, 1]; default 0.951.
    pub forgetting_factor: f64,
    /// Standard deviations that count as no change; default 0.9.
    pub drift: f64,
    /// Sum at which a change is declared; default 4.75.
    pub threshold: f64,
    /// Samples' worth of the past that survive a change; default 1.33.
    pub samples_kept: f64,
}

impl Settings for CusumForgettingSettings {
    const METHOD: &'static str = "cusum-forgetting";
    type Filter<T: Real> = CusumForgetting<T>;

    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        let forgetting_factor = DEFAULT_FORGETTING_FACTOR;
        let tau_s = tau_of(forgetting_factor, sample_rate_hz);
        Self { sample_rate_hz, noise, tau_s, forgetting_factor, drift: 0.9, threshold: 4.75, samples_kept: 1.33 }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visit_noise(visitor, &mut self.noise);
        let (tau_s, forgetting_factor) = (&mut self.tau_s, &mut self.forgetting_factor);
        visit_memory(visitor, &mut Memory { sample_rate_hz: self.sample_rate_hz, tau_s, forgetting_factor });
        visitor.number("drift", &mut self.drift);
        visitor.number("threshold", &mut self.threshold);
        visitor.number("samples_kept", &mut self.samples_kept);
    }

    fn build<T: Real>(&self) -> Result<CusumForgetting<T>, ConfigError> {
        ranges::check(self)?;
        let rate = self.sample_rate_hz;
        let variance = self.noise.sample_variance(rate);
        let factor = check_memory(self.tau_s, self.forgetting_factor, rate)?;
        Ok(CusumForgetting {
            period_s: T::of(1.0 / rate),
            loss: T::of(1.0 - factor),
            tau_s: T::of(self.tau_s).least(T::LARGEST),
            drift: T::of(self.drift),
            threshold: T::of(self.threshold),
            samples_kept: T::of(self.samples_kept),
            sigma: T::of(variance.root()),
            sample_variance: T::of(variance),
            limit: range(variance.root()),
        })
    }
}

plain! {
    /// Recursive least squares, opened again where the innovations show a change.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, Flags, GyroNoise, Sample, Settings, filters::CusumForgettingSettings};
    /// let noise = GyroNoise::from_standard_deviation_at_rate(0.05, 200.0);
    /// let filter = CusumForgettingSettings::defaults(200.0, noise).build::<f64>()?;
    /// let mut state = filter.start();
    /// filter.step(&mut state, Sample { value: 0.0, dt: 0.005 });
    /// let estimate = filter.step(&mut state, Sample { value: 5.0, dt: 0.005 });
    /// assert!(estimate.flags.has(Flags::CHANGE));
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct CusumForgetting<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// 1 - lambda: what one nominal period takes off the weight of the past.
        pub loss: T,
        /// Memory, s.
        pub tau_s: T,
        /// Standard deviations that count as no change.
        pub drift: T,
        /// Sum at which a change is declared.
        pub threshold: T,
        /// Samples' worth of the past that survive a change.
        pub samples_kept: T,
        /// Standard deviation of one sample, deg/s.
        pub sigma: T,
        /// Its square.
        pub sample_variance: T,
        /// Values beyond this magnitude count as missing.
        pub limit: T,
    }
}

reals! {
    /// State of [`CusumForgetting`].
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::CusumForgettingSettings};
    /// let noise = GyroNoise::from_standard_deviation_at_rate(0.05, 200.0);
    /// let filter = CusumForgettingSettings::defaults(200.0, noise).build::<f64>()?;
    /// let mut state = filter.start();
    /// for k in 0..100 {
    ///     filter.step(&mut state, Sample { value: 0.0, dt: 0.005 });
    /// }
    /// assert!(state.mean.weight > 15.0);
    /// filter.step(&mut state, Sample { value: 5.0, dt: 0.005 });
    /// assert_eq!((state.mean.weight, state.gain), (1.33, 1.0 / 1.33)); // all but so many samples are forgotten
    /// assert_eq!((state.upward, state.downward), (0.0, 0.0));
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct CusumForgettingState {
        /// The weighted mean.
        pub mean: LevelState<T>,
        /// Gain of the sample before.
        pub gain: T,
        /// g+, the sum against changes upwards.
        pub upward: T,
        /// g-, the sum against changes downwards.
        pub downward: T,
    }
}

impl<T: Real> CusumForgettingState<T> {
    /// Adds a scaled innovation to both sums; true, and both back to zero, where one passes the threshold.
    #[inline(always)]
    fn detect(&mut self, scaled: T, drift: T, threshold: T, usable: bool) -> bool {
        let upward = (self.upward + scaled - drift).most(T::ZERO);
        let downward = (self.downward - scaled - drift).most(T::ZERO);
        let alarm = usable && (upward > threshold || downward > threshold);
        self.upward = T::select(alarm, T::ZERO, T::select(usable, upward, self.upward));
        self.downward = T::select(alarm, T::ZERO, T::select(usable, downward, self.downward));
        alarm
    }
}

impl<T: Real> Paced for CusumForgetting<T> {
    type Number = T;
    type State = CusumForgettingState<T>;

    fn begin(&self) -> CusumForgettingState<T> {
        CusumForgettingState { mean: LevelState::start(), gain: T::ONE, upward: T::ZERO, downward: T::ZERO }
    }

    fn admits(&self, state: &CusumForgettingState<T>) -> bool {
        state.mean.sound(self.limit)
            && sound::within(state.gain, T::ZERO, T::ONE)
            && sound::within(state.upward, T::ZERO, T::of(1e12))
            && sound::within(state.downward, T::ZERO, T::of(1e12))
    }

    fn nominal_s(&self) -> T {
        self.period_s
    }

    #[inline(always)]
    fn follow<const NOMINAL: bool, O: Observer<T>>(
        &self,
        state: &mut CusumForgettingState<T>,
        sample: Sample<T>,
        observer: &mut O,
    ) -> Estimate<T> {
        let checked = sample.check(self.limit, self.period_s);
        let usable = checked.present && !state.mean.empty();
        let innovation = Innovation::new(&checked, state.mean.level, self.sigma, state.gain);
        let alarm = state.detect(innovation.scaled(), self.drift, self.threshold, usable);
        let forgetting = Forgetting { period_s: self.period_s, loss: self.loss, tau_s: self.tau_s };
        let loss = forgetting.loss_over::<NOMINAL>(&checked);
        let mean = &mut state.mean;
        mean.weigh(loss, checked.present);
        mean.weight_low = T::select(alarm && mean.weight > self.samples_kept, T::ZERO, mean.weight_low);
        mean.weight = T::select(alarm, mean.weight.least(self.samples_kept), mean.weight);
        let gain = mean.correct(checked.value, checked.present);
        state.gain = T::select(checked.present, gain, state.gain);
        innovation.tell(observer, T::ONE - loss, mean.level);
        let estimate = mean.estimate(mean.noise_gain * self.sample_variance, &checked);
        Estimate { flags: estimate.flags.with(Flags::CHANGE.when(alarm)), ..estimate }
    }
}
