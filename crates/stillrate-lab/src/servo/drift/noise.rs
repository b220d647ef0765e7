//! What a gyro adds to the true rate, and the angle variance each part leaves behind a loop.
//!
//! eta = white(N) + Gauss-Markov(sigma_b, tau) + random walk of rate(K). N^2 is the TWO-sided density in
//! (unit/s)^2/Hz, so that an integrator gathers N^2 T; data sheets mix one-sided and two-sided figures, hence a constructor
//! for each. Coloured parts are realised as one more state that drives the loop's input.

use nalgebra::{DMatrix, DVector};
use stillrate::Real;
use stillrate::error::{not_negative, positive};

use super::quadrature::band_variance;
use super::state_space::StateSpace;
use super::van_loan::propagate;
use super::{DriftError, DriftLoop, TransferFunction, steady_state};

/// Relative accuracy of a quadrature over a band.
const BAND_ACCURACY: f64 = 1e-13;

/// Noise at the input of a loop; any angle unit, deg at the user's edge.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::LoopNoise;
/// let gyro = LoopNoise::from_std_at_rate(0.1074, 50.0).unwrap();
/// assert!((gyro.white_density - 0.015189).abs() < 1e-6); // deg/sqrt(s)
/// let same = |other: LoopNoise| (other.white_density / gyro.white_density - 1.0).abs() < 1e-14;
/// let density = 0.1074 / 50_f64.sqrt();
/// assert!(same(LoopNoise::from_density_two_sided(density).unwrap()));
/// assert!(same(LoopNoise::from_density_one_sided(2_f64.sqrt() * density).unwrap()));
/// assert!(same(LoopNoise::from_arw_deg_sqrt_h(60.0 * density).unwrap()));
/// // Slow parts are added to it.
/// let drifting = gyro.with_gauss_markov(0.01, 20.0).unwrap().with_rate_random_walk(1e-3).unwrap();
/// assert_eq!((drifting.bias_time_s, drifting.rate_random_walk), (20.0, 1e-3));
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

    /// Adds a Gauss-Markov bias: standard deviation `sigma` (unit/s), time constant `time_s`.
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

    /// Adds a random walk of rate, `k` in unit/s/sqrt(s).
    ///
    /// # Errors
    /// A negative or non-finite figure.
    pub fn with_rate_random_walk(self, k: f64) -> Result<Self, DriftError> {
        Ok(Self { rate_random_walk: not_negative("rate_random_walk", k, "")?, ..self })
    }
}

/// Variance of the angle, by cause.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::{LoopNoise, TransferFunction, drift};
/// let noise = LoopNoise::from_density_two_sided(0.015).unwrap().with_rate_random_walk(1e-3).unwrap();
/// let integrator = TransferFunction::new(&[1.0], &[1.0, 0.0]).unwrap();
/// let after = |t| drift(&integrator, &noise, Some(t)).unwrap();
/// // White noise grows with the time, a walk of the rate with its cube; independent causes add up.
/// let (minute, ten) = (after(60.0), after(600.0));
/// assert!((ten.white / minute.white - 10.0).abs() < 1e-9);
/// assert!((ten.rate_random_walk / minute.rate_random_walk - 1000.0).abs() < 1e-6);
/// assert_eq!(ten.total(), ten.white + ten.rate_random_walk);
/// ```
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

/// Variance of the angle from the part of the noise that lies in the band `low..high` rad/s, by quadrature: the way for a loop with dead
/// time, which no transfer function describes.
///
/// # Errors
/// Bad polynomials, or a band that is not `0 < low < high`, both finite.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::{DriftLoop, LoopNoise, TransferFunction, drift_in_band};
/// let rate_loop = TransferFunction::new(&[20.0], &[1.0, 20.0]).unwrap();
/// let servo = DriftLoop::rate_only(rate_loop).tracked(&[2.0], &[1.0]).unwrap();
/// let noise = LoopNoise::from_density_two_sided(1.0).unwrap();
/// let whole = drift_in_band(&servo, &noise, (1e-6, 1e6)).unwrap().total();
/// assert!((whole - 0.25).abs() < 1e-5); // 1/(2 k), as over all frequencies
/// let late = drift_in_band(&servo.delayed(0.3).unwrap(), &noise, (1e-6, 1e6)).unwrap().total();
/// assert!(late > 1.2 * whole);
/// ```
pub fn drift_in_band(servo: &DriftLoop, noise: &LoopNoise, (low, high): (f64, f64)) -> Result<Drift, DriftError> {
    let gain = servo.power_gain()?;
    let band = |density: &dyn Fn(f64) -> f64| band_variance(|w| gain(w) * density(w), low, high, BAND_ACCURACY);
    let (n, k, t) = (noise.white_density, noise.rate_random_walk, noise.bias_time_s);
    let s2 = noise.bias_sigma * noise.bias_sigma;
    Ok(Drift {
        white: if n == 0.0 { 0.0 } else { n * n * band(&|_| 1.0)? },
        gauss_markov: if s2 == 0.0 { 0.0 } else { band(&|w| 2.0 * s2 * t / (1.0 + w * w * t * t))? },
        rate_random_walk: if k == 0.0 { 0.0 } else { k * k * band(&|w| 1.0 / (w * w))? },
    })
}

fn white_after(system: &StateSpace, time_s: f64) -> f64 {
    let (_, p) = propagate(&system.a, &system.input_noise(), time_s * system.time_scale);
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
