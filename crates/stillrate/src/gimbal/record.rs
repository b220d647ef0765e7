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
/// let command = [[0.0; 3], [0.01, 0.0, 0.0]];
/// let mut samples = [[0.0, 9.8, 0.0]; 11];
/// samples[6] = [0.5, 9.8, 0.0];
/// let record = Record::new(&command, &samples, 0.25, 1e-6)?;
/// assert_eq!((record.per_interval(), record.epochs(), record.interval_s(), record.sigma_m_s2()), (5, 2, 0.25, 1e-6));
/// assert_eq!((record.half_window(), record.with_half_window(9).half_window()), (2, 2)); // half way to the next epoch at the most
/// assert!(record.jumps(1, 1e-4) && record.command(1) == command[1]); // the motion has a kink at epoch 1
/// // The sample after epoch 1 is one fifth of an interval away from it.
/// assert_eq!((record.sample(1, 1), record.offset_s(1)), (Some(&samples[6]), 0.05));
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<'a> {
    command: &'a [[f64; 3]],
    samples: &'a [[f64; 3]],
    interval_s: f64,
    sigma_m_s2: f64,
    per_interval: usize,
    half: usize,
}

/// One measurement an axis: value and variance; an infinite variance says that there is none.
///
/// # Example
/// ```
/// use stillrate::gimbal::Measurement;
/// let upright = Measurement { value: [0.0, 9.8, 0.0], variance: [2e-13; 3] }; // lines through five samples of 1e-6 m/s^2
/// let without_z = Measurement { variance: [2e-13, 2e-13, f64::INFINITY], ..upright };
/// assert_eq!(without_z.variance[2], Measurement::NONE.variance[2]);
/// ```
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

/// Windows of neighbouring epochs do not overlap.
const fn widest_half_window(per_interval: usize) -> usize {
    let half = (per_interval - 1) / 2;
    if half > HALF_WINDOW_MAX { HALF_WINDOW_MAX } else { half }
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
        Ok(Self { command, samples, interval_s, sigma_m_s2, per_interval, half: widest_half_window(per_interval) })
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
    pub const fn sigma_m_s2(&self) -> f64 {
        self.sigma_m_s2
    }

    /// The same record with windows of `half` samples to either side (0: single samples).
    #[must_use]
    pub const fn with_half_window(mut self, half: usize) -> Self {
        let most = widest_half_window(self.per_interval);
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
    pub(super) fn intercept(
        &self,
        k: usize,
        robust: bool,
        mut predicted: impl FnMut(isize) -> [f64; 3],
    ) -> Measurement {
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
            let full = if n == self.half * 2 + 1 { calm(&difference[axis], self.half, self.sigma_m_s2) } else { None };
            if let Some(value) = full {
                measurement.value[axis] = value;
                measurement.variance[axis] = self.sigma_m_s2 * self.sigma_m_s2 / n as f64;
            } else if let Some((value, factor)) = line(&place, &difference[axis], n, self.sigma_m_s2, robust) {
                measurement.value[axis] = value;
                measurement.variance[axis] = factor * self.sigma_m_s2 * self.sigma_m_s2;
            }
        }
        measurement
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_of_one_sample_is_that_sample() {
        let mut samples = [[0.0, 9.8, 0.0]; 11];
        samples[5] = [1.0, 2.0, 3.0];
        let single = Record::new(&[[0.0; 3]; 2], &samples, 0.25, 1e-6).unwrap().with_half_window(0);
        let one = single.intercept(1, true, |_| [0.0; 3]);
        assert_eq!((one.value, one.variance), (samples[5], [1e-12; 3]));
    }
}
