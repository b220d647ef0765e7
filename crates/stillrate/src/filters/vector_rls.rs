//! Recursive least squares of several weights, y = phi' w, forgetting only where the data has something new ("VectorRls").
//!
//! P = U D U' (U unit upper triangular, D diagonal) stays symmetric and positive by construction. Directional forgetting (Kulhavy, Automatica 23,
//! 1987) in the information form of Bittanti, Bolzern and Campi (Automatica 26, 1990): with q = phi' P^-1 phi the past is forgotten along phi alone,
//! P <- P + c phi phi', c = min((1 - lambda)/(lambda q), (p_max - tr P)/|phi|^2), by Agee and Turner's rank-one update; then Bierman's measurement
//! update (Factorization Methods for Discrete Sequential Estimation, chapter 5) with unit noise. Where |phi|^2 <= 1e-12 nothing happens.
//!
//! The conventional P <- (P - k phi' P)/lambda winds up: with constant input and lambda = 0.9512 it is no covariance any more
//! after 644 samples in `f32`, 1874 in `f64`. Price of forgetting one direction a sample: with input that excites n directions use
//! lambda^n where the conventional filter has lambda. For one weight it is the filter of `hmm_rls` (steady P = 1 - lambda).

use crate::error::ConfigError;
use crate::filter::Flags;
use crate::ranges::{FORGETTING_FACTOR, Range};
use crate::real::Real;
use crate::reals::Reals;

/// What a covariance may start at and grow to.
const COVARIANCE: Range =
    Range { low: 1e-12, high: 1e12, open: false, also: None, unit: "", words: "from 1e-12 to 1e12" };

/// Squared length of phi below which a sample says nothing.
const SMALLEST_EXCITATION: f64 = 1e-12;

/// Settings of [`VectorRls`].
///
/// # Example
/// ```
/// use stillrate::filters::{VectorRls, VectorRlsSettings};
/// let settings = VectorRlsSettings { forgetting_factor: 0.5, ..Default::default() };
/// let rls = VectorRls::<f64, 3>::new(settings)?;
/// assert_eq!((rls.forgetting, rls.initial_covariance), (1.0, 100.0)); // (1 - lambda)/lambda
/// let endless = VectorRlsSettings { forgetting_factor: 1.5, ..settings };
/// assert_eq!(VectorRls::<f64, 3>::new(endless).unwrap_err().field, "forgetting_factor");
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VectorRlsSettings {
    /// lambda, in (0, 1]; default 0.999.
    pub forgetting_factor: f64,
    /// Initial P = p0 I, in squared units of a weight over the noise variance of y; default 100.
    pub initial_covariance: f64,
    /// p_max: the trace that forgetting never lets P exceed; default 1e4.
    pub trace_max: f64,
}

impl Default for VectorRlsSettings {
    fn default() -> Self {
        Self { forgetting_factor: 0.999, initial_covariance: 100.0, trace_max: 1e4 }
    }
}

/// Recursive least squares of `N` weights.
///
/// # Example
/// ```
/// use stillrate::filters::{VectorRls, VectorRlsSettings};
/// let rls = VectorRls::<f64, 2>::new(VectorRlsSettings { forgetting_factor: 0.99, ..Default::default() })?;
/// let mut state = rls.start();
/// for k in 0..500 {
///     let phi = [f64::from(k % 7) - 3.0, f64::from(k % 5) - 2.0];
///     rls.step(&mut state, phi, 2.0 * phi[0] - 0.5 * phi[1]);
/// }
/// assert!((state.weights[0] - 2.0).abs() < 1e-3 && (state.weights[1] + 0.5).abs() < 1e-3);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct VectorRls<T, const N: usize> {
    /// (1 - lambda)/lambda.
    pub forgetting: T,
    /// Initial P on the diagonal.
    pub initial_covariance: T,
    /// Cap of the trace of P.
    pub trace_max: T,
}

/// State of [`VectorRls`]: weights and the factors of P.
///
/// # Example
/// ```
/// use stillrate::filters::{VectorRls, VectorRlsSettings};
/// let rls = VectorRls::<f64, 2>::new(VectorRlsSettings { forgetting_factor: 1.0, ..Default::default() })?;
/// let mut state = rls.start();
/// assert_eq!((state.trace(), state.covariance()), (200.0, [[100.0, 0.0], [0.0, 100.0]]));
/// rls.step(&mut state, [3.0, 4.0], 1.0); // says something along (3, 4) only
/// let p = state.covariance();
/// assert!((p[0][0] * 3.0 + p[0][1] * 4.0).abs() < 0.2 && state.trace() > 100.0);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct VectorRlsState<T, const N: usize> {
    /// w.
    pub weights: [T; N],
    /// U, unit upper triangular.
    pub upper: [[T; N]; N],
    /// The diagonal of D.
    pub diagonal: [T; N],
}

impl<T: Real, const N: usize> Reals<T> for VectorRlsState<T, N> {
    const COUNT: usize = N * (N + 2);
    fn gather(next: &mut impl FnMut() -> T) -> Self {
        Self { weights: Reals::gather(next), upper: Reals::gather(next), diagonal: Reals::gather(next) }
    }
    fn scatter(&self, put: &mut impl FnMut(T)) {
        self.weights.scatter(put);
        self.upper.scatter(put);
        self.diagonal.scatter(put);
    }
}

/// What one step of [`VectorRls`] saw.
///
/// # Example
/// ```
/// use stillrate::{Flags, filters::{VectorRls, VectorRlsSettings}};
/// let rls = VectorRls::<f64, 1>::new(VectorRlsSettings::default())?;
/// let mut state = rls.start();
/// rls.step(&mut state, [1.0], 3.0);
/// let estimate = rls.step(&mut state, [2.0], 7.0);
/// assert!((estimate.prediction - 6.0).abs() < 0.1); // from what was known before
/// assert_eq!(estimate.prediction + estimate.innovation, 7.0);
/// assert_eq!(rls.step(&mut state, [2.0], f64::NAN).flags, Flags::MISSING);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VectorRlsEstimate<T> {
    /// phi' w before the sample was used; 0 where phi is not finite.
    pub prediction: T,
    /// y - prediction; 0 where the sample is missing.
    pub innovation: T,
    /// What happened.
    pub flags: Flags,
}

fn dot<T: Real, const N: usize>(a: &[T; N], b: &[T; N]) -> T {
    a.iter().zip(b).fold(T::ZERO, |sum, (&x, &y)| sum + x * y)
}

impl<T: Real, const N: usize> VectorRlsState<T, N> {
    /// P, assembled from its factors.
    #[must_use]
    pub fn covariance(&self) -> [[T; N]; N] {
        core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                (0..N).fold(T::ZERO, |sum, k| sum + self.upper[i][k] * self.diagonal[k] * self.upper[j][k])
            })
        })
    }

    /// Trace of P.
    #[must_use]
    pub fn trace(&self) -> T {
        let squares = |row: &[T; N]| row.iter().zip(&self.diagonal).fold(T::ZERO, |sum, (&u, &d)| sum + u * u * d);
        self.upper.iter().fold(T::ZERO, |sum, row| sum + squares(row))
    }

    /// phi' P^-1 phi, by solving U z = phi from the last row up.
    fn information(&self, phi: &[T; N]) -> T {
        let mut z = *phi;
        let mut sum = T::ZERO;
        for j in (0..N).rev() {
            for i in 0..j {
                z[i] -= self.upper[i][j] * z[j];
            }
            sum += z[j] * z[j] / self.diagonal[j];
        }
        sum
    }

    /// P <- P + c a a' for c >= 0 (Agee and Turner).
    fn grow(&mut self, mut c: T, mut a: [T; N]) {
        for j in (0..N).rev() {
            let s = a[j];
            let old = self.diagonal[j];
            let new = old + c * s * s;
            let beta = s * c / new;
            c = c * old / new;
            self.diagonal[j] = new;
            for i in 0..j {
                a[i] -= s * self.upper[i][j];
                self.upper[i][j] += beta * a[i];
            }
        }
    }

    /// Bierman's update of the factors with unit noise; returns the gain.
    fn measure(&mut self, phi: &[T; N]) -> [T; N] {
        let f: [T; N] = core::array::from_fn(|j| (0..=j).fold(T::ZERO, |sum, i| sum + self.upper[i][j] * phi[i]));
        let mut gain = [T::ZERO; N];
        let mut alpha = T::ONE;
        for j in 0..N {
            let v = self.diagonal[j] * f[j];
            let before = alpha;
            alpha += v * f[j];
            self.diagonal[j] = self.diagonal[j] * before / alpha;
            let p = -f[j] / before;
            for i in 0..j {
                let old = self.upper[i][j];
                self.upper[i][j] = old + gain[i] * p;
                gain[i] += old * v;
            }
            gain[j] = v;
        }
        gain.map(|k| k / alpha)
    }

    fn sound(&self) -> bool {
        self.diagonal.iter().all(|&d| d > T::ZERO && d.finite())
            && self.weights.iter().all(|w| w.finite())
            && self.upper.iter().flatten().all(|u| u.finite())
    }
}

impl<T: Real, const N: usize> VectorRls<T, N> {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`ConfigError`] for a setting outside its range.
    pub fn new(settings: VectorRlsSettings) -> Result<Self, ConfigError> {
        let factor = FORGETTING_FACTOR.check("forgetting_factor", settings.forgetting_factor)?;
        let initial = COVARIANCE.check("initial_covariance", settings.initial_covariance)?;
        let trace_max = COVARIANCE.check("trace_max", settings.trace_max)?;
        Ok(Self {
            forgetting: T::of((1.0 - factor) / factor),
            initial_covariance: T::of(initial),
            trace_max: T::of(trace_max),
        })
    }

    /// Weights zero, P = p0 I.
    #[must_use]
    pub fn start(&self) -> VectorRlsState<T, N> {
        let unit = |i: usize, j: usize| T::select(i == j, T::ONE, T::ZERO);
        VectorRlsState {
            weights: [T::ZERO; N],
            upper: core::array::from_fn(|i| core::array::from_fn(|j| unit(i, j))),
            diagonal: [self.initial_covariance; N],
        }
    }

    /// One sample y = phi' w + noise. Never fails: what cannot be used is flagged and changes nothing.
    pub fn step(&self, state: &mut VectorRlsState<T, N>, phi: [T; N], y: T) -> VectorRlsEstimate<T> {
        let length2 = dot(&phi, &phi);
        if !length2.finite() {
            return VectorRlsEstimate { prediction: T::ZERO, innovation: T::ZERO, flags: Flags::MISSING };
        }
        let prediction = dot(&phi, &state.weights);
        if !(y.finite() && prediction.finite()) {
            let prediction = T::select(prediction.finite(), prediction, T::ZERO);
            return VectorRlsEstimate { prediction, innovation: T::ZERO, flags: Flags::MISSING };
        }
        let innovation = y - prediction;
        if length2 > T::of(SMALLEST_EXCITATION) {
            let mut next = *state;
            next.grow(self.growth(state, &phi, length2), phi);
            let gain = next.measure(&phi);
            for (weight, k) in next.weights.iter_mut().zip(gain) {
                *weight += k * innovation;
            }
            if !next.sound() {
                // A product overflowed: the sample was absurd, the state is kept.
                return VectorRlsEstimate { prediction, innovation, flags: Flags::OUT_OF_RANGE };
            }
            *state = next;
        }
        VectorRlsEstimate { prediction, innovation, flags: Flags::NONE }
    }

    /// c: how much forgetting along phi adds to P, within the cap.
    fn growth(&self, state: &VectorRlsState<T, N>, phi: &[T; N], length2: T) -> T {
        let room = ((self.trace_max - state.trace()) / length2).most(T::ZERO);
        (self.forgetting / state.information(phi)).least(room)
    }
}
