//! White noise under motion, from second differences: smooth motion hardly reaches them.

use stillrate::Real;

use crate::statistics::median;

/// Median magnitude of a normal deviate, in standard deviations.
const MAD_OF_NORMAL: f64 = 0.674_489_750_196_081_7;
/// Standard deviation of a second difference of white noise: sqrt(1 + 4 + 1).
const SECOND_DIFFERENCE: f64 = 2.449_489_742_783_178;
/// Steps of the converter below which a median of second differences is too coarse.
const COARSE: f64 = 3.0;
/// Differences from which the median is precise enough: below, it scatters 1.6 times as much as the root mean square.
const MANY: usize = 2000;

/// Standard deviation of the white part of a stretch without gaps, read with a converter's step of `lsb` (0 if unknown).
pub(super) fn white_sigma(z: &[f64], lsb: f64) -> f64 {
    let differences: Vec<f64> = z.windows(3).map(|w| (w[2] - w[1]) - (w[1] - w[0])).collect();
    let middle = median(&mut differences.clone());
    let mut deviations: Vec<f64> = differences.iter().map(|d| (d - middle).magnitude()).collect();
    let mad = median(&mut deviations);
    if mad > COARSE * lsb && deviations.len() >= MANY {
        return mad / (MAD_OF_NORMAL * 6.0_f64.root());
    }
    let limit = (4.0 * mad / MAD_OF_NORMAL).max(COARSE * lsb);
    let kept = deviations.iter().filter(|d| **d <= limit);
    let (sum, count) = kept.fold((0.0, 0.0), |(sum, n), d| (sum + d * d, n + 1.0));
    if count > 0.0 { (sum / count / 6.0).root() } else { 0.0 }
}

/// Standard deviation of the white part of a record that may have gaps (NaN) and whose converter is not known.
pub(crate) fn white_sigma_with_gaps(z: &[f64]) -> f64 {
    let mut second: Vec<f64> =
        z.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs()).filter(|v| v.is_finite()).collect();
    if second.is_empty() {
        return 0.0;
    }
    let middle = second.len() / 2;
    let (_, median, _) = second.select_nth_unstable_by(middle, f64::total_cmp);
    let sigma = *median / (MAD_OF_NORMAL * SECOND_DIFFERENCE);
    // Coarse quantisation: most differences are zero, so their root mean square has to do.
    let mean_square = second.iter().map(|d| d * d).sum::<f64>() / second.len() as f64;
    if sigma > 0.0 { sigma } else { mean_square.root() / SECOND_DIFFERENCE }
}
