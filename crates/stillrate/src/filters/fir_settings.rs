//! Settings of the FIR low-pass, and the taps that follow from them.
//!
//! Taps are scaled to sum to one. Windows are the symmetric textbook ones (Harris, Proc. IEEE 66, 1978; a = 2 pi k/(N - 1)):
//! Hann (1 - cos a)/2, Hamming 0.54 - 0.46 cos a, Blackman 0.42 - 0.5 cos a + 0.08 cos 2a; with a cut-off they shape an ideal low-pass (windowed
//! sinc), without they are the taps themselves.

use core::f64::consts::{PI, TAU};

use super::fir::{CAPACITY, FirLowPass, LANES};
use crate::error::{ConfigError, between};
use crate::noise::{GyroNoise, range};
use crate::ranges;
use crate::real::Real;
use crate::settings::{Settings, Visit, visit_noise};

/// Sum of the taps of a window below which they are nothing but zeros and their rounding errors.
const SMALLEST_SUM: f64 = 1e-9;
/// Windows by name.
pub const WINDOWS: [&str; 4] = ["boxcar", "hann", "hamming", "blackman"];
/// What the register holds before the first sample.
pub const STARTS: [&str; 2] = ["first-sample", "zero"];

/// Settings of [`FirLowPass`].
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::FirLowPassSettings};
/// let settings = FirLowPassSettings::defaults(200.0, GyroNoise::from_density_two_sided(0.01));
/// assert_eq!(settings.length, 40.0); // the noise and the delay of RLS at its default memory of 0.1 s
/// let (taps, count) = settings.designed()?;
/// assert_eq!((taps[39], taps[40], count), (1.0 / 40.0, 0.0, 40));
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FirLowPassSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Noise of the gyro; only the reported variance depends on it.
    pub noise: GyroNoise,
    /// Index into [`WINDOWS`]; default boxcar, the moving mean.
    pub window: usize,
    /// Number of taps, 1 to [`CAPACITY`]; default the noise of RLS with a memory of 0.1 s, as far as there are taps.
    pub length: f64,
    /// Cut-off of a windowed-sinc low-pass, Hz; 0 (default): the window itself is the low-pass.
    pub cutoff_hz: f64,
    /// Taps of your own, newest sample first; they replace window, length and cut-off. None by default.
    pub taps: [f64; CAPACITY],
    /// How many of `taps` there are.
    pub tap_count: usize,
    /// Index into [`STARTS`]; default 0: the first sample fills the register.
    pub start: usize,
}

impl Settings for FirLowPassSettings {
    const METHOD: &'static str = "fir";
    type Filter<T: Real> = FirLowPass<T>;

    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        // Equal noise: N = (1 + lambda)/(1 - lambda) = coth(T / (2 tau)).
        let half = 0.5 / (crate::filters::DEFAULT_TAU_S * sample_rate_hz);
        let length = libm::round(1.0 / half.tangent_hyperbolic()).limited(1.0, CAPACITY as f64);
        let taps = [0.0; CAPACITY];
        Self { sample_rate_hz, noise, window: 0, length, cutoff_hz: 0.0, taps, tap_count: 0, start: 0 }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visit_noise(visitor, &mut self.noise);
        visitor.choice("window", &WINDOWS, &mut self.window);
        visitor.number("length", &mut self.length);
        visitor.number("cutoff_hz", &mut self.cutoff_hz);
        visitor.list("taps", &mut self.taps, &mut self.tap_count);
        visitor.choice("start", &STARTS, &mut self.start);
    }

    fn build<T: Real>(&self) -> Result<FirLowPass<T>, ConfigError> {
        ranges::check(self)?;
        let rate = self.sample_rate_hz;
        let variance = self.noise.sample_variance(rate);
        let (taps, count) = self.designed()?;
        Ok(FirLowPass {
            period_s: T::of(1.0 / rate),
            taps: taps.map(T::of),
            rows: T::of(count.div_ceil(LANES) as f64),
            from_zero: T::select(self.start == 1, T::ONE, T::ZERO),
            variance: T::of(variance * taps.iter().map(|tap| tap * tap).sum::<f64>()),
            limit: range(variance.root()),
        })
    }
}

impl FirLowPassSettings {
    /// The taps in force (newest sample first, zeros after the last) and how many there are.
    ///
    /// # Errors
    /// [`ConfigError`] where length, cut-off or a given tap cannot be used.
    pub fn designed(&self) -> Result<([f64; CAPACITY], usize), ConfigError> {
        if self.tap_count > 0 {
            for &tap in self.taps.iter().take(self.tap_count) {
                ranges::TAP.check("taps", tap)?;
            }
            let used = core::array::from_fn(|k| if k < self.tap_count { self.taps[k] } else { 0.0 });
            return Ok((used, self.tap_count.min(CAPACITY)));
        }
        let length = self.length;
        if !(length >= 1.0 && length <= CAPACITY as f64 && libm::floor(length) == length) {
            return Err(ConfigError::new("length", length, "taps", "a whole number from 1 to 128"));
        }
        let cutoff = ranges::CUTOFF_OR_NONE.check("cutoff_hz", self.cutoff_hz)?;
        if cutoff > 0.0 {
            let range = "0 for the window alone, or below half the sample rate in";
            between("cutoff_hz", cutoff, 0.0, 0.5 * self.sample_rate_hz, "Hz", range)?;
        }
        let count = length as usize;
        let middle = 0.5 * (length - 1.0);
        let raw: [f64; CAPACITY] = core::array::from_fn(|k| {
            let from_middle = k as f64 - middle;
            let ideal = if cutoff > 0.0 { sinc(2.0 * cutoff / self.sample_rate_hz * from_middle) } else { 1.0 };
            if k < count { ideal * window(self.window, k as f64, length) } else { 0.0 }
        });
        let sum: f64 = raw.iter().sum();
        if sum.magnitude() < SMALLEST_SUM {
            return Err(ConfigError::new("length", length, "taps", "at least 3 for this window"));
        }
        Ok((raw.map(|tap| tap / sum), count))
    }
}

/// sin(pi x)/(pi x)
fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { (PI * x).sine_cosine().0 / (PI * x) }
}

/// Value k of a symmetric window of `length` taps.
fn window(kind: usize, k: f64, length: f64) -> f64 {
    if length == 1.0 {
        return 1.0;
    }
    let angle = TAU * k / (length - 1.0);
    let cosine = angle.sine_cosine().1;
    match kind {
        1 => 0.5 - 0.5 * cosine,
        2 => 0.54 - 0.46 * cosine,
        3 => 0.42 - 0.5 * cosine + 0.08 * (2.0 * angle).sine_cosine().1,
        _ => 1.0,
    }
}
