//! Finite impulse response low-pass: a weighted mean of the last `length` samples ("fir"; the boxcar is the moving mean).
//!
//! y(n) = sum over k of h(k) x(n - k), taps scaled to sum to one. Windows are the symmetric textbook ones (Harris, Proc. IEEE 66, 1978; a = 2 pi k/(N - 1)):
//! Hann (1 - cos a)/2, Hamming 0.54 - 0.46 cos a, Blackman 0.42 - 0.5 cos a + 0.08 cos 2a; with a cut-off they shape an ideal low-pass (windowed
//! sinc), without they are the taps themselves. Group delay (N - 1)/2 samples, at equal noise exactly that of RLS for the boxcar
//! and 1.4 to 2 times it for the others.
//!
//! A missing sample is replaced by the output before it. The register starts full of the first sample; `start = "zero"`
//! starts it empty, as most signal-processing packages do.

use core::f64::consts::{PI, TAU};

use crate::block;
use crate::error::{ConfigError, between};
use crate::filter::{Estimate, Filter, Flags, ModelTrace, Observer, Sample};
use crate::noise::{GyroNoise, range};
use crate::plain;
use crate::ranges;
use crate::real::Real;
use crate::reals;
use crate::settings::{Settings, Visit, visit_noise};
use crate::sound;

/// Most taps a filter can have.
pub const CAPACITY: usize = 128;
/// Sums that run side by side; the order of addition is the same whatever the width of the machine.
const LANES: usize = 8;
/// Samples that are filtered between two visits to the register.
const SPAN: usize = 64;
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

plain! {
    /// Weighted mean of the last samples.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::FirLowPassSettings};
    /// let noise = GyroNoise::from_density_two_sided(0.01);
    /// let filter = FirLowPassSettings { length: 3.0, ..FirLowPassSettings::defaults(200.0, noise) }.build::<f64>()?;
    /// let mut state = filter.start();
    /// let mut last = 0.0;
    /// for value in [3.0, 3.0, 0.0] {
    ///     last = filter.step(&mut state, Sample { value, dt: 0.005 }).rate;
    /// }
    /// assert!((last - 2.0).abs() < 1e-15);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct FirLowPass<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// Taps, newest sample first, zeros after the last.
        pub taps: [T; CAPACITY],
        /// Rows of eight taps in use.
        pub rows: T,
        /// 1 where the register starts at zero instead of at the first sample.
        pub from_zero: T,
        /// Variance of the output, (deg/s)^2.
        pub variance: T,
        /// Values beyond this magnitude count as missing.
        pub limit: T,
    }
}

reals! {
    /// State of [`FirLowPass`].
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::FirLowPassSettings};
    /// let noise = GyroNoise::from_density_two_sided(0.01);
    /// let filter = FirLowPassSettings { length: 4.0, ..FirLowPassSettings::defaults(200.0, noise) }.build::<f64>()?;
    /// let mut state = filter.start();
    /// for value in [3.0, 7.0, f64::NAN] {
    ///     filter.step(&mut state, Sample { value, dt: 0.005 });
    /// }
    /// assert_eq!(state.samples[..4], [4.0, 7.0, 3.0, 3.0]); // newest first; the output stood in for the one that was missing
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct FirLowPassState {
        /// Samples, newest first.
        pub samples: [T; CAPACITY],
        /// The last output.
        pub output: T,
        /// 1 once a sample has been seen.
        pub started: T,
    }
}

impl<T: Real> FirLowPass<T> {
    /// sum h(k) x(n - k), in eight sums side by side and then from the first to the last.
    #[inline(always)]
    fn convolve(&self, samples: &[T; CAPACITY]) -> T {
        let mut sums = [T::ZERO; LANES];
        let rows = self.rows.widen() as usize;
        for (taps, samples) in self.taps.chunks_exact(LANES).zip(samples.chunks_exact(LANES)).take(rows) {
            for (sum, (&tap, &sample)) in sums.iter_mut().zip(taps.iter().zip(samples)) {
                *sum += tap * sample;
            }
        }
        sums.into_iter().fold(T::ZERO, |total, sum| total + sum)
    }

    /// [`Self::convolve`] for outputs one before the other: the same sums of each, side by side. `line` holds samples, newest first;
    /// the first output begins with its first one.
    #[inline(always)]
    fn convolve_along(&self, line: &[T; CAPACITY + LANES]) -> [T; LANES] {
        let rows = (self.rows.widen() as usize).min(CAPACITY / LANES);
        let mut totals = [T::ZERO; LANES];
        for lane in 0..LANES {
            let mut sums = [T::ZERO; LANES];
            for row in 0..rows {
                let age = row * LANES + lane;
                let tap = self.taps[age];
                for k in 0..LANES {
                    sums[k] += tap * line[age + k];
                }
            }
            for k in 0..LANES {
                totals[k] += sums[k];
            }
        }
        totals
    }

    /// Filters as many samples as are ordinary, [`SPAN`] at most, in column `c` of a tile, and returns their number.
    #[inline(always)]
    fn along<const W: usize>(&self, state: &mut FirLowPassState<T>, tile: &mut [[T; W]], c: usize) -> usize {
        let mut line = [T::ZERO; SPAN + CAPACITY];
        line[SPAN..].copy_from_slice(&state.samples);
        let mut count = 0;
        for (place, row) in
            line[..SPAN].iter_mut().rev().zip(&*tile).take_while(|(_, row)| row[c].magnitude() <= self.limit)
        {
            *place = row[c];
            count += 1;
        }
        for (block, rows) in tile[..count].chunks_mut(LANES).enumerate() {
            let Some(window) = line.get(SPAN - LANES - block * LANES..).and_then(<[T]>::first_chunk) else { break };
            for (row, output) in rows.iter_mut().zip(self.convolve_along(window).into_iter().rev()) {
                row[c] = output.flushed();
                state.output = row[c];
            }
        }
        state.samples.copy_from_slice(&line[SPAN - count..][..CAPACITY]);
        count
    }
}

impl<T: Real> Filter<T> for FirLowPass<T> {
    type State = FirLowPassState<T>;
    const SIDE_BY_SIDE: bool = false;

    fn start(&self) -> FirLowPassState<T> {
        FirLowPassState { samples: [T::ZERO; CAPACITY], output: T::ZERO, started: T::ZERO }
    }

    fn accepts(&self, state: &FirLowPassState<T>) -> bool {
        let largest = self.taps.iter().fold(T::ZERO, |sum, tap| sum + tap.magnitude()) * self.limit;
        state.samples.iter().all(|&sample| sound::at_most(sample, self.limit))
            && sound::at_most(state.output, T::of(1.001) * largest)
            && sound::flag(state.started)
    }

    fn period(&self) -> T {
        self.period_s
    }

    #[inline(always)]
    fn observe<O: Observer<T>>(
        &self,
        state: &mut FirLowPassState<T>,
        sample: Sample<T>,
        observer: &mut O,
    ) -> Estimate<T> {
        let checked = sample.check(self.limit, self.period_s);
        state.started = checked.known(state.started);
        let innovation = T::select(checked.present, checked.value - state.output, T::of(f64::NAN));
        // Taps that amplify would otherwise feed on their own output for ever.
        let held = state.output.limited(-self.limit, self.limit);
        let value = T::select(checked.present, checked.value, held);
        let fresh = checked.present && (state.started == T::ZERO || checked.restart);
        if fresh {
            state.samples = [T::select(self.from_zero == T::ONE, T::ZERO, value); CAPACITY];
        }
        // Time passes for a missing sample too, but not where the clock stood still or before any data.
        if checked.moves && (fresh || state.started == T::ONE) {
            state.samples.copy_within(0..CAPACITY - 1, 1);
            state.samples[0] = value;
            state.started = T::ONE;
            state.output = self.convolve(&state.samples).flushed();
        }
        let rate = state.output;
        let trace = ModelTrace { probability: T::ONE, innovation, fading: T::ONE, rate, ..ModelTrace::default() };
        observer.model(0, trace);
        Estimate {
            rate,
            acceleration: T::ZERO,
            variance: self.variance,
            flags: checked.flags.with(Flags::NO_DATA_YET.when(state.started == T::ZERO)),
        }
    }

    #[inline(always)]
    fn tile<const W: usize>(&self, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
        let time = Sample { value: T::ZERO, dt }.check(self.limit, self.period_s);
        for c in 0..W {
            let mut state: FirLowPassState<T> = block::load(lanes, c);
            let mut done = 0;
            while let Some(rest) = tile.get_mut(done..).filter(|rest| !rest.is_empty()) {
                let ordinary = time.moves && !time.restart && state.started == T::ONE;
                let along = if ordinary { self.along(&mut state, rest, c) } else { 0 };
                done += along;
                if let (0, Some(row)) = (along, rest.first_mut()) {
                    row[c] = self.step(&mut state, Sample { value: row[c], dt }).rate;
                    done += 1;
                }
            }
            block::store(&state, lanes, c);
        }
    }
}
