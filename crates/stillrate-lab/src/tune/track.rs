//! The small Kalman filters run over a record for their output, with the arithmetic of the objectives.

use stillrate::Real;

use crate::tune::candidates::{RandomWalks, RateAccelerations};
use crate::tune::gain_ratio::{LN_10, Walk};
use crate::tune::lanes::{self, Candidates};

/// A scalar Kalman filter's run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// Estimates, one a sample.
    pub rate: Vec<f64>,
    /// Variances of the estimates, one a sample.
    pub variance: Vec<f64>,
    /// Gains, from the second sample on.
    pub gain: Vec<f64>,
}

/// Rate of the filter tuned to `log10_ratio` at each sample: the first one starts it, missing ones are coasted over (0 before the first).
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
/// # Errors
/// A sentence that names the value that is out of range.
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
    let mut run = Run { rate: vec![start_rate], variance: vec![start_variance], gain: Vec::new() };
    let (mut x, mut p) = (start_rate, start_variance);
    for &z in measured.iter().skip(1) {
        let predicted = p + process_noise;
        // A missing sample has no gain: the estimate stays, its variance grows.
        let gain = if z.is_finite() { predicted / (predicted + measurement_variance) } else { 0.0 };
        if z.is_finite() {
            x += gain * (z - x);
        }
        p = (1.0 - gain) * predicted;
        run.rate.push(x);
        run.variance.push(p);
        run.gain.push(gain);
    }
    run.rate.truncate(measured.len());
    run.variance.truncate(measured.len());
    Ok(run)
}

/// How a run of [`random_walk`] did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunScore {
    /// ln R^ + mean ln F + 1 with F in units of R, over the samples after the first.
    pub innovation: f64,
    /// R^: measurement variance that the innovations imply.
    pub measurement_variance: f64,
    /// Gain it settles at.
    pub settled_gain: f64,
}

/// Scores a run by its innovations.
#[must_use]
pub fn score(run: &Run, measured: &[f64], process_noise: f64, measurement_variance: f64) -> RunScore {
    let q = process_noise / measurement_variance;
    let (mut weighted, mut logarithms, mut count) = (0.0, 0.0, 0.0);
    for (k, z) in measured.iter().enumerate().skip(1).filter(|(_, z)| z.is_finite()) {
        let innovation = z - run.rate[k - 1];
        let variance = run.variance[k - 1] / measurement_variance + q + 1.0;
        weighted += innovation * innovation / variance;
        logarithms += variance.logarithm();
        count += 1.0;
    }
    // Steady state of the Riccati equation, predicted variance in units of R: p^2 = q (p + 1).
    let predicted = 0.5 * (q + (q * q + 4.0 * q).root());
    let variance = weighted / count;
    RunScore {
        innovation: variance.logarithm() + logarithms / count + 1.0,
        measurement_variance: variance,
        settled_gain: predicted / (1.0 + predicted),
    }
}
