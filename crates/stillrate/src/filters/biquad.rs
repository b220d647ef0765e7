//! Second-order low-pass ("biquad"): an analogue filter made digital by the bilinear transform with prewarping.
//!
//! H(s) = w_c^2 / (s^2 + w_c s / Q + w_c^2) with s -> w_c (z - 1)/(z + 1) / tan(pi f_c T): the transfer function of the usual cookbook
//! biquad; Q = 1/sqrt 2 makes it Butterworth. It is computed as two trapezoidal integrators in a loop (the state-variable form of
//! the same transfer function) rather than in direct form II transposed: there a constant comes out as exactly that constant,
//! where direct form in `f32` is off by 2e-4 for a cut-off at a 400th of the sample rate, and the states keep their
//! meaning when the time step changes.

use crate::error::{ConfigError, between};
use crate::filter::{Estimate, Filter, Observer, Sample};
use crate::glide::{self, Glide};
use crate::noise::{GyroNoise, RANGE};
use crate::plain;
use crate::ranges;
use crate::real::Real;
use crate::reals;
use crate::reals::Lane;
use crate::settings::{Settings, Visit};
use crate::sound;

/// Settings of [`Biquad`].
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::BiquadSettings};
/// let settings = BiquadSettings::defaults(1000.0, GyroNoise::from_density_two_sided(0.01));
/// assert_eq!(settings.quality, 0.5_f64.sqrt()); // Butterworth: -3 dB at the cut-off
/// let refusal = BiquadSettings { cutoff_hz: 480.0, ..settings }.build::<f64>().unwrap_err();
/// assert_eq!(refusal.to_string(), "cutoff_hz = 480 (must be above 0 and below 0.477 of sample_rate_hz in Hz)");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BiquadSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Cut-off frequency, Hz; default 20 Hz, at most a quarter of the sample rate.
    pub cutoff_hz: f64,
    /// Quality factor; default 1/sqrt 2 (Butterworth).
    pub quality: f64,
}

impl Settings for BiquadSettings {
    const METHOD: &'static str = "biquad";
    type Filter<T: Real> = Biquad<T>;

    fn defaults(sample_rate_hz: f64, _noise: GyroNoise) -> Self {
        let cutoff_hz = 20.0_f64.least(0.25 * sample_rate_hz);
        Self { sample_rate_hz, cutoff_hz, quality: core::f64::consts::FRAC_1_SQRT_2 }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visitor.number("cutoff_hz", &mut self.cutoff_hz);
        visitor.number("quality", &mut self.quality);
    }

    fn build<T: Real>(&self) -> Result<Biquad<T>, ConfigError> {
        Biquad::new(self.sample_rate_hz, self.cutoff_hz, self.quality)
    }
}

plain! {
    /// Second-order low-pass; starts in the steady state of its first sample and holds its output over missing ones.
    ///
    /// A time step that differs from the nominal one gets its own coefficients, with the cut-off kept below half the rate.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, Sample, filters::Biquad};
    /// let filter = Biquad::<f64>::new(1000.0, 20.0, core::f64::consts::FRAC_1_SQRT_2)?;
    /// let mut state = filter.start();
    /// assert_eq!(filter.step(&mut state, Sample { value: 3.0, dt: 0.001 }).rate, 3.0);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct Biquad<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// pi times the cut-off, rad/s.
        pub half_corner_rad_s: T,
        /// 1 / quality.
        pub damping: T,
        /// Gains of the loop at the nominal period.
        pub gains: [T; 3],
        /// Values beyond this magnitude count as missing.
        pub limit: T,
    }
}

reals! {
    /// State of [`Biquad`].
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, Sample, filters::Biquad};
    /// let filter = Biquad::<f64>::new(1000.0, 20.0, 0.7)?;
    /// let mut state = filter.start();
    /// filter.step(&mut state, Sample { value: 3.0, dt: 0.001 });
    /// assert_eq!((state.slope, state.level, state.output), (0.0, 3.0, 3.0)); // at rest in its first sample
    /// filter.step(&mut state, Sample { value: 4.0, dt: 0.001 });
    /// assert!(state.slope > 0.0 && state.output < state.level); // the output stands halfway between two levels
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct BiquadState {
        /// First integrator (band-pass).
        pub slope: T,
        /// Second integrator (low-pass).
        pub level: T,
        /// Last output.
        pub output: T,
        /// 1 once a sample has been seen.
        pub started: T,
    }
}

/// The largest prewarped angle, rad: a cut-off of 0.48 sample rates.
const LARGEST_ANGLE: f64 = 1.5;

/// Gains of the loop for an angle pi f_c T.
#[inline(always)]
fn gains<T: Real>(angle: T, damping: T) -> [T; 3] {
    let (sine, cosine) = angle.least(T::of(LARGEST_ANGLE)).sine_cosine();
    let tangent = sine / cosine;
    let first = T::ONE / (T::ONE + tangent * (tangent + damping));
    let twice = T::TWO * tangent * first;
    [T::TWO * first - T::ONE, twice, tangent * twice]
}

/// Both integrators over one period: their new values, and the output halfway between the old and the new level.
#[inline(always)]
fn advance<T: Real>([keep, across, follow]: [T; 3], state: &BiquadState<T>, value: T) -> [T; 3] {
    let drive = value - state.level;
    let rise = across * state.slope + follow * drive;
    [keep * state.slope + across * drive, state.level + rise, state.level + T::HALF * rise]
}

impl<T: Real> Biquad<T> {
    /// Low-pass for samples at `sample_rate_hz`; at `cutoff_hz` the gain is `quality`.
    ///
    /// # Errors
    /// [`ConfigError`] if the cut-off is not above 0 and below 0.477 of the sample rate or the quality not in 0.05..=100.
    pub fn new(sample_rate_hz: f64, cutoff_hz: f64, quality: f64) -> Result<Self, ConfigError> {
        ranges::check(&BiquadSettings { sample_rate_hz, cutoff_hz, quality })?;
        let period = 1.0 / sample_rate_hz;
        let range = "above 0 and below 0.477 of sample_rate_hz in";
        // The tangent of the prewarping has lost its meaning beyond.
        let highest = LARGEST_ANGLE / core::f64::consts::PI * sample_rate_hz;
        let cutoff = between("cutoff_hz", cutoff_hz, 0.0, highest, "Hz", range)?;
        let half_corner = core::f64::consts::PI * cutoff;
        Ok(Self {
            period_s: T::of(period),
            half_corner_rad_s: T::of(half_corner),
            damping: T::of(1.0 / quality),
            gains: gains(half_corner * period, 1.0 / quality).map(T::of),
            limit: T::of(RANGE),
        })
    }
}

impl<T: Real> Filter<T> for Biquad<T> {
    type State = BiquadState<T>;

    fn start(&self) -> BiquadState<T> {
        BiquadState { slope: T::ZERO, level: T::ZERO, output: T::ZERO, started: T::ZERO }
    }

    fn accepts(&self, state: &BiquadState<T>) -> bool {
        // A loop of quality 100 rings this high at most.
        let most = T::of(1e4) * self.limit;
        [state.slope, state.level, state.output].iter().all(|&x| sound::at_most(x, most)) && sound::flag(state.started)
    }

    fn period(&self) -> T {
        self.period_s
    }

    #[inline(always)]
    fn tile<const W: usize>(&self, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
        glide::tile(self, lanes, tile, dt);
    }

    #[inline(always)]
    fn observe<O: Observer<T>>(&self, state: &mut BiquadState<T>, sample: Sample<T>, _observer: &mut O) -> Estimate<T> {
        let checked = sample.check(self.limit, self.period_s);
        state.started = checked.known(state.started);
        // The same for every channel, so the compiler takes the branch out of the loop over channels.
        let gains = if checked.dt == self.period_s {
            self.gains
        } else {
            gains(self.half_corner_rad_s * checked.dt, self.damping)
        };
        let moved = advance(gains, state, checked.value);
        let sound = state.slope.finite() && state.level.finite() && moved[0].finite() && moved[1].finite();
        let fresh = state.started == T::ZERO || checked.restart || !sound;
        let start = [T::ZERO, checked.value, checked.value];
        let used = checked.present || !sound;
        let choose = |k: usize, held: T| T::select(used, T::select(fresh, start[k], moved[k]).flushed(), held);
        state.slope = choose(0, state.slope);
        state.level = choose(1, state.level);
        state.output = choose(2, state.output);
        state.started = T::select(used, T::select(checked.present, T::ONE, T::ZERO), state.started);
        Estimate {
            rate: state.output,
            acceleration: T::ZERO,
            variance: T::ZERO,
            flags: checked.flags_after(state.started, sound),
        }
    }
}

impl<T: Real> Glide<T> for Biquad<T> {
    type Wide<const W: usize> = BiquadState<Lane<T, W>>;

    #[inline(always)]
    fn runs(&self, state: &BiquadState<T>) -> bool {
        (state.started != T::ZERO) & state.slope.finite() & state.level.finite()
    }
    #[inline(always)]
    fn limit(&self) -> T {
        self.limit
    }
    #[inline(always)]
    fn glide(&self, state: &mut BiquadState<T>, value: T) -> T {
        let [slope, level, output] = advance(self.gains, state, value);
        *state = BiquadState { slope, level, output, started: state.started };
        output
    }
    #[inline(always)]
    fn margin(&self, state: &BiquadState<T>) -> T {
        // Both integrators are finite only if every number before was.
        let sound = state.slope.finite() & state.level.finite();
        let least = glide::margin(state.slope).least(glide::margin(state.level)).least(glide::margin(state.output));
        T::select(sound, least, T::ZERO)
    }
}
