//! Figures of merit of a calibration against the truth, as the reference data define them.
//!
//! kappa, the mean of the three kgI, is a rotation about the vertical seen through the Earth rate only; it is scored by itself. "Other" is the
//! largest relative error of the 24 free coefficients that are not kgI and of kgI less its mean.

use stillrate::Real;
use stillrate::gimbal::{COUNT, Coefficients};

/// First of the three kgI.
const KAPPA: core::ops::Range<usize> = 6..9;

/// Errors of one calibration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Score {
    /// Largest relative error but for kappa.
    pub other: f64,
    /// Relative error of kappa.
    pub kappa: f64,
    /// Largest relative error of all coefficients, kgI as they are.
    pub all: f64,
    /// Root mean square of error over bound.
    pub over_bound: f64,
}

fn mean_kappa(x: &Coefficients) -> f64 {
    (x[6] + x[7] + x[8]) / 3.0
}

/// Scores an estimate; `indices` are the estimated coefficients (attitudes are passed over), `bound` their Cramer-Rao bounds.
/// Coefficients whose truth is zero have no relative error and count only against the bound.
#[must_use]
pub fn score(estimate: &Coefficients, truth: &Coefficients, bound: &Coefficients, indices: &[usize]) -> Score {
    let shift = mean_kappa(estimate) - mean_kappa(truth);
    let mut score = Score { kappa: shift.magnitude() / mean_kappa(truth).magnitude(), ..Score::default() };
    let (mut sum, mut count) = (0.0, 0.0);
    for &i in indices.iter().filter(|&&i| (3..COUNT).contains(&i)) {
        let error = estimate[i] - truth[i];
        let ratio = error / bound[i];
        if i < 33 && ratio.is_finite() {
            sum += ratio * ratio;
            count += 1.0;
        }
        if truth[i] != 0.0 && i < 33 {
            let without_kappa = if KAPPA.contains(&i) { error - shift } else { error };
            score.other = not_less((without_kappa / truth[i]).magnitude(), score.other);
            score.all = not_less((error / truth[i]).magnitude(), score.all);
        }
    }
    score.over_bound = (sum / count).root();
    score
}

/// The larger one; NaN wins, so that a lost estimate cannot look good.
fn not_less(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// First time after which the "other" error stays below `limit`; nothing if it never does.
#[must_use]
pub fn settling_time(times_s: &[f64], others: &[f64], limit: f64) -> Option<f64> {
    let last_bad = others.iter().rposition(|&e| !(e < limit));
    let first_good = last_bad.map_or(0, |at| at + 1);
    times_s.get(first_good).copied()
}
