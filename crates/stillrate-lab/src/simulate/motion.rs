//! The random motions of the beds, as linear systems driven by white noise and discretised exactly.
//!
//! Three-fold pole 1/(s + a)^3 as a cascade x1' = -a x1 + w, x2' = -a x2 + x1, x3' = -a x3 + x2, whose state moments
//! are integrals of t^m e^(-2at); second-order resonator w'' + 2 gamma w' + w0^2 w = n. Both are scaled to an output of
//! unit variance. The covariance of one step is Q = int_0^T h h' dt with h the impulse response of the state: summed
//! as a positive series or by Gauss-Legendre quadrature, never as P - F P F', which cancels at high rates.

use core::f64::consts::TAU;

use nalgebra::{SMatrix, SVector};
use stillrate::Real;

use crate::random::Random;

/// One step of a linear system: x' = F x + noise of covariance Q; `stationary` is its covariance in the long run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LinearStep<const D: usize> {
    /// Transition over one period.
    pub(crate) transition: SMatrix<f64, D, D>,
    /// Covariance of what a period adds.
    pub(crate) process_noise: SMatrix<f64, D, D>,
    /// Covariance of the state in the long run.
    pub(crate) stationary: SMatrix<f64, D, D>,
}

/// int_0^T t^m e^(-b t) dt as the positive series T^(m+1) e^(-bT) sum_k (bT)^k / ((m+1) ... (m+1+k)).
fn moment_integral(m: u32, b: f64, period: f64) -> f64 {
    let x = b * period;
    let mut term = 1.0 / f64::from(m + 1);
    let (mut sum, mut k) = (0.0, m + 1);
    while term > sum * f64::EPSILON * 0.1 {
        sum += term;
        k += 1;
        term *= x / f64::from(k);
    }
    (0..=m).fold(1.0, |power, _| power * period) * (-x).exponential() * sum
}

/// Three-fold pole at `pole_rad_s` over a period; the third state has unit variance.
pub(crate) fn three_fold_pole(pole_rad_s: f64, period_s: f64) -> LinearStep<3> {
    let (a, t) = (pole_rad_s, period_s);
    let factorial = [1.0, 1.0, 2.0, 6.0, 24.0];
    let two_a = 2.0 * a;
    let power = |x: f64, n: usize| (0..n).fold(1.0, |p, _| p * x);
    // Var x3 = q 24 / (2! 2! (2a)^5) = 1.
    let intensity = power(two_a, 5) / 6.0;
    let decay = (-a * t).exponential();
    let transition = SMatrix::from_fn(|i, j| if i < j { 0.0 } else { decay * power(t, i - j) / factorial[i - j] });
    let scale = |i: usize, j: usize| intensity / (factorial[i] * factorial[j]);
    let process_noise = SMatrix::from_fn(|i, j| scale(i, j) * moment_integral((i + j) as u32, two_a, t));
    let stationary = SMatrix::from_fn(|i, j| scale(i, j) * factorial[i + j] / power(two_a, i + j + 1));
    LinearStep { transition, process_noise, stationary }
}

/// Nodes and weights of 4-point Gauss-Legendre quadrature on -1..1 (positive half).
const GAUSS_LEGENDRE: [(f64, f64); 2] =
    [(0.339_981_043_584_856_26, 0.652_145_154_862_546_1), (0.861_136_311_594_052_6, 0.347_854_845_137_453_86)];

/// Resonator w'' + 2 gamma w' + w0^2 w = n over a period; states w (unit variance) and w'.
pub(crate) fn resonator(frequency_rad_s: f64, damping_rad_s: f64, period_s: f64) -> LinearStep<2> {
    let (w0, gamma) = (frequency_rad_s, damping_rad_s);
    let wd = (w0 * w0 - gamma * gamma).root();
    let intensity = 4.0 * gamma * w0 * w0;
    // Response of (w, w') to a unit impulse of n at time 0.
    let impulse = |t: f64| {
        let (sine, cosine) = (wd * t).sine_cosine();
        let decay = (-gamma * t).exponential();
        SVector::<f64, 2>::new(decay * sine / wd, decay * (cosine - gamma / wd * sine))
    };
    let (sine, cosine) = (wd * period_s).sine_cosine();
    let decay = (-gamma * period_s).exponential();
    let tilt = gamma / wd * sine;
    let transition = SMatrix::<f64, 2, 2>::new(cosine + tilt, sine / wd, -w0 * w0 / wd * sine, cosine - tilt) * decay;
    // Panels of at most 1/4 rad keep 4 points exact to rounding.
    let panels = (w0 * period_s * 4.0).ceil().max(1.0);
    let half = 0.5 * period_s / panels;
    let mut process_noise = SMatrix::<f64, 2, 2>::zeros();
    for panel in 0..panels as usize {
        let middle = (2 * panel + 1) as f64 * half;
        for (node, weight) in GAUSS_LEGENDRE {
            for t in [middle - half * node, middle + half * node] {
                let h = impulse(t);
                process_noise += h * h.transpose() * (intensity * weight * half);
            }
        }
    }
    let stationary = SMatrix::from_diagonal(&SVector::<f64, 2>::new(1.0, w0 * w0));
    LinearStep { transition, process_noise, stationary }
}

/// Lower triangular L with L L' = `matrix`; a direction without variance gets a zero column.
fn cholesky<const D: usize>(matrix: &SMatrix<f64, D, D>) -> SMatrix<f64, D, D> {
    let mut lower = SMatrix::<f64, D, D>::zeros();
    for j in 0..D {
        for i in j..D {
            let dot: f64 = (0..j).map(|k| lower[(i, k)] * lower[(j, k)]).sum();
            let rest = matrix[(i, j)] - dot;
            let pivot = if i == j { rest.max(0.0).root() } else { lower[(j, j)] };
            lower[(i, j)] = if i == j {
                pivot
            } else if pivot > 0.0 {
                rest / pivot
            } else {
                0.0
            };
        }
    }
    lower
}

/// Output `state` of the system at `count` steps, started in its long-run distribution.
pub(crate) fn sample_path<const D: usize>(
    step: &LinearStep<D>,
    state: usize,
    count: usize,
    random: &mut Random,
) -> Vec<f64> {
    let start = cholesky(&step.stationary);
    let noise = cholesky(&step.process_noise);
    let mut normals = || SVector::<f64, D>::from_fn(|_, _| random.normal());
    let mut x = start * normals();
    (0..count)
        .map(|_| {
            let now = x[state];
            x = step.transition * x + noise * normals();
            now
        })
        .collect()
}

/// Knots beyond each end of a spline: what happens at the outermost knot fades by 3.7 a knot, to 1e-14 over these.
const SPARE_KNOTS: usize = 24;
/// Rate at which the three-fold pole is generated, Hz.
const KNOT_RATE_HZ: f64 = 10.0;

/// Unit-variance process with a three-fold pole at `times_s` (all in 0..=`duration_s`): exact at 10 Hz, natural cubic
/// spline between.
pub(crate) fn smooth_process(pole_rad_s: f64, times_s: &[f64], duration_s: f64, random: &mut Random) -> Vec<f64> {
    let count = (duration_s.max(0.0) * KNOT_RATE_HZ).ceil() as usize + 2 * SPARE_KNOTS;
    let knots = sample_path(&three_fold_pole(pole_rad_s, 1.0 / KNOT_RATE_HZ), 2, count, random);
    let curvature = spline_curvature(&knots);
    times_s
        .iter()
        .map(|t| {
            let position = t * KNOT_RATE_HZ + SPARE_KNOTS as f64;
            let k = (position.max(0.0) as usize).min(count - 2);
            let (v, u) = (position - k as f64, 1.0 - (position - k as f64));
            // Cubic between two knots in terms of their values and second derivatives (unit spacing).
            u * knots[k]
                + v * knots[k + 1]
                + ((u * u * u - u) * curvature[k] + (v * v * v - v) * curvature[k + 1]) / 6.0
        })
        .collect()
}

/// Second derivatives of the natural cubic spline through unit-spaced `y`: M(k-1) + 4 M(k) + M(k+1) = 6 d2y(k).
fn spline_curvature(y: &[f64]) -> Vec<f64> {
    let n = y.len();
    let mut curvature = vec![0.0; n];
    let mut upper = vec![0.0; n];
    for k in 1..n - 1 {
        let pivot = 4.0 - upper[k - 1];
        upper[k] = 1.0 / pivot;
        curvature[k] = (6.0 * (y[k + 1] - 2.0 * y[k] + y[k - 1]) - curvature[k - 1]) / pivot;
    }
    for k in (1..n - 1).rev() {
        curvature[k] -= upper[k] * curvature[k + 1];
    }
    curvature
}

/// Sine and cosine of 2 pi f t, reduced to one turn first, so that long runs keep their phase.
pub(crate) fn carrier(frequency_hz: f64, t_s: f64) -> (f64, f64) {
    let turns = frequency_hz * t_s;
    (TAU * (turns - turns.floor())).sine_cosine()
}

#[cfg(test)]
mod tests {
    use super::{LinearStep, cholesky, resonator, smooth_process, spline_curvature, three_fold_pole};
    use crate::random::Random;

    fn is_stationary<const D: usize>(step: &LinearStep<D>, tolerance: f64) {
        let (f, p) = (step.transition, step.stationary);
        let next = f * p * f.transpose() + step.process_noise;
        for i in 0..D {
            for j in 0..D {
                let scale = (p[(i, i)] * p[(j, j)]).sqrt();
                assert!((next[(i, j)] - p[(i, j)]).abs() < tolerance * scale, "({i},{j})");
            }
        }
    }

    #[test]
    fn a_step_keeps_the_long_run_covariance() {
        for period in [1e-4, 1e-3, 0.02, 0.1, 2.0] {
            is_stationary(&three_fold_pole(0.5, period), 1e-14);
            is_stationary(&resonator(12.566, 0.25, period), 1e-13);
        }
    }

    #[test]
    fn outputs_have_unit_variance() {
        assert!((three_fold_pole(0.5, 0.1).stationary[(2, 2)] - 1.0).abs() < 1e-14);
        assert_eq!(resonator(12.6, 0.25, 0.02).stationary[(0, 0)], 1.0);
    }

    #[test]
    fn two_steps_equal_one_of_twice_the_length() {
        let (one, two) = (three_fold_pole(0.5, 0.001), three_fold_pole(0.5, 0.002));
        let f = one.transition;
        let q = f * one.process_noise * f.transpose() + one.process_noise;
        for i in 0..3 {
            for j in 0..3 {
                assert!((q[(i, j)] / two.process_noise[(i, j)] - 1.0).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn the_factor_of_a_covariance_multiplies_back() {
        let q = three_fold_pole(0.5, 0.1).process_noise;
        let l = cholesky(&q);
        assert!((l * l.transpose() - q).abs().max() < 1e-16);
    }

    #[test]
    fn the_spline_passes_its_knots_and_follows_a_cubic_inside() {
        let y: Vec<f64> = (0..80)
            .map(|k| {
                let x = f64::from(k) / 40.0 - 1.0;
                x * x * x
            })
            .collect();
        let m = spline_curvature(&y);
        // y'' = 6 x, times the squared spacing, away from the natural ends.
        for k in 30..50 {
            let x = k as f64 / 40.0 - 1.0;
            assert!((m[k] - 6.0 * x / 1600.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_smooth_process_has_unit_variance_and_its_correlation() {
        // Autocorrelation of the three-fold pole: (1 + a t + (a t)^2 / 3) exp(-a t).
        let t: Vec<f64> = (0..50_000).map(|k| 0.4 * f64::from(k)).collect();
        let x = smooth_process(0.5, &t, 20_000.0, &mut Random::new(8, 0));
        let n = x.len() as f64;
        let correlation = |lag: usize| x.windows(lag + 1).map(|w| w[0] * w[lag]).sum::<f64>() / n;
        let model = |t: f64| {
            let z = 0.5 * t;
            (1.0 + z + z * z / 3.0) * (-z).exp()
        };
        // About 20000 s / 10 s independent values: standard error near .03.
        for lag in [0, 5, 10] {
            assert!((correlation(lag) - model(0.4 * lag as f64)).abs() < 0.1, "{lag}: {}", correlation(lag));
        }
    }
}
