//! Kalman prediction and measurement update for H = (1, 0, ...), using the structure of every model.
//!
//! Predictions use the structure of F; updates use that H picks the rate, which makes the gain the first column of P over S and
//! the updated first row R/S times the old one (the symmetric form of Joseph's, without its cancellation).

use crate::gaussian::{Gaussian2, Gaussian3, Gaussian4};
use crate::models::SingerCoefficients;
use crate::models::oscillator::OscillatorStep;
use crate::real::Real;

/// What a measurement said about one model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Evidence<T> {
    pub(crate) innovation: T,
    pub(crate) innovation_variance: T,
    /// -1/2 innovation^2 / variance, as a power of two.
    pub(crate) exponent: T,
    /// Factor of the likelihood besides the exponential: 1 / sqrt(variance).
    pub(crate) factor: T,
    /// Probability that the measurement was an outlier.
    pub(crate) outlier: T,
}

/// Measurement and its noise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reading<T> {
    pub(crate) value: T,
    pub(crate) variance: T,
    /// Prior probability of an outlier; 0 switches the two-component model off.
    pub(crate) outlier_probability: T,
}

/// Outliers have this many times the variance of ordinary noise, in addition to it.
const OUTLIER_VARIANCE: f64 = 1e4;

/// -1/2 log2 e: a Gaussian's exponent as a power of two.
const HALF_IN_BITS: f64 = -0.5 * core::f64::consts::LOG2_E;

/// Singer prediction: F = [[1, r], [0, s]], Q = `intensity` times the unit process noise.
///
/// Mixing states that lie far apart can round a covariance to one that is none (by 1e4 deg/s in `f32`): no variance
/// of the rate is predicted below its process noise.
#[inline(always)]
pub(crate) fn predict_singer<T: Real>(
    mixed: &Gaussian2<T>,
    step: &SingerCoefficients<T>,
    intensity: T,
) -> Gaussian2<T> {
    let [x0, x1] = mixed.mean;
    let [p00, p01, p11] = mixed.covariance;
    let p01r = p01 + step.r * p11;
    let least = intensity * step.q11;
    Gaussian2 {
        mean: [x0 + step.r * x1, step.s * x1],
        covariance: [
            (p00 + step.r * (p01 + p01r) + least).most(least),
            step.s * p01r + intensity * step.q12,
            step.s * step.s * p11 + intensity * step.q22,
        ],
    }
}

/// A predicted mixture whose covariance is one. Mixing sums moments about a centre and takes the mean's own away; where models lie
/// far apart, rounding can leave a cross term that its variances cannot have, and a gain that throws the state away.
#[inline(always)]
pub(crate) fn sound2<T: Real>(predicted: &Gaussian2<T>, least_acceleration: T) -> Gaussian2<T> {
    let [p00, p01, p11] = predicted.covariance;
    let p11 = p11.most(least_acceleration);
    Gaussian2 { mean: predicted.mean, covariance: [p00, T::select(p01 * p01 <= p00 * p11, p01, T::ZERO), p11] }
}

/// The same for four components: the variances are held above the process noise, and the cross terms of the rate to them.
#[inline(always)]
pub(crate) fn sound4<T: Real>(predicted: &Gaussian4<T>, least: [T; 3]) -> Gaussian4<T> {
    let mut covariance = predicted.covariance;
    for (k, diagonal) in [4, 7, 9].into_iter().enumerate() {
        let (variance, cross) = (covariance[diagonal].most(least[k]), covariance[k + 1]);
        covariance[diagonal] = variance;
        covariance[k + 1] = T::select(cross * cross <= covariance[0] * variance, cross, T::ZERO);
    }
    Gaussian4 { mean: predicted.mean, covariance }
}

/// Mixes the states of two Singer models by their weights and predicts the mixture; the noise is part of `step`. Symmetric, to the bit.
///
/// The predicted variance of the rate is what everything waits for. It is linear in the sources' covariances, so each source is
/// carried forward first, while the weights are still being computed; the rest is mixed, then carried. As in [`predict_singer`], it never
/// falls below the process noise, whatever cross term a state holds.
#[inline(always)]
pub(crate) fn mix_ahead<T: Real>(
    [w, v]: [T; 2],
    a: &Gaussian2<T>,
    b: &Gaussian2<T>,
    step: &SingerCoefficients<T>,
) -> Gaussian2<T> {
    let spread = w * v;
    let d: [T; 2] = core::array::from_fn(|k| a.mean[k] - b.mean[k]);
    let ahead = |p: &[T; 3]| p[0] + step.r * (p[1] + (p[1] + step.r * p[2])) + step.q11;
    let apart = d[0] + step.r * d[1];
    let mean: [T; 2] = core::array::from_fn(|k| w * a.mean[k] + v * b.mean[k]);
    let mixed = |k: usize, product: T| w * a.covariance[k] + v * b.covariance[k] + spread * product;
    let p11 = mixed(2, d[1] * d[1]);
    let p01 = mixed(1, d[0] * d[1]) + step.r * p11;
    Gaussian2 {
        mean: [mean[0] + step.r * mean[1], step.s * mean[1]],
        covariance: [
            (w * ahead(&a.covariance) + v * ahead(&b.covariance) + spread * (apart * apart)).most(step.q11),
            step.s * p01 + step.q12,
            step.s * step.s * p11 + step.q22,
        ],
    }
}

/// Oscillator prediction; the process noise is `intensity` times the unit one. No variance of the rate is predicted below it.
#[inline(always)]
pub(crate) fn predict_oscillator<T: Real>(
    mixed: &Gaussian4<T>,
    step: &OscillatorStep<T>,
    intensity: T,
) -> Gaussian4<T> {
    let (a, b, h) = (&step.from_rate, &step.from_acceleration, &step.response);
    let x = &mixed.mean;
    let p = &mixed.covariance;
    let row = |r: usize, c: [T; 4]| (a[r] * c[0] + b[r] * c[1]) + (h[r + 1] * c[2] + h[r] * c[3]);
    // Rows of P, then F P by columns of P (symmetric), then (F P) F'.
    let rows = [[p[0], p[1], p[2], p[3]], [p[1], p[4], p[5], p[6]], [p[2], p[5], p[7], p[8]], [p[3], p[6], p[8], p[9]]];
    let fp: [[T; 4]; 4] = core::array::from_fn(|r| core::array::from_fn(|c| row(r, rows[c])));
    let q = &step.noise;
    let least = intensity * q[0];
    Gaussian4 {
        mean: core::array::from_fn(|r| row(r, *x)),
        covariance: [
            (row(0, fp[0]) + least).most(least),
            row(1, fp[0]) + intensity * q[1],
            row(2, fp[0]) + intensity * q[2],
            row(3, fp[0]) + intensity * q[3],
            row(1, fp[1]) + intensity * q[4],
            row(2, fp[1]) + intensity * q[5],
            row(3, fp[1]) + intensity * q[6],
            row(2, fp[2]) + intensity * q[7],
            row(3, fp[2]) + intensity * q[8],
            row(3, fp[3]) + intensity * q[9],
        ],
    }
}

/// Innovation, its variance, and the gain's denominator, with the outlier model folded in: returns the evidence, the
/// factor that multiplies `innovation` in the state update, the factor of the covariance reduction, and R/S.
#[inline(always)]
fn weigh<T: Real>(predicted_rate: T, rate_variance: T, reading: &Reading<T>) -> (Evidence<T>, T, T, T) {
    let innovation = reading.value - predicted_rate;
    let variance = rate_variance + reading.variance;
    let inverse = T::ONE / variance;
    let square = innovation * innovation;
    let exponent = T::of(HALF_IN_BITS) * square * inverse;
    let plain =
        Evidence { innovation, innovation_variance: variance, exponent, factor: inverse.root(), outlier: T::ZERO };
    if reading.outlier_probability == T::ZERO {
        return (plain, inverse, inverse, reading.variance * inverse);
    }
    // Two-component noise: the update is the probability-weighted mean of both updates, and its covariance the
    // mixture's (probabilistic data association with a diffuse second component).
    let wide = variance + reading.variance * T::of(OUTLIER_VARIANCE);
    let wide_inverse = T::ONE / wide;
    let wide_exponent = T::of(HALF_IN_BITS) * square * wide_inverse;
    let highest = exponent.most(wide_exponent);
    let good = (T::ONE - reading.outlier_probability) * (exponent - highest).doubling() * plain.factor;
    let bad = reading.outlier_probability * (wide_exponent - highest).doubling() * wide_inverse.root();
    let outlier = bad / (good + bad);
    let ordinary = T::ONE - outlier;
    let move_by = ordinary * inverse + outlier * wide_inverse;
    // P - P0 P0' (mean of 1/S) + P0 P0' (spread of the two moves).
    let spread = ordinary * outlier * (inverse - wide_inverse) * (inverse - wide_inverse) * square;
    let shrink = move_by - spread;
    let evidence = Evidence { exponent: highest, factor: good + bad, outlier, ..plain };
    // 1 - P0 times that, as a sum of what both updates leave: a difference could cancel to less than nothing.
    let wide_noise = reading.variance * T::of(1.0 + OUTLIER_VARIANCE);
    let left = ordinary * (reading.variance * inverse) + outlier * (wide_noise * wide_inverse) + rate_variance * spread;
    (evidence, move_by, shrink, left)
}

/// What a measurement leaves of a variance. Rounding may take all of it and more, but a variance never ends at or below zero.
#[inline(always)]
fn reduced<T: Real>(variance: T, by: T) -> T {
    (variance - by).most(variance * T::EPSILON)
}

/// Updates rate and acceleration.
#[inline(always)]
pub(crate) fn update2<T: Real>(predicted: &Gaussian2<T>, reading: &Reading<T>) -> (Gaussian2<T>, Evidence<T>) {
    let [p00, p01, p11] = predicted.covariance;
    let (evidence, move_by, shrink, left) = weigh(predicted.mean[0], p00, reading);
    let step = move_by * evidence.innovation;
    let moments = Gaussian2 {
        mean: [predicted.mean[0] + p00 * step, predicted.mean[1] + p01 * step],
        covariance: [p00 * left, p01 * left, reduced(p11, p01 * p01 * shrink)],
    };
    (moments, evidence)
}

/// Updates a four-component state.
#[inline(always)]
pub(crate) fn update4<T: Real>(predicted: &Gaussian4<T>, reading: &Reading<T>) -> (Gaussian4<T>, Evidence<T>) {
    let p = &predicted.covariance;
    let (evidence, move_by, shrink, left) = weigh(predicted.mean[0], p[0], reading);
    let step = move_by * evidence.innovation;
    let (k1, k2, k3) = (p[1] * shrink, p[2] * shrink, p[3] * shrink);
    let moments = Gaussian4 {
        mean: core::array::from_fn(|k| predicted.mean[k] + p[k] * step),
        covariance: [
            p[0] * left,
            p[1] * left,
            p[2] * left,
            p[3] * left,
            reduced(p[4], k1 * p[1]),
            p[5] - k1 * p[2],
            p[6] - k1 * p[3],
            reduced(p[7], k2 * p[2]),
            p[8] - k2 * p[3],
            reduced(p[9], k3 * p[3]),
        ],
    };
    (moments, evidence)
}

impl<T: Real> Reading<T> {
    /// An ordinary reading, without the outlier model.
    #[inline(always)]
    pub(crate) fn plain(value: T, variance: T) -> Self {
        Self { value, variance, outlier_probability: T::ZERO }
    }
}

/// Updates a state with a parameter.
#[inline(always)]
pub(crate) fn update3<T: Real>(predicted: &Gaussian3<T>, reading: &Reading<T>) -> (Gaussian3<T>, Evidence<T>) {
    let p = &predicted.covariance;
    let (evidence, move_by, shrink, left) = weigh(predicted.mean[0], p[0], reading);
    let step = move_by * evidence.innovation;
    let (k1, k2) = (p[1] * shrink, p[2] * shrink);
    let moments = Gaussian3 {
        mean: core::array::from_fn(|k| predicted.mean[k] + p[k] * step),
        covariance: [
            p[0] * left,
            p[1] * left,
            p[2] * left,
            reduced(p[3], k1 * p[1]),
            p[4] - k1 * p[2],
            reduced(p[5], k2 * p[2]),
        ],
    };
    (moments, evidence)
}
