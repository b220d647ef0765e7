//! Sampled loops: the exact covariance of x <- F x + g v after any number of ticks, and the spectral radius.
//!
//! Doubling as in [`van_loan`](super::van_loan), over the bits of the number of ticks: P(m+n) = P(m) + F^m P(n) F^m'.

use nalgebra::DMatrix;
use stillrate::Real;

/// Covariance after `ticks` steps of x <- F x + noise of covariance `q`, from `start`.
///
/// # Example
/// ```
/// use nalgebra::DMatrix;
/// use stillrate_lab::servo::drift::sampled::covariance_after;
/// let one = DMatrix::from_element(1, 1, 1.0);
/// let walk = covariance_after(&one, &one, &DMatrix::zeros(1, 1), 1000);
/// assert_eq!(walk[(0, 0)], 1000.0);
/// ```
#[must_use]
pub fn covariance_after(f: &DMatrix<f64>, q: &DMatrix<f64>, start: &DMatrix<f64>, ticks: u64) -> DMatrix<f64> {
    let n = f.nrows();
    let (mut phi, mut p) = (f.clone(), q.clone());
    let (mut total_phi, mut total) = (DMatrix::<f64>::identity(n, n), DMatrix::<f64>::zeros(n, n));
    let mut left = ticks;
    while left > 0 {
        if left & 1 == 1 {
            total = &p + &phi * &total * phi.transpose();
            total_phi = &phi * &total_phi;
        }
        p = &p + &phi * &p * phi.transpose();
        phi = &phi * &phi;
        left >>= 1;
    }
    total + &total_phi * start * total_phi.transpose()
}

/// Largest magnitude of an eigenvalue, as the growth of |F^n| for n = 2^`SQUARINGS` (Gelfand's formula).
///
/// # Example
/// ```
/// use nalgebra::DMatrix;
/// use stillrate_lab::servo::drift::sampled::spectral_radius;
/// let turning = DMatrix::from_row_slice(2, 2, &[0.0, -0.9, 0.9, 0.0]);
/// assert!((spectral_radius(&turning) - 0.9).abs() < 1e-9);
/// ```
#[must_use]
pub fn spectral_radius(f: &DMatrix<f64>) -> f64 {
    const SQUARINGS: i32 = 34;
    let mut power = f.clone();
    let mut logarithm = 0.0_f64;
    let mut share = 1.0;
    for _ in 0..=SQUARINGS {
        let size = power.iter().map(|v| v.abs()).fold(0.0, f64::max);
        if size == 0.0 {
            return 0.0;
        }
        if !size.is_finite() {
            return f64::INFINITY;
        }
        logarithm += share * size.logarithm();
        power /= size;
        power = &power * &power;
        share *= 0.5;
    }
    logarithm.exponential()
}
