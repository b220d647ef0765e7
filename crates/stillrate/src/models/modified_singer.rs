//! Modified Singer model: rate, acceleration and the manoeuvre parameter alpha (or its logarithm) as a third state.
//!
//! Printed F = [[1, r, 0], [0, s, 0], [0, 0, 1]] with r, s, Q at the current alpha. Erratum: the printed F leaves out how r and s depend
//! on alpha, so that no measurement ever moves it; the exact Jacobian adds the column (r'(alpha) w', s'(alpha) w', 1), and for the
//! logarithm alpha times it.

use crate::gaussian::Gaussian3;
use crate::models::{SingerCoefficients, singer_derivatives};
use crate::real::Real;

/// The parts of a prediction that fading needs to tell apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prediction3<T> {
    pub(crate) mean: [T; 3],
    /// F P F', packed.
    pub(crate) carried: [T; 6],
    /// Process noise q11, q12, q22 and that of the parameter.
    pub(crate) noise: [T; 4],
}

/// How the third state acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameter {
    pub(crate) exact_jacobian: bool,
    pub(crate) logarithmic: bool,
}

/// Smallest and largest alpha T that a step is computed for: beyond, alpha has lost its meaning.
const ALPHA_T: (f64, f64) = (1e-12, 50.0);

/// alpha from the third state, kept where the coefficients make sense.
#[inline(always)]
pub(crate) fn alpha_of<T: Real>(state: T, parameter: Parameter, dt: T) -> T {
    let alpha = if parameter.logarithmic { state.exponential() } else { state };
    alpha.limited(T::of(ALPHA_T.0) / dt, T::of(ALPHA_T.1) / dt)
}

/// Predicts one model; `variance` is sigma_m^2, `alpha_noise` the density of the parameter's random walk.
#[inline(always)]
pub(crate) fn predict_modified<T: Real>(
    mixed: &Gaussian3<T>,
    parameter: Parameter,
    variance: T,
    alpha_noise: T,
    dt: T,
) -> Prediction3<T> {
    let [x0, x1, x2] = mixed.mean;
    let [p00, p01, p02, p11, p12, p22] = mixed.covariance;
    let alpha = alpha_of(x2, parameter, dt);
    let c = SingerCoefficients::new(alpha, dt);
    let (mut a, mut b) = (T::ZERO, T::ZERO);
    if parameter.exact_jacobian {
        let (slope_r, slope_s) = singer_derivatives(alpha, dt);
        let inner = if parameter.logarithmic { alpha } else { T::ONE };
        (a, b) = (slope_r * x1 * inner, slope_s * x1 * inner);
    }
    // Rows of F are (1, r, a), (0, s, b), (0, 0, 1).
    let g0 = [p00 + c.r * p01 + a * p02, p01 + c.r * p11 + a * p12, p02 + c.r * p12 + a * p22];
    let g1 = [c.s * p01 + b * p02, c.s * p11 + b * p12, c.s * p12 + b * p22];
    let intensity = T::TWO * alpha * variance;
    Prediction3 {
        mean: [x0 + c.r * x1, c.s * x1, x2],
        carried: [g0[0] + c.r * g0[1] + a * g0[2], c.s * g0[1] + b * g0[2], g0[2], c.s * g1[1] + b * g1[2], g1[2], p22],
        noise: [intensity * c.q11, intensity * c.q12, intensity * c.q22, alpha_noise * dt],
    }
}

impl<T: Real> Prediction3<T> {
    /// lambda F P F' + Q, lambda on everything or on rate and acceleration only.
    #[inline(always)]
    pub(crate) fn faded(&self, fading: T, fades_parameter: bool) -> Gaussian3<T> {
        let outer = T::select(fades_parameter, fading, T::ONE);
        let [p00, p01, p02, p11, p12, p22] = self.carried;
        let [q11, q12, q22, q33] = self.noise;
        Gaussian3 {
            mean: self.mean,
            covariance: [
                fading * p00 + q11,
                fading * p01 + q12,
                outer * p02,
                fading * p11 + q22,
                outer * p12,
                outer * p22 + q33,
            ],
        }
    }
}
