//! Autoregressive coefficients fitted on line: x(n) = sum over k of a(k) x(n - k) + noise, by [`VectorRls`].

use crate::error::ConfigError;
use crate::filter::Flags;
use crate::filters::vector_rls::{VectorRls, VectorRlsEstimate, VectorRlsSettings, VectorRlsState};
use crate::real::Real;

/// Fits an autoregressive model of order `N` sample by sample.
///
/// # Example
/// ```
/// use stillrate::filters::{OnlineAr, VectorRlsSettings};
/// let fit = OnlineAr::<f64, 2>::new(VectorRlsSettings::default())?;
/// let mut state = fit.start();
/// let (mut newer, mut older) = (1.0, 0.0);
/// for _ in 0..200 {
///     fit.step(&mut state, newer);
///     (newer, older) = (1.6 * newer - 0.9 * older, newer); // a ringing resonator
/// }
/// let coefficients = state.rls.weights;
/// assert!((coefficients[0] - 1.6).abs() < 1e-2 && (coefficients[1] + 0.9).abs() < 1e-2);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnlineAr<T, const N: usize> {
    rls: VectorRls<T, N>,
}

/// State of [`OnlineAr`].
///
/// # Example
/// ```
/// use stillrate::filters::{OnlineAr, VectorRlsSettings};
/// let fit = OnlineAr::<f64, 2>::new(VectorRlsSettings::default())?;
/// let mut state = fit.start();
/// for value in [1.0, f64::NAN, 3.0, 4.0] {
///     fit.step(&mut state, value);
/// }
/// assert_eq!((state.past, state.run), ([4.0, 3.0], 2)); // the next sample is the first with two before it
/// assert_eq!(state.rls.weights, [0.0; 2]);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnlineArState<T, const N: usize> {
    /// Coefficients (as weights) and their covariance.
    pub rls: VectorRlsState<T, N>,
    /// The last samples, newest first.
    pub past: [T; N],
    /// How many of them are usable in a row.
    pub run: usize,
}

impl<T: Real, const N: usize> OnlineAr<T, N> {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`ConfigError`] as [`VectorRls::new`].
    pub fn new(settings: VectorRlsSettings) -> Result<Self, ConfigError> {
        Ok(Self { rls: VectorRls::new(settings)? })
    }

    /// Nothing seen, coefficients zero.
    #[must_use]
    pub fn start(&self) -> OnlineArState<T, N> {
        OnlineArState { rls: self.rls.start(), past: [T::ZERO; N], run: 0 }
    }

    /// One sample. After a missing one the fit waits until `N` samples in a row are there again.
    pub fn step(&self, state: &mut OnlineArState<T, N>, value: T) -> VectorRlsEstimate<T> {
        if !value.finite() {
            state.run = 0;
            return VectorRlsEstimate { prediction: T::ZERO, innovation: T::ZERO, flags: Flags::MISSING };
        }
        let estimate = if state.run >= N {
            self.rls.step(&mut state.rls, state.past, value)
        } else {
            VectorRlsEstimate { prediction: T::ZERO, innovation: T::ZERO, flags: Flags::NO_DATA_YET }
        };
        if let Some(oldest) = state.past.last_mut() {
            *oldest = value;
            state.past.rotate_right(1);
        }
        state.run = state.run.saturating_add(1);
        estimate
    }
}
