//! A record to calibrate from, and the line that turns the samples around an epoch into one measurement.
//!
//! Commands hold over an interval T; the accelerometers are sampled a whole number of times in it. Around epoch k the samples
//! t_k + j dT, |j| <= half, minus a predicted output, lie on a straight line; its intercept is the measurement residual at
//! t_k with variance sigma^2 sum j^2 / (n sum j^2 - (sum j)^2). The robust form looks for the line by the median of all
//! pairwise slopes (Theil 1950, Sen 1968), drops what is farther than six sigma from it, and fits the rest. A missing sample is
//! left out; where fewer than three remain of a window that has three or more, the axis is skipped.

use super::line::{WINDOW, calm, line};
use crate::error::{ConfigError, positive};
use crate::real::Real;

/// Most samples to either side of an epoch.
pub const HALF_WINDOW_MAX: usize = 8;

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
