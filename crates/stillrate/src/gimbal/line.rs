//! The line through the samples of a window: least squares where they lie quietly about it, else robust (Theil 1950, Sen 1968).

use super::record::HALF_WINDOW_MAX;
use crate::real::Real;

/// Most samples in a window.
pub(super) const WINDOW: usize = 2 * HALF_WINDOW_MAX + 1;
/// A sample farther than this many sigma from the robust line is a spike.
const SPIKE_SIGMA: f64 = 6.0;
/// Where no residual of the least-squares line exceeds this many sigma, no sample can be beyond [`SPIKE_SIGMA`] from
/// the robust one, so the search for it is spared.
const CALM_SIGMA: f64 = 2.0;

/// Intercept of the least-squares line through a full window, its middle value, if all samples are there and none is far from the line.
#[inline(always)]
pub(super) fn calm(y: &[f64; WINDOW], half: usize, sigma: f64) -> Option<f64> {
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
pub(super) fn line(x: &[f64; WINDOW], y: &[f64; WINDOW], n: usize, sigma: f64, robust: bool) -> Option<(f64, f64)> {
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
