//! Variance after any time: one short step by its power series, then doubling.
//!
//! The covariance of x' = A x + noise of density W obeys P(2t) = P(t) + Phi(t) P(t) Phi(t)' and Phi(2t) = Phi(t)^2
//! (C. F. Van Loan, Computing integrals involving the matrix exponential, 1978). The short step is chosen so that
//! |A| t <= 1/2, where 24 terms of the series reach the last bit. Nothing here minds an unstable loop or a pole at 0: this is the way for finite times.

use nalgebra::{DMatrix, DVector};
use stillrate::Real;

use super::{DriftError, TransferFunction};

/// Terms of the power series: 1^24/24! is far below the last bit of 1.
const TERMS: usize = 24;
/// Norm of A times the short step: bounds both series' arguments by 1.
const SHORT_STEP: f64 = 0.5;

/// A transfer function as x' = A x + b u, y = c x, in scaled time t' = t `time_scale`.
#[derive(Clone, Debug)]
pub struct StateSpace {
    /// Companion matrix.
    pub a: DMatrix<f64>,
    /// Input column.
    pub b: DVector<f64>,
    /// Output row.
    pub c: DVector<f64>,
    /// Scaled seconds in a second (a power of two): brings the coefficients near 1.
    pub time_scale: f64,
}

impl StateSpace {
    /// Companion form of a strictly proper transfer function.
    ///
    /// # Errors
    /// [`DriftError::InfiniteVariance`] if it is not strictly proper.
    pub fn of(h: &TransferFunction) -> Result<Self, DriftError> {
        h.check_proper()?;
        let n = h.order();
        let scale = time_scale(&h.denominator);
        let lead = h.denominator[0];
        let mut a = DMatrix::zeros(n, n);
        let mut power = 1.0;
        for i in 0..n {
            power *= scale;
            a[(0, i)] = -h.denominator[i + 1] / lead / power;
            if i > 0 {
                a[(i, i - 1)] = 1.0;
            }
        }
        let mut c = DVector::zeros(n);
        let offset = n - h.numerator.len();
        let mut power = 1.0;
        for i in 0..n {
            // H(s) = H(scale s'): a numerator entry at power n-1-i has lost i+1 powers against the leading s'^n.
            power *= scale;
            if i >= offset {
                c[i] = h.numerator[i - offset] / lead / power;
            }
        }
        let mut b = DVector::zeros(n);
        if n > 0 {
            b[0] = 1.0;
        }
        Ok(Self { a, b, c, time_scale: scale })
    }

    /// Variance of y for a state covariance that was driven by white noise of density 1 per second of scaled time.
    #[must_use]
    pub fn output_variance(&self, p: &DMatrix<f64>) -> f64 {
        // Unit density in real time is density `time_scale` in scaled time.
        (self.c.transpose() * p * &self.c)[(0, 0)] * self.time_scale
    }
}

/// Largest |a_i / a_0|^(1/i), rounded down to a power of two so that scaling is exact.
fn time_scale(denominator: &[f64]) -> f64 {
    let mut largest = 0.0_f64;
    for (i, c) in denominator.iter().enumerate().skip(1) {
        if *c != 0.0 {
            largest = largest.max(((c / denominator[0]).abs().logarithm() / i as f64).exponential());
        }
    }
    let mut scale = 1.0;
    while scale * 2.0 <= largest && scale < 1e30 {
        scale *= 2.0;
    }
    while scale > largest && largest > 0.0 && scale > 1e-30 {
        scale *= 0.5;
    }
    scale
}

/// Transition matrix and covariance after time `t` of x' = A x + noise of density `w`, from a zero start.
#[must_use]
pub fn propagate(a: &DMatrix<f64>, w: &DMatrix<f64>, t: f64) -> (DMatrix<f64>, DMatrix<f64>) {
    let norm = (0..a.nrows()).map(|i| a.row(i).iter().map(|v| v.abs()).sum::<f64>()).fold(0.0, f64::max);
    let mut short = t;
    let mut doublings = 0;
    while norm * short > SHORT_STEP && doublings < 200 {
        short *= 0.5;
        doublings += 1;
    }
    let (mut phi, mut p) = series(a, w, short);
    for _ in 0..doublings {
        p = &p + &phi * &p * phi.transpose();
        p = (&p + p.transpose()) * 0.5;
        phi = &phi * &phi;
    }
    (phi, p)
}

/// exp(A t) and int_0^t exp(A s) W exp(A' s) ds by their power series.
fn series(a: &DMatrix<f64>, w: &DMatrix<f64>, t: f64) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = a.nrows();
    let mut term = DMatrix::<f64>::identity(n, n);
    let mut phi = term.clone();
    let mut load = w * t;
    let mut p = load.clone();
    for k in 1..TERMS {
        term = a * &term * (t / k as f64);
        phi += &term;
        let half = a * &load;
        load = (&half + half.transpose()) * (t / (k + 1) as f64);
        p += &load;
    }
    (phi, p)
}

/// Variance of the output a time `time_s` after a zero start, for white noise of two-sided density 1.
///
/// # Errors
/// An improper transfer function or a time that is not finite and positive.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::{TransferFunction, van_loan};
/// let integrator = TransferFunction::new(&[1.0], &[1.0, 0.0]).unwrap();
/// assert!((van_loan::variance_after(&integrator, 60.0).unwrap() - 60.0).abs() < 1e-12);
/// ```
pub fn variance_after(h: &TransferFunction, time_s: f64) -> Result<f64, DriftError> {
    let time_s = stillrate::error::positive("time_s", time_s, "s")?;
    let system = StateSpace::of(h)?;
    let w = &system.b * system.b.transpose();
    let (_, p) = propagate(&system.a, &w, time_s * system.time_scale);
    Ok(system.output_variance(&p))
}

/// Steady-state variance by doubling until the transition has died out (stable systems only).
///
/// # Errors
/// As [`steady_state`](super::steady_state).
pub fn steady_state(h: &TransferFunction) -> Result<f64, DriftError> {
    super::steady_state(h)?;
    let system = StateSpace::of(&h.without_common_zeros_at_origin())?;
    let w = &system.b * system.b.transpose();
    let (mut phi, mut p) = propagate(&system.a, &w, 1.0);
    while phi.iter().any(|v| v.abs() > 1e-30) {
        p = &p + &phi * &p * phi.transpose();
        phi = &phi * &phi;
    }
    Ok(system.output_variance(&p))
}
