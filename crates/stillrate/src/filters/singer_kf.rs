//! Singer Kalman filter: one target-manoeuvre model with a fixed time constant.
//!
//! R. A. Singer, IEEE Trans. AES-6 (1970): state (rate, acceleration), acceleration as a Gauss-Markov process of variance
//! sigma_m^2 = A_max^2 / 3 (uniform up to the largest acceleration) and time constant 1 / alpha.

use super::singer_pair::{SingerFigures, driving_density};
use crate::error::ConfigError;
use crate::filter::{Estimate, Filter, Flags, ModelTrace, Observer, Sample};
use crate::gaussian::Gaussian2;
use crate::kalman::{Reading, predict_singer, update2};
use crate::models::SingerCoefficients;
use crate::noise::{GyroNoise, range};
use crate::plain;
use crate::ranges;
use crate::real::Real;
use crate::reals;
use crate::settings::{Settings, Visit, visit_noise};
use crate::sound;

/// Settings of [`SingerKf`].
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::SingerKfSettings};
/// let noise = GyroNoise::from_standard_deviation_at_rate(0.1, 50.0);
/// let settings = SingerKfSettings::defaults(50.0, noise);
/// assert!((settings.measurement_variance - 0.01).abs() < 1e-15);
/// let filter = settings.build::<f64>()?;
/// assert!((filter.intensity - 2.0 * 0.01 * 30.0 * 30.0 / 3.0).abs() < 1e-12); // 2 alpha A_max^2 / 3
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SingerKfSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// The gyro's noise.
    pub noise: GyroNoise,
    /// Reciprocal manoeuvre time constant, 1/s; default 0.01.
    pub alpha_per_s: f64,
    /// Largest acceleration, deg/s^2; default 30.
    pub accel_max_dps2: f64,
    /// Variance of a sample, (deg/s)^2; default that of the noise at the sample rate.
    pub measurement_variance: f64,
    /// Variance of the rate before the first sample, (deg/s)^2; default the same.
    pub initial_rate_variance: f64,
    /// Variance of the acceleration before the first sample, (deg/s^2)^2; default 100.
    pub initial_acceleration_variance: f64,
}

impl Settings for SingerKfSettings {
    const METHOD: &'static str = "singer-kf";
    type Filter<T: Real> = SingerKf<T>;

    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        let variance = noise.sample_variance(sample_rate_hz);
        Self {
            sample_rate_hz,
            noise,
            alpha_per_s: 0.01,
            accel_max_dps2: 30.0,
            measurement_variance: variance,
            initial_rate_variance: variance,
            initial_acceleration_variance: 100.0,
        }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visit_noise(visitor, &mut self.noise);
        visitor.number("alpha_per_s", &mut self.alpha_per_s);
        visitor.number("accel_max_dps2", &mut self.accel_max_dps2);
        visitor.number("measurement_variance", &mut self.measurement_variance);
        visitor.number("initial_rate_variance", &mut self.initial_rate_variance);
        visitor.number("initial_acceleration_variance", &mut self.initial_acceleration_variance);
    }

    fn build<T: Real>(&self) -> Result<SingerKf<T>, ConfigError> {
        ranges::check(self)?;
        let period = 1.0 / self.sample_rate_hz;
        let (variance, rate, start) =
            (self.measurement_variance, self.initial_rate_variance, self.initial_acceleration_variance);
        let (alpha, accel_max) = (self.alpha_per_s, self.accel_max_dps2);
        SingerFigures { alpha_per_s: &[alpha], accel_max_dps2: &[accel_max], initial_variance: &[start] }.check()?;
        let intensity = driving_density(alpha, accel_max);
        Ok(SingerKf {
            period_s: T::of(period),
            alpha: T::of(alpha),
            intensity: T::of(intensity),
            step: SingerCoefficients::new(T::of(alpha), T::of(period)),
            measurement_variance: T::of(variance),
            start_variance: [T::of(rate), T::of(start)],
            limit: range(variance.root()),
        })
    }
}

plain! {
    /// Singer Kalman filter.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::SingerKfSettings};
    /// let noise = GyroNoise::from_density_two_sided(0.015);
    /// let filter = SingerKfSettings::defaults(50.0, noise).build::<f64>()?;
    /// let mut state = filter.start();
    /// assert_eq!(filter.step(&mut state, Sample { value: 1.0, dt: 0.02 }).rate, 1.0);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct SingerKf<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// Reciprocal time constant, 1/s.
        pub alpha: T,
        /// Density of the driving noise, 2 alpha sigma_m^2.
        pub intensity: T,
        /// Coefficients at the nominal period.
        pub step: SingerCoefficients<T>,
        /// Variance of a sample.
        pub measurement_variance: T,
        /// Variances of rate and acceleration at the first sample.
        pub start_variance: [T; 2],
        /// Values beyond this magnitude count as missing.
        pub limit: T,
    }
}

reals! {
    /// State of [`SingerKf`].
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::SingerKfSettings};
    /// let filter = SingerKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015)).build::<f64>()?;
    /// let mut state = filter.start();
    /// for k in 0..100 {
    ///     filter.step(&mut state, Sample { value: 0.2 * f64::from(k), dt: 0.02 }); // 10 deg/s^2
    /// }
    /// let [rate, acceleration] = state.model.mean;
    /// let coasted = filter.step(&mut state, Sample { value: f64::NAN, dt: 0.02 });
    /// assert!((coasted.rate - (rate + 0.02 * acceleration)).abs() < 1e-4 && (acceleration - 10.0).abs() < 0.1);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct SingerKfState {
        /// Rate and acceleration.
        pub model: Gaussian2<T>,
        /// 1 once a sample has been seen.
        pub started: T,
    }
}

impl<T: Real> Filter<T> for SingerKf<T> {
    type State = SingerKfState<T>;

    fn start(&self) -> Self::State {
        let [rate, acceleration] = self.start_variance;
        SingerKfState {
            model: Gaussian2 { mean: [T::ZERO; 2], covariance: [rate, T::ZERO, acceleration] },
            started: T::ZERO,
        }
    }

    fn accepts(&self, state: &Self::State) -> bool {
        sound::gaussian2(&state.model, sound::reach(self.alpha))
            && sound::flag(state.started)
            && sound::goes_on(self, state, self.limit)
    }

    fn period(&self) -> T {
        self.period_s
    }

    #[inline(always)]
    fn observe<O: Observer<T>>(&self, state: &mut Self::State, sample: Sample<T>, observer: &mut O) -> Estimate<T> {
        let checked = sample.check(self.limit, self.period_s);
        let fresh = state.started == T::ZERO || checked.restart;
        let mut model = state.model;
        if fresh {
            model = self.start().model;
            model.mean[0] = checked.value;
        }
        let dt = T::select(checked.restart, self.period_s, checked.dt);
        let step = if dt == self.period_s { self.step } else { SingerCoefficients::new(self.alpha, dt) };
        let predicted = predict_singer(&model, &step, self.intensity);
        let (updated, evidence) = update2(&predicted, &Reading::plain(checked.value, self.measurement_variance));
        let started = !fresh || checked.present;
        // Nothing moves before the first sample, or where time stands still.
        let next = if checked.present { updated } else { predicted };
        if started && checked.moves {
            state.model = Gaussian2 { mean: next.mean.map(Real::flushed), covariance: next.covariance };
        }
        state.started = T::select(started, T::ONE, T::ZERO);
        observer.model(
            0,
            ModelTrace {
                probability: T::ONE,
                innovation: T::select(checked.present, evidence.innovation, T::of(f64::NAN)),
                innovation_variance: evidence.innovation_variance,
                fading: T::ONE,
                alpha: self.alpha,
                rate: state.model.mean[0],
            },
        );
        Estimate {
            rate: state.model.mean[0],
            acceleration: state.model.mean[1],
            variance: state.model.covariance[0],
            flags: checked.flags.with(Flags::NO_DATA_YET.when(!started)),
        }
    }
}
