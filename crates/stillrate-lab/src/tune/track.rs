//! The small Kalman filters run over a record for their output, with the arithmetic of the objectives.

use stillrate::Real;

use crate::tune::candidates::{RandomWalks, RateAccelerations};
use crate::tune::gain_ratio::{LN_10, Walk};
use crate::tune::lanes::{self, Candidates};

/// A scalar Kalman filter's run and how its innovations score.
///
/// # Example
/// ```
/// use stillrate_lab::tune::track::random_walk;
/// let run = random_walk(&[0.0; 200], 0.5, 1.0, 0.0, 1.0)?;
/// // The Riccati equation settles at P- = 1 (units of R) for Q/R = 1/2: gain 1/2.
/// assert!((run.settled_gain - 0.5).abs() < 1e-15 && (run.gain[198] - 0.5).abs() < 1e-15);
/// assert_eq!((run.rate.len(), run.variance.len(), run.gain.len()), (200, 200, 199));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Estimates, one a sample, deg/s.
    pub rate: Vec<f64>,
    /// Variances of the estimates, one a sample, (deg/s)^2.
    pub variance: Vec<f64>,
    /// Gains, from the second sample on.
    pub gain: Vec<f64>,
    /// ln R^ + mean ln F + 1 with F in units of R, over the samples after the first.
    pub innovation: f64,
    /// R^: measurement variance that the innovations imply, (deg/s)^2.
    pub implied_variance: f64,
    /// Gain of the steady state.
    pub settled_gain: f64,
}

/// Rate of the filter tuned to `log10_ratio` at each sample: the first one starts it, missing ones are coasted over (0 before the first).
///
/// # Example
/// ```
/// use stillrate_lab::tune::{gain_ratio::Walk, track::track};
/// let measured = [f64::NAN, 1.0, 3.0, f64::NAN];
/// // Q/R -> 0 is the running mean; Q/R -> infinity is no filter at all.
/// assert_eq!(track(Walk::RandomWalk, -30.0, 0.01, &measured), [0.0, 1.0, 2.0, 2.0]);
/// assert_eq!(track(Walk::RandomWalk, 30.0, 0.01, &measured), [0.0, 1.0, 3.0, 3.0]);
/// ```
#[must_use]
pub fn track(walk: Walk, log10_ratio: f64, period_s: f64, measured: &[f64]) -> Vec<f64> {
    let q = [(LN_10 * log10_ratio).exponential()];
    match walk {
        Walk::RandomWalk => rates::<RandomWalks<1>>(q, period_s, measured),
        Walk::RateAcceleration => rates::<RateAccelerations<1>>(q, period_s, measured),
    }
}

fn rates<M: Candidates<1>>(q: [f64; 1], period_s: f64, measured: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; measured.len()];
    lanes::watch::<M, 1>(&q, period_s, measured, &mut |k, rate| out[k] = rate[0]);
    out
}

/// The random-walk filter with given Q and R from a given start, which counts as the estimate of the first sample.
///
/// `process_noise` Q a step and the variances are in (deg/s)^2.
///
/// # Errors
/// A sentence that names the value that is out of range.
///
/// # Example
/// ```
/// use stillrate_lab::tune::track::random_walk;
/// let run = random_walk(&[4.0, 0.0, 2.0], 0.0, 1.0, 4.0, 1.0)?;
/// assert_eq!(run.rate, [4.0, 2.0, 2.0]); // Q = 0 and P = R: the running mean
/// assert!(random_walk(&[1.0], -1.0, 1.0, 0.0, 1.0).unwrap_err().starts_with("process_noise = -1"));
/// # Ok::<(), String>(())
/// ```
pub fn random_walk(
    measured: &[f64],
    process_noise: f64,
    measurement_variance: f64,
    start_rate: f64,
    start_variance: f64,
) -> Result<Run, String> {
    let bad = |name: &str, value: f64, range: &str| Err(format!("{name} = {value} (must be finite and {range})"));
    if !(process_noise.is_finite() && process_noise >= 0.0) {
        return bad("process_noise", process_noise, ">= 0");
    }
    if !(measurement_variance.is_finite() && measurement_variance > 0.0) {
        return bad("measurement_variance", measurement_variance, "> 0");
    }
    if !(start_variance.is_finite() && start_variance >= 0.0) {
        return bad("start_variance", start_variance, ">= 0");
    }
    if !start_rate.is_finite() {
        return bad("start_rate", start_rate, "a rate");
    }
    let (mut rate, mut variance, mut gains) = (vec![start_rate], vec![start_variance], Vec::new());
    let (mut x, mut p) = (start_rate, start_variance);
    for &z in measured.iter().skip(1) {
        let predicted = p + process_noise;
        // A missing sample has no gain: the estimate stays, its variance grows.
        let gain = if z.is_finite() { predicted / (predicted + measurement_variance) } else { 0.0 };
        if z.is_finite() {
            x += gain * (z - x);
        }
        p = (1.0 - gain) * predicted;
        rate.push(x);
        variance.push(p);
        gains.push(gain);
    }
    rate.truncate(measured.len());
    variance.truncate(measured.len());
    let ratio = process_noise / measurement_variance;
    let (innovation, implied_variance) = innovation_score(measured, &rate, &variance, ratio, measurement_variance);
    // Steady state of the Riccati equation, predicted variance in units of R: p^2 = q (p + 1).
    let predicted = 0.5 * (ratio + (ratio * ratio + 4.0 * ratio).root());
    let settled_gain = predicted / (1.0 + predicted);
    Ok(Run { rate, variance, gain: gains, innovation, implied_variance, settled_gain })
}

/// ln R^ + mean ln F + 1 and R^ of a run.
fn innovation_score(
    measured: &[f64],
    rate: &[f64],
    variance: &[f64],
    ratio: f64,
    measurement_variance: f64,
) -> (f64, f64) {
    let (mut weighted, mut logarithms, mut count) = (0.0, 0.0, 0.0);
    for (k, z) in measured.iter().enumerate().skip(1).filter(|(_, z)| z.is_finite()) {
        let innovation = z - rate[k - 1];
        let f = variance[k - 1] / measurement_variance + ratio + 1.0;
        weighted += innovation * innovation / f;
        logarithms += f.logarithm();
        count += 1.0;
    }
    let implied = weighted / count;
    (implied.logarithm() + logarithms / count + 1.0, implied)
}
