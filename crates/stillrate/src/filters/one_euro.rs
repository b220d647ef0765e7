//! One-euro filter: a first-order low-pass whose cut-off rises with the speed of the signal.
//!
//! G. Casiez, N. Roussel, D. Vogel, "1 Euro filter: a simple speed-based low-pass filter for noisy input in interactive systems",
//! CHI 2012: f_c = f_min + beta |d|, d the derivative of the raw samples through a low-pass of its own (1 Hz);
//! each low-pass has the gain a = x / (1 + x), x = 2 pi f_c dt.

use crate::error::ConfigError;
use crate::filter::{Estimate, Filter, Observer, Sample};
use crate::noise::{GyroNoise, RANGE};
use crate::plain;
use crate::ranges;
use crate::real::Real;
use crate::reals;
use crate::settings::{Settings, Visit};
use crate::sound;

/// Settings of [`OneEuro`].
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::OneEuroSettings};
/// let quiet = OneEuroSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.0151));
/// let noisy = OneEuroSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.151));
/// assert!((quiet.beta - 0.5).abs() < 1e-15 && (noisy.beta - 0.05).abs() < 1e-15); // opens less for what may be noise
/// assert!(quiet.build::<f32>().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct OneEuroSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Cut-off at rest, Hz; default 0.2 Hz.
    pub minimum_cutoff_hz: f64,
    /// Cut-off gained per deg/s^2, Hz; default 0.5 for a density of 0.0151 deg/s/sqrt(Hz), in inverse proportion for others.
    pub beta: f64,
    /// Cut-off for the derivative, Hz; default 1 Hz.
    pub derivative_cutoff_hz: f64,
}

/// beta times the noise density of the default: what was found good at 0.0151 deg/s/sqrt(Hz), made independent of units.
const BETA_TIMES_DENSITY: f64 = 0.5 * 0.0151;

impl Settings for OneEuroSettings {
    const METHOD: &'static str = "one-euro";
    type Filter<T: Real> = OneEuro<T>;

    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        let density = noise.density_dps_sqrt_hz;
        let beta = if density > 0.0 { BETA_TIMES_DENSITY / density } else { 0.5 };
        Self { sample_rate_hz, minimum_cutoff_hz: 0.2, beta, derivative_cutoff_hz: 1.0 }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visitor.number("minimum_cutoff_hz", &mut self.minimum_cutoff_hz);
        visitor.number("beta", &mut self.beta);
        visitor.number("derivative_cutoff_hz", &mut self.derivative_cutoff_hz);
    }

    fn build<T: Real>(&self) -> Result<OneEuro<T>, ConfigError> {
        OneEuro::new(self.sample_rate_hz, self.minimum_cutoff_hz, self.beta, self.derivative_cutoff_hz)
    }
}

plain! {
    /// One-euro filter; the first sample starts it, missing samples hold it.
    ///
    /// After missing samples the derivative and both low-passes use the time since the last sample that was there.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, Sample, filters::OneEuro};
    /// let filter = OneEuro::<f64>::new(50.0, 0.2, 0.5, 1.0)?;
    /// let mut state = filter.start();
    /// assert_eq!(filter.step(&mut state, Sample { value: 3.0, dt: 0.02 }).rate, 3.0);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct OneEuro<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// 2 pi times the cut-off at rest, rad/s.
        pub minimum_corner_rad_s: T,
        /// 2 pi times beta, rad/s per deg/s^2.
        pub corner_per_speed: T,
        /// 2 pi times the cut-off for the derivative, rad/s.
        pub derivative_corner_rad_s: T,
        /// Values beyond this magnitude count as missing.
        pub limit: T,
    }
}

reals! {
    /// State of [`OneEuro`].
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, Sample, filters::OneEuro};
    /// let filter = OneEuro::<f64>::new(50.0, 0.2, 0.5, 1.0)?;
    /// let mut state = filter.start();
    /// for value in [3.0, f64::NAN, f64::NAN] {
    ///     filter.step(&mut state, Sample { value, dt: 0.02 });
    /// }
    /// assert_eq!((state.level, state.raw, state.since), (3.0, 3.0, 0.04)); // held for two periods
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct OneEuroState {
        /// The filtered value.
        pub level: T,
        /// The filtered derivative, per second.
        pub slope: T,
        /// The last raw sample.
        pub raw: T,
        /// Time since then, s.
        pub since: T,
        /// 1 once a sample has been seen.
        pub started: T,
    }
}

impl<T: Real> OneEuro<T> {
    /// Filter for samples at `sample_rate_hz`.
    ///
    /// # Errors
    /// [`ConfigError`] if one of them is out of its [range](crate::ranges).
    pub fn new(
        sample_rate_hz: f64,
        minimum_cutoff_hz: f64,
        beta: f64,
        derivative_cutoff_hz: f64,
    ) -> Result<Self, ConfigError> {
        ranges::check(&OneEuroSettings { sample_rate_hz, minimum_cutoff_hz, beta, derivative_cutoff_hz })?;
        let turn = core::f64::consts::TAU;
        Ok(Self {
            period_s: T::of(1.0 / sample_rate_hz),
            minimum_corner_rad_s: T::of(turn * minimum_cutoff_hz),
            corner_per_speed: T::of(turn * beta),
            derivative_corner_rad_s: T::of(turn * derivative_cutoff_hz),
            limit: T::of(RANGE),
        })
    }
}

/// Gain of a first-order low-pass over a time step.
#[inline(always)]
fn gain<T: Real>(corner: T, dt: T) -> T {
    // Beyond the inverse precision the gain is 1, and infinity over infinity is avoided.
    let x = (corner * dt).least(T::ONE / T::EPSILON);
    x / (T::ONE + x)
}

impl<T: Real> Filter<T> for OneEuro<T> {
    type State = OneEuroState<T>;

    fn start(&self) -> OneEuroState<T> {
        OneEuroState { level: T::ZERO, slope: T::ZERO, raw: T::ZERO, since: T::ZERO, started: T::ZERO }
    }

    fn accepts(&self, state: &OneEuroState<T>) -> bool {
        sound::at_most(state.level, T::TWO * self.limit)
            && sound::at_most(state.slope, T::TWO * self.limit * self.limit)
            && sound::at_most(state.raw, self.limit)
            && sound::within(state.since, T::ZERO, T::LARGEST.root())
            && sound::flag(state.started)
    }

    fn period(&self) -> T {
        self.period_s
    }

    #[inline(always)]
    fn observe<O: Observer<T>>(
        &self,
        state: &mut OneEuroState<T>,
        sample: Sample<T>,
        _observer: &mut O,
    ) -> Estimate<T> {
        let checked = sample.check(self.limit, self.period_s);
        state.started = checked.known(state.started);
        let since = (state.since + T::select(checked.moves, checked.dt, T::ZERO)).least(T::LARGEST.root());
        let steepest = self.limit * self.limit;
        let raw_slope = ((checked.value - state.raw) / since.most(T::TINY)).limited(-steepest, steepest);
        let slope = state.slope + gain(self.derivative_corner_rad_s, since) * (raw_slope - state.slope);
        let corner = self.minimum_corner_rad_s + self.corner_per_speed * slope.magnitude();
        let level = state.level + gain(corner, since) * (checked.value - state.level);

        let sound = level.finite() && slope.finite() && since.finite();
        let fresh = state.started == T::ZERO || checked.restart || !sound;
        let used = checked.present || !sound;
        state.level = T::select(used, T::select(fresh, checked.value, level).flushed(), state.level);
        state.slope = T::select(used, T::select(fresh, T::ZERO, slope).flushed(), state.slope);
        state.raw = T::select(used, checked.value, state.raw);
        state.since = T::select(used, T::ZERO, since);
        state.started = T::select(used, T::select(checked.present, T::ONE, T::ZERO), state.started);
        Estimate {
            rate: state.level,
            acceleration: state.slope,
            variance: T::ZERO,
            flags: checked.flags_after(state.started, sound),
        }
    }
}
