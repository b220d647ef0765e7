//! Local, stacked and total observability matrices, and the Gramian.

use nalgebra::DMatrix;

use super::matrix::{exponential, product, rank, singular_values};
use super::{Problem, RANK_TOLERANCE, Segment, steps_of};

pub(super) struct Stacked {
    pub(super) local_ranks: Vec<usize>,
    pub(super) ranks: Vec<usize>,
    pub(super) raw: Vec<f64>,
    pub(super) scaled: Vec<f64>,
    pub(super) total: Vec<f64>,
}

/// O = [H; HA; ...; HA^(n-1)]
fn local(segment: &Segment) -> DMatrix<f64> {
    let (m, n) = segment.measurement.shape();
    let mut rows = DMatrix::zeros(m * n, n);
    let mut block = segment.measurement.clone();
    for k in 0..n {
        rows.rows_mut(k * m, m).copy_from(&block);
        block = product(&block, &segment.dynamics);
    }
    rows
}

fn below(upper: &DMatrix<f64>, lower: &DMatrix<f64>) -> DMatrix<f64> {
    let mut both = DMatrix::zeros(upper.nrows() + lower.nrows(), lower.ncols());
    both.rows_mut(0, upper.nrows()).copy_from(upper);
    both.rows_mut(upper.nrows(), lower.nrows()).copy_from(lower);
    both
}

fn by_prior(rows: &DMatrix<f64>, prior: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.nrows(), rows.ncols(), |i, j| rows[(i, j)] * prior[j])
}

pub(super) fn stacked(problem: &Problem) -> Stacked {
    let n = problem.prior_sigma.len();
    let prior = &problem.prior_sigma;
    let mut som = DMatrix::zeros(0, n);
    let mut tom = DMatrix::zeros(0, n);
    let mut since_start = DMatrix::identity(n, n);
    let (mut local_ranks, mut ranks) = (Vec::new(), Vec::new());
    for segment in &problem.segments {
        let own = local(segment);
        local_ranks.push(rank(&singular_values(&by_prior(&own, prior)), RANK_TOLERANCE));
        tom = below(&tom, &product(&own, &since_start));
        som = below(&som, &own);
        ranks.push(rank(&singular_values(&by_prior(&som, prior)), RANK_TOLERANCE));
        since_start = product(&exponential(&segment.dynamics, segment.duration_s), &since_start);
    }
    Stacked {
        local_ranks,
        ranks,
        raw: singular_values(&som),
        scaled: singular_values(&by_prior(&som, prior)),
        total: singular_values(&by_prior(&tom, prior)),
    }
}

/// W = sum F' H' R^-1 H F over all measurements, referred to the start.
pub(super) fn gramian(problem: &Problem) -> DMatrix<f64> {
    let n = problem.prior_sigma.len();
    let mut sum = DMatrix::zeros(n, n);
    let mut since_start = DMatrix::identity(n, n);
    for segment in &problem.segments {
        let step = exponential(&segment.dynamics, problem.interval_s);
        for _ in 0..steps_of(segment, problem.interval_s) {
            since_start = product(&step, &since_start);
            let mut seen = product(&segment.measurement, &since_start);
            for (mut row, &sigma) in seen.row_iter_mut().zip(&problem.measurement_sigma) {
                row /= sigma;
            }
            sum += product(&seen.transpose(), &seen);
        }
    }
    sum
}
