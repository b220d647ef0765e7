//! A record to calibrate from, and the line that turns the samples around an epoch into one measurement.
//!
//! Commands hold over an interval T; the accelerometers are sampled a whole number of times in it. Around epoch k the samples
//! t_k + j dT, |j| <= half, minus a predicted output, lie on a straight line; its intercept is the measurement residual at
//! t_k with variance sigma^2 sum j^2 / (n sum j^2 - (sum j)^2). The robust form looks for the line by the median of all
//! pairwise slopes (Theil 1950, Sen 1968), drops what is farther than six sigma from it, and fits the rest. A missing sample is
//! left out; where fewer than three remain of a window that has three or more, the axis is skipped.

use crate::error::{ConfigError, positive};
use crate::real::Real;

/// Most samples to either side of an epoch.
pub const HALF_WINDOW_MAX: usize = 8;
const WINDOW: usize = 2 * HALF_WINDOW_MAX + 1;
/// A sample farther than this many sigma from the robust line is a spike.
const SPIKE_SIGMA: f64 = 6.0;
/// Where no residual of the least-squares line exceeds this many sigma, no sample can be beyond [`SPIKE_SIGMA`] from
/// the robust one, so the search for it is spared.
const CALM_SIGMA: f64 = 2.0;

/// Commands and accelerometer samples of a run, borrowed from the caller.
///
/// # Example
/// ```
/// use stillrate::gimbal::Record;
/// let command = [[0.0; 3]; 2];
/// let samples = [[0.0, 9.8, 0.0]; 11];
/// let record = Record::new(&command, &samples, 0.25, 1e-6).unwrap();
/// assert_eq!((record.per_interval(), record.epochs()), (5, 2));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<'a> {
    command: &'a [[f64; 3]],
    samples: &'a [[f64; 3]],
    interval_s: f64,
    sigma: f64,
    per_interval: usize,
    half: usize,
}

/// One measurement an axis: value and variance; an infinite variance says that there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Value (of the output or of a residual), m/s^2.
    pub value: [f64; 3],
    /// Variance, (m/s^2)^2.
    pub variance: [f64; 3],
}

impl Measurement {
    /// No measurement.
    pub const NONE: Self = Self { value: [0.0; 3], variance: [f64::INFINITY; 3] };
}

impl<'a> Record<'a> {
    /// A record of n commands (rad/s, each held for `interval_s`) and n m + 1 samples (m/s^2, white noise `sigma_m_s2` each).
    ///
    /// # Errors
    /// [`ConfigError`] if the lengths do not fit or the numbers are not positive.
    pub fn new(
        command: &'a [[f64; 3]],
        samples: &'a [[f64; 3]],
        interval_s: f64,
        sigma_m_s2: f64,
    ) -> Result<Self, ConfigError> {
        positive("dt_s", interval_s, "s")?;
        positive("sigma_m_s2", sigma_m_s2, "m/s^2")?;
        let (n, samples_after_first) = (command.len(), samples.len().saturating_sub(1));
        if n == 0 || samples_after_first == 0 || !samples_after_first.is_multiple_of(n) {
            return Err(ConfigError::new(
                "samples",
                samples.len() as f64,
                "",
                "a whole number of samples for each command, and one more",
            ));
        }
        let per_interval = samples_after_first / n;
        let half = (per_interval - 1) / 2;
        let half = if half > HALF_WINDOW_MAX { HALF_WINDOW_MAX } else { half };
        Ok(Self { command, samples, interval_s, sigma: sigma_m_s2, per_interval, half })
    }

    /// Number of epochs k = 1..=n.
    #[must_use]
    pub const fn epochs(&self) -> usize {
        self.command.len()
    }
    /// Accelerometer samples in one command interval.
    #[must_use]
    pub const fn per_interval(&self) -> usize {
        self.per_interval
    }
    /// Command interval T, s.
    #[must_use]
    pub const fn interval_s(&self) -> f64 {
        self.interval_s
    }
    /// Noise of one sample, m/s^2.
    #[must_use]
    pub const fn sigma(&self) -> f64 {
        self.sigma
    }
    /// The same record with windows of `half` samples to either side (0: single samples).
    #[must_use]
    pub const fn with_half_window(mut self, half: usize) -> Self {
        let most = (self.per_interval - 1) / 2;
        let most = if most > HALF_WINDOW_MAX { HALF_WINDOW_MAX } else { most };
        self.half = if half > most { most } else { half };
        self
    }
    /// Samples to either side of an epoch.
    #[must_use]
    pub const fn half_window(&self) -> usize {
        self.half
    }
    /// Time of sample `j` of a window from its epoch, s.
    #[must_use]
    #[inline(always)]
    pub fn offset_s(&self, j: isize) -> f64 {
        j as f64 * self.interval_s / self.per_interval as f64
    }
    /// Command of interval `k` (from epoch k to k + 1), the last usable one where it is not finite.
    #[must_use]
    #[inline]
    pub fn command(&self, k: usize) -> [f64; 3] {
        if let Some(w) = self.command.get(k)
            && w.iter().all(|x| x.finite())
        {
            return *w;
        }
        let before = self.command.get(..=k).unwrap_or(self.command);
        before.iter().rev().find(|w| w.iter().all(|x| x.finite())).copied().unwrap_or([0.0; 3])
    }
    /// Whether the command jumps by more than `limit_rad_s` at epoch `k`.
    #[must_use]
    pub fn jumps(&self, k: usize, limit_rad_s: f64) -> bool {
        if k == 0 || k >= self.command.len() {
            return false;
        }
        let (a, b) = (self.command(k - 1), self.command(k));
        let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).root() > limit_rad_s
    }
    /// The sample at an offset from an epoch, if it was recorded.
    #[must_use]
    #[inline(always)]
    pub fn sample(&self, k: usize, j: isize) -> Option<&[f64; 3]> {
        (k * self.per_interval).checked_add_signed(j).and_then(|at| self.samples.get(at))
    }

    /// Intercept of samples minus `predicted(j)` around epoch `k`, with its variance.
    #[inline(always)]
    pub fn intercept(&self, k: usize, robust: bool, mut predicted: impl FnMut(isize) -> [f64; 3]) -> Measurement {
        let mut difference = [[0.0; WINDOW]; 3];
        let mut place = [0.0; WINDOW];
        let mut n = 0;
        let half = self.half as isize;
        for j in -half..=half {
            if let (Some(sample), Some(at)) = (self.sample(k, j), place.get_mut(n)) {
                let model = predicted(j);
                *at = j as f64;
                for axis in 0..3 {
                    difference[axis][n] = sample[axis] - model[axis];
                }
                n += 1;
            }
        }
        let mut measurement = Measurement::NONE;
        for axis in 0..3 {
            // The common case: a full window without a spike.
            let full = if n == self.half * 2 + 1 { calm(&difference[axis], self.half, self.sigma) } else { None };
            if let Some(value) = full {
                measurement.value[axis] = value;
                measurement.variance[axis] = self.sigma * self.sigma / n as f64;
            } else if let Some((value, factor)) = line(&place, &difference[axis], n, self.sigma, robust) {
                measurement.value[axis] = value;
                measurement.variance[axis] = factor * self.sigma * self.sigma;
            }
        }
        measurement
    }
}

/// Intercept of the least-squares line through a full window, its middle value, if all samples are there and none is far from the line.
#[inline(always)]
fn calm(y: &[f64; WINDOW], half: usize, sigma: f64) -> Option<f64> {
    let n = 2 * half + 1;
    let y = y.get(..n)?;
    let (mut sum, mut slope, mut square) = (0.0, 0.0, 0.0);
    for (i, y) in y.iter().enumerate() {
        let j = i as f64 - half as f64;
        sum += y;
        slope += j * y;
        square += j * j;
    }
    let middle = sum / n as f64;
    let slope = if half > 0 { slope / square } else { 0.0 };
    let mut quiet = true;
    for (i, y) in y.iter().enumerate() {
        let j = i as f64 - half as f64;
        quiet &= (y - middle - slope * j).magnitude() <= CALM_SIGMA * sigma;
    }
    quiet.then_some(middle)
}

/// Least-squares line through the marked points: intercept, slope and variance factor of the intercept.
#[inline(always)]
fn least_squares(x: &[f64; WINDOW], y: &[f64; WINDOW], keep: &[bool; WINDOW], n: usize) -> Option<(f64, f64, f64)> {
    let (mut s0, mut s1, mut s2, mut t0, mut t1) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for i in 0..n.min(WINDOW) {
        if keep[i] {
            s0 += 1.0;
            s1 += x[i];
            s2 += x[i] * x[i];
            t0 += y[i];
            t1 += x[i] * y[i];
        }
    }
    let determinant = s0 * s2 - s1 * s1;
    if determinant > 0.0 {
        Some(((s2 * t0 - s1 * t1) / determinant, (s0 * t1 - s1 * t0) / determinant, s2 / determinant))
    } else if s0 > 0.0 && n == 1 {
        Some((t0, 0.0, 1.0))
    } else {
        None
    }
}

/// Middle value of the first `n` numbers (sorts them).
fn median<const M: usize>(values: &mut [f64; M], n: usize) -> f64 {
    let used = values.get_mut(..n).unwrap_or(&mut []);
    // NaN cannot occur: only finite samples come here.
    used.sort_unstable_by(f64::total_cmp);
    let (low, high) = (used.get(n.saturating_sub(1) / 2), used.get(n / 2));
    match (low, high) {
        (Some(a), Some(b)) => 0.5 * (a + b),
        _ => 0.0,
    }
}

/// Intercept and its variance factor; nothing where too few points remain.
fn line(x: &[f64; WINDOW], y: &[f64; WINDOW], n: usize, sigma: f64, robust: bool) -> Option<(f64, f64)> {
    let mut keep = [false; WINDOW];
    let mut present = 0;
    for i in 0..n.min(WINDOW) {
        keep[i] = y[i].finite();
        present += usize::from(keep[i]);
    }
    if present < n.min(3) {
        return None;
    }
    let (intercept, slope, factor) = least_squares(x, y, &keep, n)?;
    let off = |i: usize, a: f64, b: f64| (y[i] - a - b * x[i]).magnitude();
    let calm = (0..n.min(WINDOW)).all(|i| !keep[i] || off(i, intercept, slope) <= CALM_SIGMA * sigma);
    if !robust || calm || n < 3 {
        return Some((intercept, factor));
    }
    let mut slopes = [0.0; WINDOW * (WINDOW - 1) / 2];
    let mut count = 0;
    for i in 0..n.min(WINDOW) {
        for k in 0..i {
            if keep[i] && keep[k] {
                slopes[count] = (y[i] - y[k]) / (x[i] - x[k]);
                count += 1;
            }
        }
    }
    let slope = median(&mut slopes, count);
    let mut levels = [0.0; WINDOW];
    let mut level_count = 0;
    for i in 0..n.min(WINDOW) {
        if keep[i] {
            levels[level_count] = y[i] - slope * x[i];
            level_count += 1;
        }
    }
    let level = median(&mut levels, level_count);
    let mut left = 0;
    for i in 0..n.min(WINDOW) {
        keep[i] = keep[i] && off(i, level, slope) <= SPIKE_SIGMA * sigma;
        left += usize::from(keep[i]);
    }
    if left < 3 {
        return None;
    }
    least_squares(x, y, &keep, n).map(|(intercept, _, factor)| (intercept, factor))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(values: &[f64]) -> ([f64; WINDOW], [f64; WINDOW]) {
        let mut x = [0.0; WINDOW];
        let mut y = [0.0; WINDOW];
        for (i, v) in values.iter().enumerate() {
            x[i] = i as f64 - 2.0;
            y[i] = *v;
        }
        (x, y)
    }

    #[test]
    fn one_spike_does_not_move_the_robust_line() {
        let (x, y) = points(&[1.0, 2.0, 3.0, 1e6, 5.0]);
        let (value, factor) = line(&x, &y, 5, 1.0, true).unwrap();
        assert!((value - 3.0).abs() < 1e-12);
        assert!(factor > 0.2);
        assert!(line(&x, &y, 5, 1.0, false).unwrap().0 > 1e5);
    }

    #[test]
    fn skips_an_axis_with_too_few_samples() {
        let (x, y) = points(&[1.0, f64::NAN, f64::NAN, f64::INFINITY, 5.0]);
        assert_eq!(line(&x, &y, 5, 1.0, true), None);
    }

    #[test]
    fn a_full_window_has_a_fifth_of_the_variance() {
        let (x, y) = points(&[0.0; 5]);
        assert_eq!(line(&x, &y, 5, 1.0, true), Some((0.0, 0.2)));
    }
}
