//! First-order low-pass ("PT1", the usual flight-controller gyro filter).
//!
//! Backward Euler of y' = 2 pi f_c (z - y): with x = 2 pi f_c dt, the gain is a = x / (1 + x) and y <- y + a (z - y)
//! (the form used by Betaflight and by most textbooks on sampled RC filters).

use crate::error::ConfigError;
use crate::filter::{Estimate, Filter, Flags, Observer, Sample};
use crate::glide::{self, Glide};
use crate::noise::{GyroNoise, RANGE};
use crate::plain;
use crate::ranges;
use crate::real::Real;
use crate::reals;
use crate::reals::Lane;
use crate::settings::{Settings, Visit};
use crate::sound;

/// Settings of [`Pt1`].
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::Pt1Settings};
/// let settings = Pt1Settings::defaults(60.0, GyroNoise::from_density_two_sided(0.01));
/// assert_eq!(settings.cutoff_hz, 15.0); // a quarter of so low a rate
/// assert_eq!(Pt1Settings { cutoff_hz: 0.0, ..settings }.build::<f64>().unwrap_err().field, "cutoff_hz");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Pt1Settings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Cut-off frequency, Hz; default 20 Hz, at most a quarter of the sample rate.
    pub cutoff_hz: f64,
}

impl Settings for Pt1Settings {
    const METHOD: &'static str = "pt1";
    type Filter<T: Real> = Pt1<T>;

    fn defaults(sample_rate_hz: f64, _noise: GyroNoise) -> Self {
        Self { sample_rate_hz, cutoff_hz: 20.0_f64.least(0.25 * sample_rate_hz) }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visitor.number("cutoff_hz", &mut self.cutoff_hz);
    }

    fn build<T: Real>(&self) -> Result<Pt1<T>, ConfigError> {
        Pt1::new(self.sample_rate_hz, self.cutoff_hz)
    }
}

plain! {
    /// First-order low-pass with cut-off `cutoff_hz`; the first sample starts it.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, Sample, filters::Pt1};
    /// let filter = Pt1::<f32>::new(1000.0, 20.0).unwrap();
    /// let mut state = filter.start();
    /// for k in 0..10_000 {
    ///     filter.step(&mut state, Sample { value: (k % 2) as f32, dt: 0.001 });
    /// }
    /// assert!((state.level - 0.5).abs() < 0.07);
    /// ```
    pub struct Pt1<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// Gain at the nominal period.
        pub gain: T,
        /// 2 pi times the cut-off, rad/s.
        pub corner_rad_s: T,
        /// Values beyond this magnitude count as missing.
        pub limit: T,
    }
}

reals! {
    /// State of [`Pt1`].
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, Sample, filters::Pt1};
    /// let filter = Pt1::<f64>::new(50.0, 8.0)?;
    /// let (mut roll, mut pitch) = (filter.start(), filter.start()); // one configuration, two channels
    /// filter.step(&mut roll, Sample { value: 3.0, dt: 0.02 });
    /// filter.step(&mut pitch, Sample { value: -3.0, dt: 0.02 });
    /// assert_eq!((roll.level, pitch.level), (3.0, -3.0));
    /// let saved = roll; // plain data: a copy is a saved state
    /// filter.step(&mut roll, Sample { value: 100.0, dt: 0.02 });
    /// assert_eq!(saved.level, 3.0);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct Pt1State {
        /// The filtered value.
        pub level: T,
        /// 1 once a sample has been seen.
        pub started: T,
    }
}

impl<T: Real> Pt1<T> {
    /// Low-pass for samples at `sample_rate_hz` with -3 dB near `cutoff_hz`.
    ///
    /// # Errors
    /// [`ConfigError`] if either is out of its [range](crate::ranges).
    pub fn new(sample_rate_hz: f64, cutoff_hz: f64) -> Result<Self, ConfigError> {
        ranges::check(&Pt1Settings { sample_rate_hz, cutoff_hz })?;
        let period = 1.0 / sample_rate_hz;
        let corner = core::f64::consts::TAU * cutoff_hz;
        let x = T::of(corner) * T::of(period);
        Ok(Self { period_s: T::of(period), gain: x / (T::ONE + x), corner_rad_s: T::of(corner), limit: T::of(RANGE) })
    }
}

impl<T: Real> Filter<T> for Pt1<T> {
    type State = Pt1State<T>;

    fn start(&self) -> Pt1State<T> {
        Pt1State { level: T::ZERO, started: T::ZERO }
    }

    fn accepts(&self, state: &Pt1State<T>) -> bool {
        sound::at_most(state.level, T::TWO * self.limit) && sound::flag(state.started)
    }

    fn period(&self) -> T {
        self.period_s
    }

    #[inline(always)]
    fn tile<const W: usize>(&self, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
        glide::tile(self, lanes, tile, dt);
    }

    #[inline(always)]
    fn observe<O: Observer<T>>(&self, state: &mut Pt1State<T>, sample: Sample<T>, _observer: &mut O) -> Estimate<T> {
        let checked = sample.check(self.limit, self.period_s);
        state.started = checked.known(state.started);
        let x = self.corner_rad_s * checked.dt;
        let gain = T::select(checked.dt == self.period_s, self.gain, x / (T::ONE + x));
        let fresh = state.started == T::ZERO || checked.restart;
        let moved = state.level + gain * (checked.value - state.level);
        let next = T::select(fresh, checked.value, moved).flushed();
        state.level = T::select(checked.present, next, state.level);
        state.started = T::select(checked.present, T::ONE, state.started);
        Estimate {
            rate: state.level,
            acceleration: T::ZERO,
            variance: T::ZERO,
            flags: checked.flags.with(Flags::NO_DATA_YET.when(state.started == T::ZERO)),
        }
    }
}

impl<T: Real> Glide<T> for Pt1<T> {
    type Wide<const W: usize> = Pt1State<Lane<T, W>>;

    #[inline(always)]
    fn runs(&self, state: &Pt1State<T>) -> bool {
        state.started != T::ZERO
    }
    #[inline(always)]
    fn limit(&self) -> T {
        self.limit
    }
    #[inline(always)]
    fn glide(&self, state: &mut Pt1State<T>, value: T) -> T {
        state.level = state.level + self.gain * (value - state.level);
        state.level
    }
    #[inline(always)]
    fn margin(&self, state: &Pt1State<T>) -> T {
        glide::margin(state.level)
    }
}
