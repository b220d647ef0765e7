//! Small dense matrices of any size: products with one order of addition, exponential, symmetric eigenvalues.

use nalgebra::DMatrix;
use stillrate::Real;

/// a b, summed from the first column of a to the last (a library kernel might choose its order by the processor).
pub(super) fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut result = DMatrix::zeros(a.nrows(), b.ncols());
    for j in 0..b.ncols() {
        for k in 0..a.ncols() {
            let factor = b[(k, j)];
            if factor != 0.0 {
                for i in 0..a.nrows() {
                    result[(i, j)] += a[(i, k)] * factor;
                }
            }
        }
    }
    result
}

/// e^(A t), by Taylor's series of A t / 2^s squared s times (|A t / 2^s| <= 1/4: thirteen terms leave less than 1e-19).
///
/// # Example
/// ```
/// use nalgebra::DMatrix;
/// use stillrate_lab::observability::exponential;
/// let turn = exponential(&DMatrix::from_row_slice(2, 2, &[0.0, -1.0, 1.0, 0.0]), 1.0);
/// assert!((turn[(1, 0)] - 1.0_f64.sin()).abs() < 1e-15);
/// ```
#[must_use]
pub fn exponential(a: &DMatrix<f64>, t: f64) -> DMatrix<f64> {
    let n = a.nrows();
    let norm = (0..n).map(|i| (0..n).map(|j| (a[(i, j)] * t).abs()).sum::<f64>()).fold(0.0, f64::max);
    let mut halvings = 0;
    let mut scale = t;
    let mut size = norm;
    while size > 0.25 && halvings < 1000 {
        scale *= 0.5;
        size *= 0.5;
        halvings += 1;
    }
    let step = a * scale;
    let mut sum = DMatrix::identity(n, n);
    let mut term = DMatrix::identity(n, n);
    for k in 1..=13 {
        term = product(&term, &step) / f64::from(k);
        sum += &term;
    }
    for _ in 0..halvings {
        sum = product(&sum, &sum);
    }
    sum
}

/// diag(s) M diag(s)
pub(super) fn scaled(m: &DMatrix<f64>, s: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| s[i] * m[(i, j)] * s[j])
}

/// Eigenvalues (ascending) and eigenvectors (columns) of a symmetric matrix, by Jacobi rotations: small eigenvalues of a
/// graded matrix keep their digits.
pub(super) fn eigen(m: &DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let n = m.nrows();
    let mut a = m.clone();
    let mut vectors = DMatrix::identity(n, n);
    for _ in 0..60 {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                rotated |= annihilate(&mut a, &mut vectors, p, q);
            }
        }
        if !rotated {
            break;
        }
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| a[(i, i)].total_cmp(&a[(j, j)]));
    let values = order.iter().map(|&k| a[(k, k)]).collect();
    (values, DMatrix::from_fn(n, n, |i, k| vectors[(i, order[k])]))
}

fn annihilate(a: &mut DMatrix<f64>, vectors: &mut DMatrix<f64>, p: usize, q: usize) -> bool {
    let (app, aqq, apq) = (a[(p, p)], a[(q, q)], a[(p, q)]);
    if apq.abs() <= f64::EPSILON * (app.abs().root() * aqq.abs().root()) || !apq.is_finite() {
        return false;
    }
    let theta = (aqq - app) / (2.0 * apq);
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).root());
    let cosine = 1.0 / (t * t + 1.0).root();
    let sine = t * cosine;
    for k in 0..a.nrows() {
        let (x, y) = (a[(k, p)], a[(k, q)]);
        a[(k, p)] = cosine * x - sine * y;
        a[(k, q)] = sine * x + cosine * y;
    }
    for k in 0..a.nrows() {
        let (x, y) = (a[(p, k)], a[(q, k)]);
        a[(p, k)] = cosine * x - sine * y;
        a[(q, k)] = sine * x + cosine * y;
        let (x, y) = (vectors[(k, p)], vectors[(k, q)]);
        vectors[(k, p)] = cosine * x - sine * y;
        vectors[(k, q)] = sine * x + cosine * y;
    }
    a[(p, q)] = 0.0;
    a[(q, p)] = 0.0;
    true
}

/// sqrt of the diagonal of V diag(f(values)) V'.
pub(super) fn diagonal_of(vectors: &DMatrix<f64>, values: &[f64], f: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..vectors.nrows())
        .map(|i| {
            let sum: f64 = values.iter().enumerate().map(|(k, &v)| vectors[(i, k)] * vectors[(i, k)] * f(v)).sum();
            sum.root()
        })
        .collect()
}

/// Singular values, descending.
pub(super) fn singular_values(m: &DMatrix<f64>) -> Vec<f64> {
    let mut values: Vec<f64> = m.clone().svd(false, false).singular_values.iter().copied().collect();
    values.resize(m.ncols(), 0.0);
    values.sort_by(|x, y| y.total_cmp(x));
    values
}

/// How many values exceed `tolerance` times the first.
pub(super) fn rank(descending: &[f64], tolerance: f64) -> usize {
    let largest = descending.first().copied().unwrap_or(0.0);
    descending.iter().filter(|&&value| value > tolerance * largest).count()
}
