//! Figures of merit: errors, lag, settling, and whether a filter knows its own uncertainty.
//!
//! Errors are estimate minus truth; samples where either is not finite are left out, and a figure without any sample
//! is NaN. Lag is positive when the estimate is late. Consistency follows Bar-Shalom, Li and Kirubarajan, "Estimation
//! with Applications to Tracking and Navigation" (2001), section 5.4 (NEES), and Dawid's probability integral
//! transform (1984) for mixtures, whose innovations no single variance describes.

use core::f64::consts::PI;
use core::ops::Range;

use stillrate::Real;

use crate::statistics::{normal_cdf, normal_score};

/// Sums `f` over the pairs that are finite; returns the sum and how many there were.
fn sum_pairs(estimate: &[f64], truth: &[f64], f: impl Fn(f64, f64) -> f64) -> (f64, f64) {
    estimate
        .iter()
        .zip(truth)
        .map(|(e, s)| (*e, *s))
        .filter(|(e, s)| e.is_finite() && s.is_finite())
        .fold((0.0, 0.0), |(sum, n), (e, s)| (sum + f(e, s), n + 1.0))
}

/// Root mean square of estimate - truth, in their unit.
///
/// # Example
/// ```
/// assert_eq!(stillrate_lab::metrics::rmse(&[1.0, 5.0, f64::NAN], &[1.0, 1.0, 0.0]), 8.0_f64.sqrt());
/// ```
#[must_use]
pub fn rmse(estimate: &[f64], truth: &[f64]) -> f64 {
    let (sum, n) = sum_pairs(estimate, truth, |e, s| (e - s) * (e - s));
    (sum / n).root()
}

/// Root mean square about the mean: what is left of a record at rest.
///
/// # Example
/// ```
/// assert_eq!(stillrate_lab::metrics::rms_about_mean(&[4.0, 6.0]), 1.0);
/// ```
#[must_use]
pub fn rms_about_mean(z: &[f64]) -> f64 {
    let (sum, n) = sum_pairs(z, z, |x, _| x);
    let mean = sum / n;
    let (squares, n) = sum_pairs(z, z, |x, _| (x - mean) * (x - mean));
    (squares / n).root()
}

/// Mean of (estimate - truth)^2 / variance: 1 for a filter that knows its uncertainty, above 1 for an optimist.
///
/// # Example
/// ```
/// assert_eq!(stillrate_lab::metrics::nees_mean(&[2.0, 0.0], &[0.0, 0.0], &[4.0, 1.0]), 0.5);
/// ```
#[must_use]
pub fn nees_mean(estimate: &[f64], truth: &[f64], variance: &[f64]) -> f64 {
    let scaled: Vec<f64> = estimate
        .iter()
        .zip(truth)
        .zip(variance)
        .map(|((e, s), v)| if *v > 0.0 { (e - s) * (e - s) / v } else { f64::NAN })
        .collect();
    let (sum, n) = sum_pairs(&scaled, &scaled, |x, _| x);
    sum / n
}

/// The normal score of one sample under a mixture: Phi^-1(u), u = sum c_i Phi(nu_i / sqrt S_i), from both tails so that
/// a far sample keeps its distance. Weights need not sum to one.
///
/// # Example
/// ```
/// use stillrate_lab::metrics::mixture_score;
/// let score = mixture_score(&[0.5, 0.5], &[3.0, 3.0], &[4.0, 4.0]);
/// assert!((score - 1.5).abs() < 1e-12);
/// ```
#[must_use]
pub fn mixture_score(weights: &[f64], innovations: &[f64], variances: &[f64]) -> f64 {
    let (mut lower, mut upper, mut total) = (0.0, 0.0, 0.0);
    for ((c, nu), s) in weights.iter().zip(innovations).zip(variances) {
        let x = nu / s.root();
        lower += c * normal_cdf(x);
        upper += c * normal_cdf(-x);
        total += c;
    }
    normal_score(lower / total, upper / total)
}

/// Mean square of normal scores about zero: 1 when the predicted distribution is right, above 1 when too narrow.
///
/// # Example
/// ```
/// assert_eq!(stillrate_lab::metrics::pit_variance(&[1.0, -1.0, f64::NAN]), 1.0);
/// ```
#[must_use]
pub fn pit_variance(scores: &[f64]) -> f64 {
    let (sum, n) = sum_pairs(scores, scores, |x, _| x * x);
    sum / n
}

/// Taps on each side of the band-limited interpolation.
const TAPS: isize = 24;

/// Lag of an estimate behind the truth in ms, positive = late: the shift of the truth that correlates best with the
/// estimate (normalised, so that an ideal delay is found exactly), searched over plus or minus `max_lag_s` and refined
/// between samples by band-limited interpolation of the truth. NaN if there is too little data or no variation.
///
/// Non-finite samples count as zero on both sides.
///
/// # Example
/// ```
/// use stillrate_lab::metrics::lag_ms;
/// let wave = |t: f64| (12.0 * t).sin() + (5.0 * t).cos();
/// let truth: Vec<f64> = (0..2000).map(|k| wave(0.01 * f64::from(k))).collect();
/// let late: Vec<f64> = (0..2000).map(|k| wave(0.01 * f64::from(k) - 0.0137)).collect();
/// assert!((lag_ms(&late, &truth, 100.0, 0.2) - 13.7).abs() < 0.01);
/// ```
#[must_use]
pub fn lag_ms(estimate: &[f64], truth: &[f64], sample_rate_hz: f64, max_lag_s: f64) -> f64 {
    let n = estimate.len().min(truth.len());
    let reach = ((max_lag_s * sample_rate_hz).ceil().clamp(1.0, 1e9)) as usize;
    let margin = reach + TAPS as usize + 2;
    if n < 2 * margin + 8 {
        return f64::NAN;
    }
    let clean = |x: &[f64]| -> Vec<f64> { x[..n].iter().map(|v| if v.is_finite() { *v } else { 0.0 }).collect() };
    let (e, s) = (clean(estimate), clean(truth));
    let inner = &e[margin..n - margin];
    let whole = |lag: isize| correlation(inner, &s[(margin as isize - lag) as usize..]);
    let (mut best, mut highest) = (0_isize, whole(0));
    for lag in -(reach as isize)..=reach as isize {
        let here = whole(lag);
        if here > highest {
            (best, highest) = (lag, here);
        }
    }
    let between = |part: f64| {
        let taps = shift_taps(part);
        let start = (margin as isize - best - TAPS) as usize;
        let shifted: Vec<f64> =
            (0..inner.len()).map(|i| s[start + i..].iter().zip(&taps).map(|(x, w)| x * w).sum()).collect();
        correlation(inner, &shifted)
    };
    let shift = best as f64 + maximum(-1.0, 1.0, between);
    if highest.is_finite() { 1e3 * shift / sample_rate_hz } else { f64::NAN }
}

/// sum e s / sqrt(sum s^2): by Cauchy and Schwarz largest where s is proportional to e.
fn correlation(e: &[f64], s: &[f64]) -> f64 {
    let (dot, energy) = e.iter().zip(s).fold((0.0, 0.0), |(d, q), (a, b)| (d + a * b, q + b * b));
    dot / energy.root()
}

/// Weights on samples -TAPS..=TAPS that give a band-limited signal `part` samples earlier (Hann-windowed sinc).
fn shift_taps(part: f64) -> Vec<f64> {
    let reach = (TAPS + 1) as f64;
    (-TAPS..=TAPS)
        .map(|j| {
            let x = j as f64 + part;
            let window = 0.5 * (1.0 + (PI * x / reach).sine_cosine().1);
            if x == 0.0 { 1.0 } else { window * (PI * x).sine_cosine().0 / (PI * x) }
        })
        .collect()
}

/// Golden-section search for the maximum of a function with one peak in `low..high`.
fn maximum(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let ratio = 0.5 * (5.0.root() - 1.0);
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut fa, mut fb) = (f(a), f(b));
    while high - low > 1e-5 {
        if fa > fb {
            (high, b, fb) = (b, a, fa);
            a = high - ratio * (high - low);
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + ratio * (high - low);
            fb = f(b);
        }
    }
    0.5 * (low + high)
}

/// How an estimate recovers from a step; see [`settling`].
///
/// # Example
/// ```
/// use stillrate_lab::metrics::{Settling, settling};
/// let never = settling(&[2.0; 3], &[5.0; 3], 10.0, 0..3, 0.5);
/// assert_eq!(never, Settling { peak: 3.0, time_s: f64::INFINITY });
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settling {
    /// Largest magnitude of the error, in the unit of the estimate.
    pub peak: f64,
    /// Time until the error stays within the band, s; 0 if it never leaves it, infinite if it ends outside.
    pub time_s: f64,
}

/// Peak error and settling time over `window` (samples), which begins with the step and ends before the next; `band` is the error that
/// counts as settled, in the unit of the estimate.
///
/// # Example
/// ```
/// use stillrate_lab::metrics::settling;
/// let estimate = [0.0, 2.0, 4.0, 5.0, 5.0];
/// let s = settling(&estimate, &[5.0; 5], 10.0, 0..5, 0.5);
/// assert_eq!((s.peak, s.time_s), (5.0, 0.3));
/// ```
#[must_use]
pub fn settling(estimate: &[f64], truth: &[f64], sample_rate_hz: f64, window: Range<usize>, band: f64) -> Settling {
    let end = window.end.min(estimate.len()).min(truth.len());
    let errors = (window.start.min(end)..end).map(|k| (estimate[k] - truth[k]).magnitude());
    let (mut peak, mut outside, mut length) = (0.0_f64, 0, 0);
    for (k, error) in errors.enumerate() {
        length = k + 1;
        peak = peak.max(error);
        // NaN is not within the band.
        if error.is_nan() || error > band {
            outside = k + 1;
        }
    }
    let ends_outside = outside == length && length > 0;
    Settling { peak, time_s: if ends_outside { f64::INFINITY } else { outside as f64 / sample_rate_hz } }
}

#[cfg(test)]
mod tests {
    use super::{lag_ms, mixture_score, nees_mean, pit_variance, rms_about_mean, rmse, settling};
    use crate::random::Random;
    use crate::simulate::{BedKind, BedSettings};

    #[test]
    fn lag_of_a_noisy_wave_is_found_to_hundredths_of_a_sample() {
        let bed = BedSettings::new(BedKind::Waves, 50.0, 4).simulate().unwrap();
        let (z, s) = (&bed.measured_dps[bed.scored.clone()], &bed.truth_dps[bed.scored.clone()]);
        assert!(lag_ms(z, s, 50.0, 0.25).abs() < 0.2); // .01 sample
        assert!((lag_ms(&z[..5000], &s[3..5003], 50.0, 0.25) - 60.0).abs() < 0.2);
        assert!((lag_ms(&z[3..5003], &s[..5000], 50.0, 0.25) + 60.0).abs() < 0.2);
    }

    #[test]
    fn a_later_copy_has_a_positive_lag_whatever_its_gain() {
        let bed = BedSettings::new(BedKind::RoughWaves, 200.0, 4).simulate().unwrap();
        let s = &bed.motion_dps;
        let late: Vec<f64> = s[..20_000].iter().map(|x| 0.3 * x).collect();
        assert!((lag_ms(&late, &s[7..20_007], 200.0, 0.2) - 35.0).abs() < 0.01);
    }

    #[test]
    fn lag_of_nothing_is_not_a_number() {
        assert!(lag_ms(&[0.0; 10], &[0.0; 10], 50.0, 0.1).is_nan());
        assert!(lag_ms(&[0.0; 500], &[0.0; 500], 50.0, 0.1).is_nan());
    }

    #[test]
    fn figures_without_samples_are_not_numbers() {
        assert!(rmse(&[], &[]).is_nan());
        assert!(rms_about_mean(&[f64::NAN]).is_nan());
        assert!(nees_mean(&[1.0], &[0.0], &[0.0]).is_nan());
    }

    #[test]
    fn scores_of_samples_from_the_mixture_have_unit_variance() {
        let mut random = Random::new(2, 0);
        let scores: Vec<f64> = (0..20_000)
            .map(|k| {
                let nu = if k % 4 == 0 { 1.0 + 5.0 * random.normal() } else { random.normal() };
                mixture_score(&[0.25, 0.75], &[nu - 1.0, nu], &[25.0, 1.0])
            })
            .collect();
        // Four standard errors.
        assert!((pit_variance(&scores) - 1.0).abs() < 4.0 * (2.0_f64 / 20_000.0).sqrt());
    }

    #[test]
    fn settling_tells_never_left_from_never_arrived() {
        let truth = [1.0; 6];
        assert_eq!(settling(&[1.1; 6], &truth, 50.0, 0..6, 0.2).time_s, 0.0);
        assert_eq!(settling(&[2.0; 6], &truth, 50.0, 0..6, 0.2).time_s, f64::INFINITY);
        assert_eq!(settling(&[2.0, 1.0, 2.0, 1.0, 1.0, 1.0], &truth, 50.0, 0..6, 0.2).time_s, 0.06);
        assert_eq!(settling(&[2.0; 6], &truth, 50.0, 9..12, 0.2).time_s, 0.0);
    }
}
