//! Kalman filter for a level that walks at random ("HMM/KF").
//!
//! x(k+1) = x(k) + w, z = x + v with q = Q/R: K(1) = 1, w <- w + K (x - w), m = K + q, K <- m/(1 + m). Its steady gain is that of
//! recursive least squares with q = (1 - lambda)^2/lambda; on the way there it is slightly less noisy, at the same
//! cost. Both are one kernel here (`recursive/averaging.rs`) with different losses of old weight.
//! Source: DOI 10.7690/bgzdh.2019.03.009; Muth, J. Am. Stat. Assoc. 55 (1960), for the steady state.
//!
//! Zero start-up delay: the first output is the first sample. The steady state lags by lambda/(1 - lambda) samples.

use crate::error::ConfigError;
use crate::filter::Checked;
use crate::filters::recursive::averaging::{Averaging, Forgotten, Sensor};
use crate::filters::recursive::level::LevelState;
use crate::noise::{GyroNoise, range};
use crate::plain;
use crate::ranges;
use crate::real::Real;
use crate::settings::{Settings, Visit, visit_noise};

/// Settings of [`RandomWalkKf`].
///
/// # Example
/// ```
/// use stillrate::{Filter, GyroNoise, Sample, Settings};
/// use stillrate::filters::{RandomWalkKfSettings, closed_forms::forgetting_factor_of_variance_ratio};
/// let noise = GyroNoise::from_density_two_sided(0.01);
/// let settings = RandomWalkKfSettings { variance_ratio: 0.0025, ..RandomWalkKfSettings::defaults(200.0, noise) };
/// let filter = settings.build::<f64>()?;
/// let mut state = filter.start();
/// for _ in 0..1000 {
///     filter.step(&mut state, Sample { value: 1.0, dt: 0.005 });
/// }
/// let gain = 1.0 / state.weight; // settled at that of recursive least squares
/// assert!((gain - (1.0 - forgetting_factor_of_variance_ratio(0.0025))).abs() < 1e-12);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RandomWalkKfSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Noise of the gyro.
    pub noise: GyroNoise,
    /// q = Q/R: variance of the level's walk over one nominal period, over the variance of a sample.
    /// Default K^2 T / (N^2 / T) from the noise: a gyro at rest. A memory of tau samples is q = 1/tau^2, nearly.
    pub variance_ratio: f64,
}

impl Settings for RandomWalkKfSettings {
    const METHOD: &'static str = "hmm-kf";
    type Filter<T: Real> = RandomWalkKf<T>;

    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        let walk = noise.rate_random_walk_dps_sqrt_s / (noise.density_dps_sqrt_hz * sample_rate_hz);
        Self { sample_rate_hz, noise, variance_ratio: (walk * walk).least(1e12) }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visit_noise(visitor, &mut self.noise);
        visitor.number("variance_ratio", &mut self.variance_ratio);
    }

    fn build<T: Real>(&self) -> Result<RandomWalkKf<T>, ConfigError> {
        ranges::check(self)?;
        let (rate, noise) = (self.sample_rate_hz, self.noise);
        Ok(RandomWalkKf {
            period_s: T::of(1.0 / rate),
            variance_ratio: T::of(self.variance_ratio),
            sample_variance: T::of(noise.sample_variance(rate)),
            limit: range(noise.sample_variance(rate).root()),
        })
    }
}

plain! {
    /// Kalman filter for a random walk in white noise; the first sample starts it.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::RandomWalkKfSettings};
    /// let noise = GyroNoise::from_density_two_sided(0.01);
    /// let filter = RandomWalkKfSettings { variance_ratio: 0.0025, ..RandomWalkKfSettings::defaults(200.0, noise) }.build::<f64>()?;
    /// let mut state = filter.start();
    /// assert_eq!(filter.step(&mut state, Sample { value: 3.0, dt: 0.005 }).rate, 3.0);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct RandomWalkKf<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// q = Q/R over one nominal period.
        pub variance_ratio: T,
        /// Variance R of one sample, (deg/s)^2.
        pub sample_variance: T,
        /// Values beyond this magnitude count as missing.
        pub limit: T,
    }
}

impl<T: Real> RandomWalkKf<T> {
    /// The walk over the weight of all samples so far, q S.
    #[inline(always)]
    fn walked(walk: T, state: &LevelState<T>) -> T {
        // After an endless gap the walk is as good as infinite, but its share of the sum must stay a number.
        (walk * state.weight).least(T::LARGEST.root())
    }
    /// What the walk takes from the weight.
    #[inline(always)]
    fn loss(walked: T) -> T {
        walked / (T::ONE + walked)
    }
}

impl<T: Real> Averaging for RandomWalkKf<T> {
    type Number = T;

    #[inline(always)]
    fn sensor(&self) -> Sensor<T> {
        Sensor { period_s: self.period_s, sample_variance: self.sample_variance, limit: self.limit }
    }
    #[inline(always)]
    fn nominal_loss(&self, state: &LevelState<T>) -> T {
        Self::loss(Self::walked(self.variance_ratio, state))
    }
    #[inline(always)]
    fn forget<const NOMINAL: bool>(&self, state: &LevelState<T>, checked: &Checked<T>) -> Forgotten<T> {
        // The walk's variance grows with time.
        let periods = if NOMINAL || checked.dt == self.period_s { T::ONE } else { checked.dt / self.period_s };
        let walked = Self::walked(T::select(checked.moves, self.variance_ratio * periods, T::ZERO), state);
        let variance_ratio = T::select(state.empty(), T::ZERO, (T::ONE + walked) / state.weight);
        Forgotten { loss: Self::loss(walked), variance_ratio }
    }
    #[inline(always)]
    fn variance(&self, state: &LevelState<T>) -> T {
        T::select(state.empty(), T::ZERO, self.sample_variance / state.weight)
    }
}
