//! Variance after any time: one short step by its power series, then doubling.
//!
//! The covariance of x' = A x + noise of density W obeys P(2t) = P(t) + Phi(t) P(t) Phi(t)' and Phi(2t) = Phi(t)^2
//! (C. F. Van Loan, Computing integrals involving the matrix exponential, 1978). The short step is chosen so that
//! |A| t <= 1/2, where 24 terms of the series reach the last bit. Nothing here minds an unstable loop or a pole at 0: this is the way for finite times.

use nalgebra::DMatrix;

use super::state_space::StateSpace;
use super::{DriftError, TransferFunction};

/// Terms of the power series: 1^24/24! is far below the last bit of 1.
const TERMS: usize = 24;
/// Norm of A times the short step: bounds both series' arguments by 1.
const SHORT_STEP: f64 = 0.5;

/// Transition matrix and covariance after time `t` of x' = A x + noise of density `w`, from a zero start.
pub(crate) fn propagate(a: &DMatrix<f64>, w: &DMatrix<f64>, t: f64) -> (DMatrix<f64>, DMatrix<f64>) {
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
    let (_, p) = propagate(&system.a, &system.input_noise(), time_s * system.time_scale);
    Ok(system.output_variance(&p))
}

/// Steady-state variance by doubling until the transition has died out (stable systems only).
///
/// # Errors
/// As [`steady_state`](super::steady_state).
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::{TransferFunction, van_loan};
/// let lag = TransferFunction::new(&[6.0], &[1.0, 6.0]).unwrap();
/// assert!((van_loan::steady_state(&lag).unwrap() - 3.0).abs() < 1e-14);
/// ```
pub fn steady_state(h: &TransferFunction) -> Result<f64, DriftError> {
    super::steady_state(h)?;
    let system = StateSpace::of(&h.without_common_zeros_at_origin())?;
    let (mut phi, mut p) = propagate(&system.a, &system.input_noise(), 1.0);
    while phi.iter().any(|v| v.abs() > 1e-30) {
        p = &p + &phi * &p * phi.transpose();
        phi = &phi * &phi;
    }
    Ok(system.output_variance(&p))
}
