//! Figures of merit of a calibration against the truth, as the reference data define them.
//!
//! kappa, the mean of the three kgI, is a rotation about the vertical seen through the Earth rate only; it is scored by itself. "Other" is the
//! largest relative error of the 24 free coefficients that are not kgI and of kgI less its mean.

use stillrate::Real;
use stillrate::gimbal::Coefficients;
use stillrate::gimbal::coefficients::{G_INPUT, G_OUTPUT, GYRO_BIAS, TORQUER};

/// The three kgI, whose mean is kappa.
pub(super) const KAPPA: core::ops::Range<usize> = G_INPUT..G_OUTPUT;
/// What is scored: neither attitude nor the optional coefficients.
const SCORED: core::ops::Range<usize> = GYRO_BIAS..TORQUER;

/// Errors of one calibration.
///
/// # Example
/// ```
/// use stillrate::gimbal::DEFAULT_SCALE;
/// use stillrate_lab::gimbal::{draw, score};
/// let (truth, indices) = (draw(&DEFAULT_SCALE, 1.0, 1), [3, 4, 5, 6, 7, 8]);
/// let mut estimate = truth;
/// (6..9).for_each(|kgi| estimate[kgi] += 1e-9); // all three kgI alike: kappa is wrong and nothing else
/// let found = score(&estimate, &truth, &[1e-9; 41], &indices);
/// assert!(found.other < 1e-9 && found.kappa > 1e-3 && found.all > found.other);
/// assert!((found.over_bound - 0.5_f64.sqrt()).abs() < 1e-9); // one bound off in three of six coefficients
/// ```
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

/// Mean of the three kgI.
pub(super) fn mean_kappa(x: &Coefficients) -> f64 {
    (x[G_INPUT] + x[G_INPUT + 1] + x[G_INPUT + 2]) / 3.0
}

/// Scores an estimate; `indices` are the estimated coefficients (attitudes and optional ones are passed over), `bound` their
/// Cramer-Rao bounds. Coefficients whose truth is zero have no relative error and count only against the bound.
///
/// # Example
/// ```
/// use stillrate::gimbal::DEFAULT_SCALE;
/// use stillrate_lab::gimbal::{draw, score};
/// let truth = draw(&DEFAULT_SCALE, 1.0, 1);
/// let one_per_cent = truth.map(|x| 1.01 * x);
/// assert!((score(&one_per_cent, &truth, &DEFAULT_SCALE, &[3, 4, 5, 21, 22, 23]).other - 0.01).abs() < 1e-12);
/// ```
#[must_use]
pub fn score(estimate: &Coefficients, truth: &Coefficients, bound: &Coefficients, indices: &[usize]) -> Score {
    let shift = mean_kappa(estimate) - mean_kappa(truth);
    let mut score = Score { kappa: shift.magnitude() / mean_kappa(truth).magnitude(), ..Score::default() };
    let (mut sum, mut count) = (0.0, 0.0);
    for &i in indices.iter().filter(|i| SCORED.contains(i)) {
        let error = estimate[i] - truth[i];
        let ratio = error / bound[i];
        if ratio.is_finite() {
            sum += ratio * ratio;
            count += 1.0;
        }
        if truth[i] != 0.0 {
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
pub(super) fn settling_time(times_s: &[f64], others: &[f64], limit: f64) -> Option<f64> {
    let last_bad = others.iter().rposition(|&e| !(e < limit));
    let first_good = last_bad.map_or(0, |at| at + 1);
    times_s.get(first_good).copied()
}
