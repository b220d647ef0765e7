//! What a gyro adds to the true rate, and the angle variance each part leaves behind a loop.
//!
//! eta = white(N) + Gauss-Markov(sigma_b, tau) + random walk of rate(K). N^2 is the TWO-sided density in
//! (unit/s)^2/Hz, so that an integrator gathers N^2 T; data sheets mix one-sided and two-sided figures, hence a constructor
//! for each. Coloured parts are realised as one more state that drives the loop's input.

use nalgebra::{DMatrix, DVector};
use stillrate::Real;
use stillrate::error::{not_negative, positive};

use super::van_loan::{StateSpace, propagate};
use super::{DriftError, TransferFunction, steady_state};

/// Noise at the input of a loop; any angle unit, deg at the user's edge.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::LoopNoise;
/// let gyro = LoopNoise::from_std_at_rate(0.1074, 50.0).unwrap();
/// assert!((gyro.white_density - 0.015189).abs() < 1e-6); // deg/sqrt(s)
/// let same = LoopNoise::from_arw_deg_sqrt_h(60.0 * 0.1074 / 50.0_f64.sqrt()).unwrap();
/// assert!((same.white_density / gyro.white_density - 1.0).abs() < 1e-14);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopNoise {
    /// N: root of the two-sided density, unit/s/sqrt(Hz) = unit/sqrt(s).
    pub white_density: f64,
    /// sigma_b of the Gauss-Markov part, unit/s.
    pub bias_sigma: f64,
    /// tau of the Gauss-Markov part, s (unused while `bias_sigma` is 0).
    pub bias_time_s: f64,
    /// K: random walk of rate, unit/s/sqrt(s).
    pub rate_random_walk: f64,
}

impl LoopNoise {
    /// White noise from a two-sided density N, unit/s/sqrt(Hz).
    ///
    /// # Errors
    /// A negative or non-finite density.
    pub fn from_density_two_sided(density: f64) -> Result<Self, DriftError> {
        let white_density = not_negative("density_two_sided", density, "")?;
        Ok(Self { white_density, ..Self::default() })
    }
    /// White noise from a one-sided density (most data sheets): sqrt(2) N.
    ///
    /// # Errors
    /// A negative or non-finite density.
    pub fn from_density_one_sided(density: f64) -> Result<Self, DriftError> {
        Self::from_density_two_sided(not_negative("density_one_sided", density, "")? / 2.0.root())
    }
    /// White noise from an angle random walk in unit/sqrt(h): 60 N.
    ///
    /// # Errors
    /// A negative or non-finite figure.
    pub fn from_arw_deg_sqrt_h(arw: f64) -> Result<Self, DriftError> {
        Self::from_density_two_sided(not_negative("arw_deg_sqrt_h", arw, "deg/sqrt(h)")? / 60.0)
    }
    /// White samples of standard deviation `sigma` at `sample_rate_hz`: N = sigma / sqrt(rate).
    ///
    /// # Errors
    /// A negative sigma or a rate that is not positive.
    pub fn from_std_at_rate(sigma: f64, sample_rate_hz: f64) -> Result<Self, DriftError> {
        let rate = positive("sample_rate_hz", sample_rate_hz, "Hz")?;
        Self::from_density_two_sided(not_negative("sigma", sigma, "")? / rate.root())
    }
    /// Adds a Gauss-Markov bias.
    ///
    /// # Errors
    /// A negative sigma or a time constant that is not positive.
    pub fn with_gauss_markov(self, sigma: f64, time_s: f64) -> Result<Self, DriftError> {
        Ok(Self {
            bias_sigma: not_negative("bias_sigma", sigma, "")?,
            bias_time_s: positive("bias_time_s", time_s, "s")?,
            ..self
        })
    }
    /// Adds a random walk of rate.
    ///
    /// # Errors
    /// A negative or non-finite figure.
    pub fn with_rate_random_walk(self, k: f64) -> Result<Self, DriftError> {
        Ok(Self { rate_random_walk: not_negative("rate_random_walk", k, "")?, ..self })
    }
}

/// Variance of the angle, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drift {
    /// From white noise.
    pub white: f64,
    /// From the Gauss-Markov bias.
    pub gauss_markov: f64,
    /// From the random walk of rate.
    pub rate_random_walk: f64,
}

impl Drift {
    /// All causes together (they are independent).
    #[must_use]
    pub fn total(&self) -> f64 {
        self.white + self.gauss_markov + self.rate_random_walk
    }
}

/// Variance of the output of `h` under `noise`: after `time_s` from rest (bias part stationary from the start, random walk from
/// 0), or in the steady state for `None`.
///
/// # Errors
/// Improper loops always; unstable loops and excited poles at 0 when no time is given.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::{LoopNoise, TransferFunction, drift};
/// let noise = LoopNoise::from_density_two_sided(0.0152).unwrap();
/// let integrator = TransferFunction::new(&[1.0], &[1.0, 0.0]).unwrap();
/// assert!(drift(&integrator, &noise, None).unwrap_err().to_string().contains("give time_s"));
/// let minute = drift(&integrator, &noise, Some(60.0)).unwrap();
/// assert!((minute.total().sqrt() - 0.0152 * 60f64.sqrt()).abs() < 1e-12);
/// ```
pub fn drift(h: &TransferFunction, noise: &LoopNoise, time_s: Option<f64>) -> Result<Drift, DriftError> {
    let h = h.without_common_zeros_at_origin();
    h.check_proper()?;
    let pole = if noise.bias_sigma > 0.0 { 1.0 / positive("bias_time_s", noise.bias_time_s, "s")? } else { 0.0 };
    let Some(time_s) = time_s else {
        let n = noise.white_density;
        let shaped = |gain: f64, pole: f64| -> Result<f64, DriftError> {
            if gain == 0.0 {
                return Ok(0.0);
            }
            steady_state(&h.times(&TransferFunction::new(&[gain], &[1.0, pole])?))
        };
        return Ok(Drift {
            white: if n == 0.0 { 0.0 } else { n * n * steady_state(&h)? },
            gauss_markov: shaped(noise.bias_sigma * (2.0 * pole).root(), pole)?,
            rate_random_walk: shaped(noise.rate_random_walk, 0.0)?,
        });
    };
    let time_s = positive("time_s", time_s, "s")?;
    let system = StateSpace::of(&h)?;
    let n = noise.white_density;
    Ok(Drift {
        white: n * n * white_after(&system, time_s),
        gauss_markov: coloured_after(&system, time_s, pole, 2.0 * pole, 1.0) * noise.bias_sigma * noise.bias_sigma,
        rate_random_walk: coloured_after(&system, time_s, 0.0, 1.0, 0.0)
            * noise.rate_random_walk
            * noise.rate_random_walk,
    })
}

fn white_after(system: &StateSpace, time_s: f64) -> f64 {
    let w = &system.b * system.b.transpose();
    let (_, p) = propagate(&system.a, &w, time_s * system.time_scale);
    system.output_variance(&p)
}

/// Output variance for an input g' = -pole g + noise of density `density`, g(0) of variance `start`.
fn coloured_after(system: &StateSpace, time_s: f64, pole: f64, density: f64, start: f64) -> f64 {
    let n = system.a.nrows();
    let scale = system.time_scale;
    let mut a = DMatrix::zeros(n + 1, n + 1);
    a.view_mut((0, 0), (n, n)).copy_from(&system.a);
    a.view_mut((0, n), (n, 1)).copy_from(&system.b);
    a[(n, n)] = -pole / scale;
    let mut w = DMatrix::zeros(n + 1, n + 1);
    w[(n, n)] = density / scale;
    let (phi, p) = propagate(&a, &w, time_s * scale);
    let mut c = DVector::zeros(n + 1);
    c.rows_mut(0, n).copy_from(&system.c);
    let reached = c.dot(&phi.column(n));
    (c.transpose() * p * &c)[(0, 0)] + start * reached * reached
}
