//! Where a record is at rest: second-long windows, their scatter and how far their means move.
//!
//! Two things give motion away. Fast motion raises the scatter s of a window of n samples; slow motion moves its mean.
//! The mean of n white samples is sqrt(n) steadier than one of them, so at high rates a swing that no sample shows
//! (0.5 deg/s of scatter at 1 kHz) still moves means by many times the s sqrt(2 / n) that noise does. A sensor whose
//! noise is low-passed or flickers moves its means more than that: what its steadiest windows do is allowed, too.

use core::ops::Range;

use stillrate::Real;

use super::second_differences::white_sigma;
use crate::statistics::{median, quantile};

/// Length of a window, s, and its fewest samples.
const WINDOW_S: f64 = 1.0;
const WINDOW_LEAST: usize = 32;
/// Fewest windows of a record where it is long enough for that, and fewest samples of a window in a short one.
const WINDOWS: usize = 4;
const SHORTEST: usize = 8;
/// Fewest samples in a window whose second differences are judged alone.
const DIFFERENCES_LEAST: usize = 128;
/// The level of rest is first taken from the quietest windows: one in twenty, at most 3 (5 s at rest hold 4 whole ones).
const QUIETEST: (usize, usize) = (20, 3);
/// Windows scattering more than this many times the level of rest are not quiet.
const QUIET: f64 = 1.6;
/// Scatter of a stretch over what white noise explains, above which it is not rest. (Low-passed and drifting sensors
/// reach 1.5 in the recordings, hand tremor and the least vibration 4 and more.)
pub(super) const REST: f64 = 2.0;
/// Standard deviations by which the mean may move from window to window.
const STEADY: f64 = 5.0;
/// Movements of the mean that are judged together, and the lowest tenth of their root mean square for unit noise.
const TOGETHER: usize = 3;
const LOWEST_TENTH: f64 = 0.5;

/// Second-long windows of a record without gaps: mean and standard deviation of each.
pub(super) struct Windows {
    length: usize,
    mean: Vec<f64>,
    scatter: Vec<f64>,
}

/// The longest stretch at rest, in samples, and how far means may move from window to window at rest.
pub(super) struct Rest {
    pub(super) run: Range<usize>,
    wander: f64,
}

impl Windows {
    pub(super) fn new(z: &[f64], rate: f64) -> Self {
        let wanted = (WINDOW_S * rate).min(1e9) as usize;
        let length = wanted.max(WINDOW_LEAST).min((z.len() / WINDOWS).max(SHORTEST));
        let chunks = z.chunks_exact(length);
        let mean: Vec<f64> = chunks.clone().map(|w| w.iter().sum::<f64>() / length as f64).collect();
        let scatter = chunks
            .zip(&mean)
            .map(|(w, m)| (w.iter().map(|x| (x - m) * (x - m)).sum::<f64>() / (length - 1) as f64).root())
            .collect();
        Self { length, mean, scatter }
    }

    /// The longest run of quiet windows with a steady mean; quantisation alone scatters by `floor`.
    pub(super) fn longest_rest(&self, floor: f64) -> Rest {
        // The least of many estimates, each good to 1 / sqrt(2 n), is low: the run it finds gives a better level.
        let first = self.quietest() * (1.0 + 3.0 / (2.0 * self.length as f64).root());
        let found = self.run_below(first.max(floor));
        self.run_below(self.scatter_in(&found.run).max(floor))
    }

    /// Scatter of the quietest windows; those in which the sensor hung are left out.
    fn quietest(&self) -> f64 {
        let mut alive: Vec<f64> = self.scatter.iter().copied().filter(|s| *s > 0.0).collect();
        alive.sort_unstable_by(f64::total_cmp);
        alive.get((alive.len() / QUIETEST.0).clamp(1, QUIETEST.1) - 1).copied().unwrap_or(0.0)
    }

    fn run_below(&self, level: f64) -> Rest {
        let quiet = |k: usize| self.scatter[k] <= QUIET * level;
        let wander = STEADY * self.wander_at_rest(level);
        let (mut best, mut start) = (0..1, 0);
        for k in 0..self.scatter.len() {
            if !quiet(k) {
                start = k + 1;
            } else if k > start && self.moved(k) > wander {
                start = k;
            }
            if k + 1 > start && k + 1 - start > best.len() {
                best = start..k + 1;
            }
        }
        Rest { run: best.start * self.length..best.end * self.length, wander }
    }

    /// How far the mean moved into window `k`.
    fn moved(&self, k: usize) -> f64 {
        (self.mean[k] - self.mean[k - 1]).magnitude()
    }

    /// Standard deviation of that movement at rest: of white noise, or of the steadiest quiet windows if it is more.
    fn wander_at_rest(&self, level: f64) -> f64 {
        let white = level * (2.0 / self.length as f64).root();
        let groups = (1..self.mean.len().saturating_sub(TOGETHER - 1))
            .filter(|k| self.scatter[k - 1..k + TOGETHER].iter().all(|s| *s <= QUIET * level));
        let mut moves: Vec<f64> = groups
            .map(|k| (k..k + TOGETHER).map(|j| self.moved(j)).map(|d| d * d).sum::<f64>() / TOGETHER as f64)
            .map(Real::root)
            .collect();
        if moves.is_empty() { white } else { white.max(quantile(&mut moves, 0.1) / LOWEST_TENTH) }
    }

    /// Median standard deviation of the windows in a range of samples.
    pub(super) fn scatter_in(&self, samples: &Range<usize>) -> f64 {
        median(&mut self.scatter[samples.start / self.length..samples.end / self.length].to_vec())
    }

    /// White standard deviation of the windows, lowest tenth: motion and vibration only ever add to it.
    pub(super) fn quietest_tenth(&self, z: &[f64], lsb: f64) -> f64 {
        let length = self.length.max(DIFFERENCES_LEAST).min(z.len());
        let mut sigma: Vec<f64> = z.chunks_exact(length).map(|w| white_sigma(w, lsb)).collect();
        // Second differences of n white samples are worth .51 n independent ones: estimates scatter by 1 / sqrt(n), and
        // their lowest tenth lies 1.3 of that below the mean.
        let low = 1.0 - 1.3 / (length as f64).root();
        quantile(&mut sigma, 0.1) / low
    }

    /// Part of the windows that scatter more than noise of this standard deviation, or whose mean moves.
    pub(super) fn moving_fraction(&self, sigma: f64, rest: &Rest) -> f64 {
        let moves = |k: &usize| self.scatter[*k] > REST * sigma || (*k > 0 && self.moved(*k) > rest.wander);
        (0..self.scatter.len()).filter(moves).count() as f64 / self.scatter.len() as f64
    }
}
