//! Finite impulse response low-pass: a weighted mean of the last `length` samples ("fir"; the boxcar is the moving mean).
//!
//! y(n) = sum over k of h(k) x(n - k). Group delay (N - 1)/2 samples, at equal noise exactly that of RLS for the boxcar and 1.4 to 2 times it
//! for the other windows.
//!
//! A missing sample is replaced by the output before it. The register starts full of the first sample; `start = "zero"`
//! starts it empty, as most signal-processing packages do.

pub use super::fir_settings::{STARTS, WINDOWS};
use crate::block;
use crate::filter::{Estimate, Filter, Flags, ModelTrace, Observer, Sample};
use crate::plain;
use crate::real::Real;
use crate::reals;
use crate::reals::Reals;
use crate::sound;

/// Most taps a filter can have.
pub const CAPACITY: usize = 128;
/// Sums that run side by side; the order of addition is the same whatever the width of the machine.
pub(super) const LANES: usize = 8;
/// Samples that are filtered between two visits to the register.
const SPAN: usize = 64;

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
        let tile = if lanes.len() < FirLowPassState::<T>::COUNT { &mut [] } else { tile };
        let time = Sample { value: T::ZERO, dt }.check(self.limit, self.period_s);
        for c in 0..W {
            let mut state: FirLowPassState<T> = block::load(lanes, c);
            let mut done = 0;
            while let Some(rest) = tile.get_mut(done..).filter(|rest| !rest.is_empty()) {
                // A few rows, such as those of irregular steps, are not worth the visit.
                let enough = rest.len() >= LANES;
                let ordinary = enough && time.moves && !time.restart && state.started == T::ONE;
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
