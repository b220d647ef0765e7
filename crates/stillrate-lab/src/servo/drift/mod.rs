//! How gyro noise becomes an angle error: drift propagation through rate loops and tracked loops.
//!
//! A platform's rate loop `G(s)` follows the gyro, so the gyro's noise eta becomes a rate, and its integral an
//! angle error `theta = H eta`. What enters: white noise of two-sided density N^2, Gauss-Markov noise (sigma_b, tau) and
//! a random walk of rate (K). What comes out: the variance of the angle after a time T, or for ever.
//! Source: eq. 3-8 of the servo section of the MS-IMM-IKF paper. Erratum: eq. 3-8 lack the 1/(2 pi) of the variance
//! integral, and eq. 4-5 (rate loop alone) diverge at low frequency: a free integrator has a variance only at a given
//! time. Both are right here.
//!
//! Three independent ways to the same number, held together by tests: Astrom's recursion ([`steady_state`]), the
//! Lyapunov equation ([`lyapunov`]) and Van Loan's step with doubling ([`van_loan`]); quadrature ([`quadrature`]) where a band is
//! cut hard or a dead time sits in the loop, and [`sampled`] for discrete loops.

mod astrom;
pub mod closed_forms;
mod error;
mod loops;
pub mod lyapunov;
mod noise;
mod polynomial;
pub mod quadrature;
pub mod sampled;
mod state_space;
pub mod van_loan;

pub use astrom::steady_state;
pub use error::DriftError;
pub use loops::{DriftLoop, FilterPosition};
pub use noise::{Drift, LoopNoise, drift, drift_in_band};
pub use polynomial::{TransferFunction, multiply};
pub(crate) use van_loan::propagate;
