//! The step of the converter, from the values that occur in a log.

use crate::statistics::{median, quantile};

/// Samples looked at: plenty to see every level near the mean.
const MOST: usize = 200_000;
/// One sample in this many may be a spike at either end.
const SPIKES: usize = 200;
/// Values closer than this part of their magnitude are the same level, printed or rounded differently (a few times the
/// rounding of `f32`).
const SAME: f64 = 1e-6;
/// Spacings larger than this many steps say nothing about the step any more.
const FAR: f64 = 20.0;
/// How far from a whole number of steps a spacing may lie, and what part of the spacings must lie within.
const LATTICE: (f64, f64) = (0.15, 0.9);

/// The quantisation step of a record: the smallest spacing between its levels, if all spacings are multiples of it;
/// 0 for values without a lattice. Non-finite samples are left out.
///
/// # Example
/// ```
/// use stillrate_lab::tune::smallest_step;
/// let z: Vec<f64> = (0..100).map(|k| 0.061 * f64::from(k * k % 17) + 0.3).collect();
/// assert!((smallest_step(&z) - 0.061).abs() < 1e-12);
/// ```
#[must_use]
pub fn smallest_step(z: &[f64]) -> f64 {
    let mut values: Vec<f64> = z.iter().copied().filter(|x| x.is_finite()).take(MOST).collect();
    values.sort_unstable_by(f64::total_cmp);
    let spikes = values.len() / SPIKES;
    let values = &values[spikes..values.len() - spikes];
    let mut magnitudes: Vec<f64> = values.iter().map(|x| x.abs()).collect();
    let usual = quantile(&mut magnitudes, 0.9);
    let apart = |w: &[f64]| w[1] - w[0] > SAME * usual.max(w[1].abs());
    let spacings: Vec<f64> = values.windows(2).filter(|w| apart(w)).map(|w| w[1] - w[0]).collect();
    let smallest = spacings.iter().copied().fold(f64::INFINITY, f64::min);
    if !smallest.is_finite() {
        return 0.0;
    }
    let mut single: Vec<f64> = spacings.iter().copied().filter(|d| *d < 1.5 * smallest).collect();
    let step = median(&mut single);
    let near: Vec<f64> = spacings.iter().map(|d| d / step).filter(|n| *n < FAR).collect();
    let whole = near.iter().filter(|n| (**n - n.round()).abs() < LATTICE.0).count();
    if whole as f64 >= LATTICE.1 * near.len() as f64 { step } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::smallest_step;
    use crate::random::Random;

    #[test]
    fn finds_the_step_behind_single_precision_rounding() {
        let z: Vec<f64> = Random::new(1, 0)
            .normals(5000)
            .iter()
            .map(|x| f64::from(((x * 40.0).round() * 0.060_975_609) as f32) + 0.123)
            .collect();
        assert!((smallest_step(&z) / 0.060_975_609 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn continuous_values_have_no_step() {
        assert_eq!(smallest_step(&Random::new(2, 0).normals(5000)), 0.0);
        assert_eq!(smallest_step(&[]), 0.0);
        assert_eq!(smallest_step(&[1.0; 50]), 0.0);
    }

    #[test]
    fn a_coarse_converter_with_few_levels_is_seen() {
        let z: Vec<f64> = Random::new(3, 0).normals(300).iter().map(|x| x.round()).collect();
        assert_eq!(smallest_step(&z), 1.0);
    }
}
