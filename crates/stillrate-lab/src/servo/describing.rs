//! Describing function of a filter: gain and phase of its first harmonic against amplitude, noise present.
//!
//! An adaptive filter has no transfer function; near rest it may pass 2 % of a slow motion and far from rest all of it. So a single
//! phase margin means nothing, and this table takes its place.

use core::f64::consts::TAU;

use stillrate::Real;

use super::loop_filter::LoopFilter;
use crate::random::Random;

/// Gain and phase at one amplitude.
///
/// # Example
/// ```
/// use stillrate_lab::servo::{describing::describe, loop_filter::Unfiltered};
/// let through = describe(&mut Unfiltered, 50.0, 3.0, 2.0, 0.107, 30, 1);
/// assert!((through.gain - 1.0).abs() < 1e-12 && through.phase_deg.abs() < 1e-9); // the input's own noise cancels
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic {
    /// Amplitude of the rate, deg/s.
    pub amplitude_dps: f64,
    /// Output amplitude over input amplitude.
    pub gain: f64,
    /// Phase, deg (negative: late).
    pub phase_deg: f64,
}

/// First harmonic of the filter's answer to `amplitude sin(2 pi f t)` plus white noise (deg/s, standard deviation of a sample), over `periods`
/// periods after 10 s of settling.
///
/// # Example
/// ```
/// use stillrate_lab::servo::{describing::describe, discrete::Discrete};
/// let mut pt1 = Discrete::pt1(50.0, 5.3).unwrap();
/// let loud = describe(&mut pt1, 50.0, 3.0, 60.0, 0.107, 300, 1);
/// assert!((loud.gain - 0.87).abs() < 0.01 && (loud.phase_deg + 20.0).abs() < 1.0);
/// ```
pub fn describe(
    filter: &mut dyn LoopFilter,
    sample_rate_hz: f64,
    frequency_hz: f64,
    amplitude_dps: f64,
    noise_sigma_dps: f64,
    periods: usize,
    seed: u64,
) -> Harmonic {
    let mut random = Random::new(seed, 2);
    let settle = (10.0 * sample_rate_hz) as usize;
    let ticks = settle + (periods as f64 * sample_rate_hz / frequency_hz) as usize;
    filter.reset();
    // Correlations of input and output with the reference; both, so that the input's own noise cancels to first order.
    let mut sums = [0.0; 4];
    for k in 0..ticks {
        let (sine, cosine) = (TAU * frequency_hz * k as f64 / sample_rate_hz).sine_cosine();
        let y = amplitude_dps * sine + noise_sigma_dps * random.normal();
        let w = filter.step(y);
        if k >= settle {
            sums[0] += y * sine;
            sums[1] += y * cosine;
            sums[2] += w * sine;
            sums[3] += w * cosine;
        }
    }
    let [a, b, c, d] = sums;
    let size = a * a + b * b;
    let (re, im) = ((c * a + d * b) / size, (d * a - c * b) / size);
    Harmonic { amplitude_dps, gain: (re * re + im * im).root(), phase_deg: im.angle_over(re) * 360.0 / TAU }
}
