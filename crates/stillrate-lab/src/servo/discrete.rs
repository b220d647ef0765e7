//! Plain discrete filters of the control textbook, for loops whose linear behaviour must be known exactly.
//!
//! PT1 by exact discretisation, w += (1 - e^(-2 pi fc T)) (y - w), w_0 = y_0; second-order Butterworth by the bilinear
//! transform with prewarping (Q = 1/sqrt 2), started in the steady state of y_0; the scalar Kalman filter x <- phi x with
//! noise ratio q/R, P0/R = 1, which predicts and updates from the first sample on and starts at y_0 (phi = 1) or 0. They have
//! exact state-space forms, which the sampled-loop analysis needs.

use core::f64::consts::{PI, TAU};

use stillrate::Real;
use stillrate::error::{ConfigError, between, not_negative, positive};

use super::loop_filter::LoopFilter;

/// A linear time-invariant (after its start) filter of order 0, 1 or 2.
///
/// # Example
/// ```
/// use stillrate_lab::servo::discrete::Discrete;
/// use stillrate_lab::servo::loop_filter::LoopFilter;
/// let mut low_pass = Discrete::butterworth(50.0, 8.0).unwrap();
/// assert!((low_pass.step(2.0) - 2.0).abs() < 1e-12); // starts in its steady state
/// // A Kalman filter of noise ratio g^2 / (1 - g) settles to the PT1 of gain g.
/// let gain = 1.0 - (-core::f64::consts::TAU * 5.3 / 50.0).exp();
/// let mut lag = Discrete::pt1(50.0, 5.3).unwrap();
/// let mut kalman = Discrete::kalman(1.0, gain * gain / (1.0 - gain)).unwrap();
/// for _ in 0..100 {
///     (lag.step(0.0), kalman.step(0.0));
/// }
/// assert!((lag.step(1.0) - gain).abs() < 1e-12 && (kalman.step(1.0) - gain).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Discrete {
    /// Nothing.
    None,
    /// First order.
    Pt1 {
        /// 1 - e^(-2 pi fc T).
        gain: f64,
        /// The filtered value, once started.
        level: Option<f64>,
    },
    /// Second order, direct form II transposed.
    Biquad {
        /// b0, b1, b2.
        b: [f64; 3],
        /// a1, a2.
        a: [f64; 2],
        /// The two delays, once started.
        delays: Option<[f64; 2]>,
    },
    /// Scalar Kalman filter.
    Kalman {
        /// phi: what remains of the rate after one period.
        phi: f64,
        /// q/R: process noise over measurement noise.
        ratio: f64,
        /// Estimate and its variance over R, once started.
        state: Option<(f64, f64)>,
    },
}

impl Discrete {
    /// First order with cut-off `cutoff_hz`, for samples at `sample_rate_hz`.
    ///
    /// # Errors
    /// Rates that are not positive.
    pub fn pt1(sample_rate_hz: f64, cutoff_hz: f64) -> Result<Self, ConfigError> {
        let period = 1.0 / positive("sample_rate_hz", sample_rate_hz, "Hz")?;
        let gain = -(-TAU * positive("cutoff_hz", cutoff_hz, "Hz")? * period).exponential_less_one();
        Ok(Self::Pt1 { gain, level: None })
    }

    /// Second-order Butterworth with cut-off `cutoff_hz` below half the sample rate.
    ///
    /// # Errors
    /// A cut-off outside 0 .. half the sample rate.
    pub fn butterworth(sample_rate_hz: f64, cutoff_hz: f64) -> Result<Self, ConfigError> {
        let half = 0.5 * positive("sample_rate_hz", sample_rate_hz, "Hz")?;
        let cutoff = between("cutoff_hz", cutoff_hz, 0.0, half, "Hz", "above 0 and below half the sample rate in")?;
        let (sine, cosine) = (PI * cutoff / sample_rate_hz).sine_cosine();
        let k = sine / cosine;
        let q = 0.5.root();
        let norm = 1.0 / (1.0 + k / q + k * k);
        let b0 = k * k * norm;
        let a = [2.0 * (k * k - 1.0) * norm, (1.0 - k / q + k * k) * norm];
        Ok(Self::Biquad { b: [b0, 2.0 * b0, b0], a, delays: None })
    }

    /// Scalar Kalman filter with transition `phi` and noise ratio `ratio` = q/R.
    ///
    /// # Errors
    /// A `phi` that is not above 0 and at most 1, or a ratio that is negative.
    pub fn kalman(phi: f64, ratio: f64) -> Result<Self, ConfigError> {
        if !(phi > 0.0 && phi <= 1.0) {
            return Err(ConfigError::new("phi", phi, "", "above 0 and at most 1"));
        }
        Ok(Self::Kalman { phi, ratio: not_negative("ratio", ratio, "")?, state: None })
    }

    /// The stationary filter as x <- A x + b y, w = c x + d y: (A row-major, b, c, d), of order 0, 1 or 2.
    pub(crate) fn matrices(&self) -> (Vec<f64>, Vec<f64>, Vec<f64>, f64) {
        let first = |keep: f64, gain: f64| (vec![keep], vec![gain], vec![keep], gain);
        match *self {
            Self::None => (vec![], vec![], vec![], 1.0),
            Self::Pt1 { gain, .. } => first(1.0 - gain, gain),
            Self::Kalman { phi, ratio, .. } => {
                let mut p = 1.0;
                for _ in 0..100_000 {
                    let ahead = phi * phi * p + ratio;
                    let next = ahead / (ahead + 1.0);
                    if next == p {
                        break;
                    }
                    p = next;
                }
                // p is the posterior variance over R, which equals the gain.
                first((1.0 - p) * phi, p)
            }
            Self::Biquad { b, a, .. } => {
                (vec![-a[0], 1.0, -a[1], 0.0], vec![b[1] - a[0] * b[0], b[2] - a[1] * b[0]], vec![1.0, 0.0], b[0])
            }
        }
    }
}

impl LoopFilter for Discrete {
    fn reset(&mut self) {
        match self {
            Self::None => {}
            Self::Pt1 { level, .. } => *level = None,
            Self::Biquad { delays, .. } => *delays = None,
            Self::Kalman { state, .. } => *state = None,
        }
    }

    fn step(&mut self, y: f64) -> f64 {
        match self {
            Self::None => y,
            Self::Pt1 { gain, level } => {
                let next = level.map_or(y, |w| w + *gain * (y - w));
                *level = Some(next);
                next
            }
            Self::Biquad { b, a, delays } => {
                let [d1, d2] = delays.unwrap_or([(1.0 - b[0]) * y, (b[2] - a[1]) * y]);
                let w = b[0] * y + d1;
                *delays = Some([b[1] * y - a[0] * w + d2, b[2] * y - a[1] * w]);
                w
            }
            Self::Kalman { phi, ratio, state } => {
                let (x, p) = state.unwrap_or((if *phi == 1.0 { y } else { 0.0 }, 1.0));
                let ahead = *phi * *phi * p + *ratio;
                let gain = ahead / (ahead + 1.0);
                let x = *phi * x;
                let x = x + gain * (y - x);
                *state = Some((x, (1.0 - gain) * ahead));
                x
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_discrete_filter_has_the_matrices_it_runs_by() {
        for filter in [Discrete::pt1(50.0, 3.0).unwrap(), Discrete::butterworth(50.0, 8.0).unwrap()] {
            let (a, b, c, d) = filter.matrices();
            let n = b.len();
            let mut running = filter;
            running.step(0.0);
            let mut x = vec![0.0; n];
            for k in 0..50 {
                let y = f64::from(k % 7) - 3.0;
                let w = c.iter().zip(&x).map(|(c, x)| c * x).sum::<f64>() + d * y;
                assert!((running.step(y) - w).abs() < 1e-12);
                x = (0..n).map(|i| (0..n).map(|j| a[i * n + j] * x[j]).sum::<f64>() + b[i] * y).collect();
            }
        }
    }
}
