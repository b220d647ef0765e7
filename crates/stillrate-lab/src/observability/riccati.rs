//! The covariance a Kalman filter would have, with process noise: predict each interval, then one row of H after the other.

use nalgebra::DMatrix;
use stillrate::Real;

use super::matrix::{eigen, exponential, product};
use super::{Problem, WeakDirection, steps_of};

pub(super) struct Riccati {
    pub(super) over_prior: Vec<f64>,
    pub(super) tenth_of_prior_s: Vec<f64>,
    pub(super) weak_directions: Vec<WeakDirection>,
}

/// Variance, in units of the prior's, at which a state is down to a tenth of its prior deviation.
const TENTH: f64 = 0.01;

/// Share of the prior above which a direction counts as weak.
const WEAK: f64 = 0.5;

/// All in units of the prior: P starts as the identity.
pub(super) fn run(problem: &Problem) -> Riccati {
    let prior = &problem.prior_sigma;
    let n = prior.len();
    let mut covariance = DMatrix::identity(n, n);
    let noise: Vec<f64> =
        problem.process_density.iter().zip(prior).map(|(q, p)| q / p * (q / p) * problem.interval_s).collect();
    let mut tenth_of_prior_s = vec![f64::NAN; n];
    let mut time = 0.0;
    for segment in &problem.segments {
        let step = exponential(&segment.dynamics, problem.interval_s);
        let step = DMatrix::from_fn(n, n, |i, j| step[(i, j)] * prior[j] / prior[i]);
        let rows: Vec<Vec<f64>> = segment
            .measurement
            .row_iter()
            .zip(&problem.measurement_sigma)
            .map(|(row, sigma)| row.iter().zip(prior).map(|(h, p)| h * p / sigma).collect())
            .collect();
        for _ in 0..steps_of(segment, problem.interval_s) {
            time += problem.interval_s;
            covariance = product(&product(&step, &covariance), &step.transpose());
            for (k, q) in noise.iter().enumerate() {
                covariance[(k, k)] += q;
            }
            for row in &rows {
                measure(&mut covariance, row);
            }
            for (k, when) in tenth_of_prior_s.iter_mut().enumerate() {
                if when.is_nan() && covariance[(k, k)] <= TENTH {
                    *when = time;
                }
            }
        }
    }
    let (values, vectors) = eigen(&covariance);
    let weak_directions = (0..n)
        .rev()
        .filter(|&k| values[k] > WEAK * WEAK)
        .map(|k| WeakDirection {
            over_prior: values[k].root(),
            components: vectors.column(k).iter().copied().collect(),
        })
        .collect();
    let over_prior = (0..n).map(|k| covariance[(k, k)].root()).collect();
    Riccati { over_prior, tenth_of_prior_s, weak_directions }
}

/// One scalar measurement of unit variance, in Joseph's form: P <- (I - k h) P (I - k h)' + k k'.
fn measure(covariance: &mut DMatrix<f64>, h: &[f64]) {
    let n = h.len();
    let ph: Vec<f64> = (0..n).map(|i| (0..n).map(|j| covariance[(i, j)] * h[j]).sum()).collect();
    let variance = 1.0 + h.iter().zip(&ph).map(|(a, b)| a * b).sum::<f64>();
    let gain: Vec<f64> = ph.iter().map(|x| x / variance).collect();
    let closed = DMatrix::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - gain[i] * h[j]);
    let updated = product(&product(&closed, covariance), &closed.transpose());
    for i in 0..n {
        for j in 0..n {
            covariance[(i, j)] = 0.5 * (updated[(i, j)] + updated[(j, i)]) + gain[i] * gain[j];
        }
    }
}
