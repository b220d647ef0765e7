//! Sage-Husa Kalman filter: a Singer model whose measurement variance R is learnt while it runs.
//!
//! A. P. Sage and G. W. Husa, "Adaptive filtering with unknown prior statistics", Joint Automatic Control Conference 1969, with a fading
//! memory of b: R <- b R + (1 - b) (e^2 + P), where e is the residual after the update and P the variance after it. The
//! usual form takes the innovation nu before the update, nu^2 - P, and can turn negative; this one has the same mean
//! (E e^2 = R - P) and cannot. What one sample may teach is bounded: nu counts at most five of its standard deviations,
//! and R stays within a factor of 1e4 of its start.
//!
//! The tuning is ours: the process noise is that of a rate of bandwidth `bandwidth_hz` under the noise density N,
//! q = N^2 (2 pi f)^4, f = 2 Hz, R starts at N^2 / T, and b = exp(-T / 1 s).

use crate::error::ConfigError;
use crate::filter::{Estimate, Filter, Observer, Sample};
use crate::gaussian::Gaussian2;
use crate::models::SingerCoefficients;
use crate::noise::{GyroNoise, range};
use crate::plain;
use crate::ranges::{self, LARGEST_SWING_DPS};
use crate::real::Real;
use crate::reals;
use crate::settings::{Settings, Visit, visit_noise};
use crate::sound;

/// Settings of [`SageHusaKf`].
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::SageHusaKfSettings};
/// let settings = SageHusaKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015));
/// assert!(settings.build::<f64>().is_ok());
/// let wild = SageHusaKfSettings { bandwidth_hz: 1e4, alpha_per_s: 1e-6, ..settings }; // builds up to more than any rate
/// assert_eq!(wild.build::<f64>().unwrap_err().field, "bandwidth_hz");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SageHusaKfSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Noise of the gyro; its density gives the first measurement variance and scales the process noise.
    pub noise: GyroNoise,
    /// Bandwidth of the motion model, Hz; default 2 Hz, at most a quarter of the sample rate.
    pub bandwidth_hz: f64,
    /// Reciprocal of the manoeuvre time constant, 1/s; default 0.01.
    pub alpha_per_s: f64,
    /// Memory of the measurement variance, s; default 1 s.
    pub memory_s: f64,
}

impl Settings for SageHusaKfSettings {
    const METHOD: &'static str = "sage-husa-kf";
    type Filter<T: Real> = SageHusaKf<T>;

    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        let bandwidth_hz = 2.0_f64.least(0.25 * sample_rate_hz);
        Self { sample_rate_hz, noise, bandwidth_hz, alpha_per_s: 0.01, memory_s: 1.0 }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visit_noise(visitor, &mut self.noise);
        visitor.number("bandwidth_hz", &mut self.bandwidth_hz);
        visitor.number("alpha_per_s", &mut self.alpha_per_s);
        visitor.number("memory_s", &mut self.memory_s);
    }

    fn build<T: Real>(&self) -> Result<SageHusaKf<T>, ConfigError> {
        ranges::check(self)?;
        let (period, density) = (1.0 / self.sample_rate_hz, self.noise.density_dps_sqrt_hz);
        let corner = core::f64::consts::TAU * self.bandwidth_hz;
        let (alpha, memory) = (self.alpha_per_s, self.memory_s);
        let unit = density / period.root();
        // What the motion model builds up to, as in `ranges`: in standard deviations of a sample and in deg/s.
        let swing = corner * corner * (period / (2.0 * alpha)).root() / alpha;
        if !(swing * unit.most(1.0) <= LARGEST_SWING_DPS) {
            let range = "such that bandwidth_hz^2 / alpha_per_s^1.5 gives a motion of at most 1e9 deg/s and 1e9 sigma";
            return Err(ConfigError::new("bandwidth_hz", self.bandwidth_hz, "", range));
        }
        Ok(SageHusaKf {
            period_s: T::of(period),
            alpha_per_s: T::of(alpha),
            model: SingerCoefficients::new(T::of(alpha), T::of(period)),
            drive: T::of(period * corner * corner * corner * corner),
            forgotten: T::of(-(-period / memory).exponential_less_one()),
            memory_s: T::of(memory),
            unit: T::of(unit),
            limit: range(unit),
        })
    }
}

plain! {
    /// Kalman filter with a Singer model and an adaptive measurement variance; the first sample starts it.
    ///
    /// Missing samples are predicted over; an irregular time step gets its own transition and its own share of the memory.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::SageHusaKfSettings};
    /// let settings = SageHusaKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015));
    /// let filter = settings.build::<f64>()?;
    /// let mut state = filter.start();
    /// assert_eq!(filter.step(&mut state, Sample { value: 3.0, dt: 0.02 }).rate, 3.0);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct SageHusaKf<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// Reciprocal of the manoeuvre time constant, 1/s.
        pub alpha_per_s: T,
        /// Singer's model at the nominal period.
        pub model: SingerCoefficients<T>,
        /// Spectral density of the driving noise over the noise variance R of the start, 1/s^5.
        pub drive: T,
        /// Share of the measurement variance that is forgotten in a nominal step.
        pub forgotten: T,
        /// Memory of the measurement variance, s.
        pub memory_s: T,
        /// Measurement standard deviation at the start, deg/s: the unit that the state is kept in.
        pub unit: T,
        /// Values beyond this magnitude count as missing.
        pub limit: T,
    }
}

reals! {
    /// State of [`SageHusaKf`], in units of the measurement standard deviation it started with.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::SageHusaKfSettings};
    /// let noise = GyroNoise::from_standard_deviation_at_rate(0.1, 50.0);
    /// let filter = SageHusaKfSettings::defaults(50.0, noise).build::<f64>()?;
    /// let mut state = filter.start();
    /// assert_eq!(state.measurement_variance, 1.0); // as given
    /// for k in 0..1000 {
    ///     let value = if k % 2 == 0 { 0.4 } else { -0.4 }; // four times the noise that was given
    ///     filter.step(&mut state, Sample { value, dt: 0.02 });
    /// }
    /// assert!((state.measurement_variance / 16.0 - 1.0).abs() < 0.2);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct SageHusaKfState {
        /// Rate.
        pub rate: T,
        /// Its derivative, per second.
        pub acceleration: T,
        /// Variance of the rate.
        pub p11: T,
        /// Covariance of rate and acceleration.
        pub p12: T,
        /// Variance of the acceleration.
        pub p22: T,
        /// Measurement variance R.
        pub measurement_variance: T,
        /// 1 once a sample has been seen.
        pub started: T,
    }
}

/// Standard deviations of the innovation that one sample may teach R at most.
const LARGEST_LESSON: f64 = 5.0;

/// R stays within this factor of where it started: without an upper end, one huge spike makes the filter mistrust all that
/// follows, which then looks like noise to it, and so on for ever.
const LARGEST_CHANGE: f64 = 1e4;

impl<T: Real> Filter<T> for SageHusaKf<T> {
    type State = SageHusaKfState<T>;

    fn start(&self) -> SageHusaKfState<T> {
        SageHusaKfState {
            rate: T::ZERO,
            acceleration: T::ZERO,
            p11: T::ONE,
            p12: T::ZERO,
            p22: self.drive.root(),
            measurement_variance: T::ONE,
            started: T::ZERO,
        }
    }

    fn accepts(&self, state: &SageHusaKfState<T>) -> bool {
        let covariance = [state.p11, state.p12, state.p22];
        let motion = Gaussian2 { mean: [state.rate, state.acceleration], covariance };
        let change = T::of(LARGEST_CHANGE);
        // A state that overflows later is renewed; its estimates, in deg/s, must not.
        let largest = T::LARGEST * T::of(1e-6);
        sound::gaussian2(&motion, T::ZERO)
            && sound::at_most(state.rate * self.unit, largest)
            && sound::at_most(state.acceleration * self.unit, largest)
            && sound::variance(state.p11 * self.unit * self.unit)
            && sound::within(state.measurement_variance, T::ONE / change, change)
            && sound::flag(state.started)
    }

    fn period(&self) -> T {
        self.period_s
    }

    #[inline(always)]
    fn observe<O: Observer<T>>(
        &self,
        state: &mut SageHusaKfState<T>,
        sample: Sample<T>,
        _observer: &mut O,
    ) -> Estimate<T> {
        let checked = sample.check(self.limit, self.period_s);
        state.started = checked.known(state.started);
        let value = checked.value / self.unit;
        // The same for every channel, so the compiler takes the branch out of the loop over channels.
        let (model, forgotten) = if checked.dt == self.period_s {
            (self.model, self.forgotten)
        } else {
            let share = -(-(checked.dt / self.memory_s)).exponential_less_one();
            (SingerCoefficients::new(self.alpha_per_s, checked.dt), share)
        };
        let predicted = predict(state, &model, self.drive);
        let updated = learn(&predicted, value, forgotten);

        let sound = all_finite(&predicted) && all_finite(&updated);
        let first = SageHusaKfState { rate: value, started: T::ONE, ..self.start() };
        let fresh = state.started == T::ZERO || checked.restart;
        let choose = |condition: bool, yes: SageHusaKfState<T>, no: SageHusaKfState<T>| SageHusaKfState {
            rate: T::select(condition, yes.rate, no.rate),
            acceleration: T::select(condition, yes.acceleration, no.acceleration),
            p11: T::select(condition, yes.p11, no.p11),
            p12: T::select(condition, yes.p12, no.p12),
            p22: T::select(condition, yes.p22, no.p22),
            measurement_variance: T::select(condition, yes.measurement_variance, no.measurement_variance),
            started: T::select(condition, yes.started, no.started),
        };
        // Time that did not move predicts nothing.
        let coasted = choose(checked.moves && !fresh, predicted, *state);
        let next =
            choose(checked.present, choose(fresh || !sound, first, updated), choose(sound, coasted, self.start()));
        *state = SageHusaKfState { acceleration: next.acceleration.flushed(), rate: next.rate.flushed(), ..next };
        Estimate {
            rate: state.rate * self.unit,
            acceleration: state.acceleration * self.unit,
            variance: state.p11 * self.unit * self.unit,
            flags: checked.flags_after(state.started, sound),
        }
    }
}

/// Mean and covariance after a step of the motion model.
#[inline(always)]
fn predict<T: Real>(state: &SageHusaKfState<T>, model: &SingerCoefficients<T>, drive: T) -> SageHusaKfState<T> {
    let SingerCoefficients { r, s, q11, q12, q22 } = *model;
    let cross = state.p12 + r * state.p22;
    SageHusaKfState {
        rate: state.rate + r * state.acceleration,
        acceleration: s * state.acceleration,
        p11: state.p11 + r * (state.p12 + cross) + drive * q11,
        p12: s * cross + drive * q12,
        p22: s * s * state.p22 + drive * q22,
        ..*state
    }
}

/// Update with a measurement (Joseph's form, H = [1 0]), then R from what is left of the innovation.
#[inline(always)]
fn learn<T: Real>(predicted: &SageHusaKfState<T>, value: T, forgotten: T) -> SageHusaKfState<T> {
    let r = predicted.measurement_variance;
    let innovation_variance = predicted.p11 + r;
    let (k1, k2) = (predicted.p11 / innovation_variance, predicted.p12 / innovation_variance);
    let rest = r / innovation_variance;
    let innovation = value - predicted.rate;
    let p11 = rest * rest * predicted.p11 + k1 * k1 * r;
    let lesson = (innovation * innovation).least(T::of(LARGEST_LESSON * LARGEST_LESSON) * innovation_variance);
    SageHusaKfState {
        rate: predicted.rate + k1 * innovation,
        acceleration: predicted.acceleration + k2 * innovation,
        p11,
        p12: rest * (predicted.p12 - k2 * predicted.p11) + k1 * k2 * r,
        p22: predicted.p22 - k2 * (predicted.p12 + predicted.p12 - k2 * innovation_variance),
        measurement_variance: (r + forgotten * (rest * rest * lesson + p11 - r))
            .limited(T::of(1.0 / LARGEST_CHANGE), T::of(LARGEST_CHANGE)),
        started: predicted.started,
    }
}

/// Whether every number of the state is finite.
#[inline(always)]
fn all_finite<T: Real>(state: &SageHusaKfState<T>) -> bool {
    (state.rate + state.acceleration + state.p11 + state.p12 + state.p22 + state.measurement_variance).finite()
}
