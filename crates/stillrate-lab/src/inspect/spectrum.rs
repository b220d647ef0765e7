//! One-sided power spectral density by Welch's method (IEEE Trans. Audio Electroacoust. 15(2), 1967): Hann window, half
//! overlap, mean removed from each segment, periodograms averaged.
//!
//! A segment with a missing sample is left out. The transform is realfft's; a spectrum is for looking at, so it may differ
//! in the last bits between machines, as nothing else here may.

use realfft::RealFftPlanner;
use stillrate::Real;

/// A power spectral density.
///
/// # Example
/// ```
/// use stillrate_lab::{inspect::spectrum::{Spectrum, welch}, random::Random};
/// let white: Vec<f64> = Random::new(1, 0).normals(20_000).iter().map(|x| 0.2 * x).collect();
/// let Spectrum { frequency_hz, density, segments } = welch(&white, 100.0, 1000);
/// assert_eq!((frequency_hz.len(), frequency_hz[499], segments), (500, 50.0, 39));
/// // Variance .04 over 0..50 Hz: the whole of it stands below the curve.
/// assert!((density.iter().sum::<f64>() * 0.1 / 0.04 - 1.0).abs() < 0.05);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Frequencies in Hz, from the first above zero.
    pub frequency_hz: Vec<f64>,
    /// Density in unit^2/Hz, one-sided.
    pub density: Vec<f64>,
    /// Number of segments averaged.
    pub segments: usize,
}

/// Estimates the one-sided spectral density of samples at a regular rate, in segments of `segment` samples (shortened to
/// the record, made even).
///
/// # Example
/// ```
/// use stillrate_lab::inspect::spectrum::welch;
/// let sine: Vec<f64> = (0..4000).map(|k| (0.2 * std::f64::consts::PI * f64::from(k)).sin()).collect();
/// let found = welch(&sine, 100.0, 1000); // 10 Hz
/// let peak = (0..500).max_by(|a, b| found.density[*a].total_cmp(&found.density[*b])).unwrap();
/// assert!((found.frequency_hz[peak] - 10.0).abs() < 0.05);
/// ```
#[must_use]
pub fn welch(samples: &[f64], sample_rate_hz: f64, segment: usize) -> Spectrum {
    let length = segment.min(samples.len()) & !1;
    let mut found = Spectrum { frequency_hz: Vec::new(), density: Vec::new(), segments: 0 };
    if length < 8 {
        return found;
    }
    let turn = 2.0 * core::f64::consts::PI / length as f64;
    let window: Vec<f64> = (0..length).map(|k| 0.5 - 0.5 * (turn * k as f64).sine_cosine().1).collect();
    let power: f64 = window.iter().map(|w| w * w).sum();
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length);
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    let mut sum = vec![0.0; length / 2];
    for start in (0..=samples.len() - length).step_by(length / 2) {
        let part = &samples[start..start + length];
        if part.iter().any(|x| !x.is_finite()) {
            continue;
        }
        let mean = part.iter().sum::<f64>() / length as f64;
        for ((slot, x), w) in input.iter_mut().zip(part).zip(&window) {
            *slot = (x - mean) * w;
        }
        if transform.process(&mut input, &mut output).is_err() {
            continue;
        }
        for (total, bin) in sum.iter_mut().zip(&output[1..]) {
            *total += bin.norm_sqr();
        }
        found.segments += 1;
    }
    let scale = 2.0 / (sample_rate_hz * power * found.segments.max(1) as f64);
    let last = sum.len() - 1;
    found.density = sum.iter().map(|total| total * scale).collect();
    // The bin at half the sample rate has no mirror image.
    found.density[last] *= 0.5;
    found.frequency_hz = (1..=length / 2).map(|k| k as f64 * sample_rate_hz / length as f64).collect();
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn white_noise_has_its_variance_spread_evenly_up_to_half_the_rate() {
        let mut random = Random::new(7, 0);
        let samples: Vec<f64> = (0..200_000).map(|_| 0.3 * random.normal() + 4.0).collect();
        let found = welch(&samples, 100.0, 1024);
        let total: f64 = found.density.iter().sum::<f64>() * 100.0 / 1024.0;
        assert!((total / 0.09 - 1.0).abs() < 0.02, "{total}");
        let low: f64 = found.density[10..100].iter().sum::<f64>() / 90.0;
        assert!((low / (0.09 / 50.0) - 1.0).abs() < 0.05, "{low}");
    }

    #[test]
    fn a_sine_stands_at_its_frequency() {
        let samples: Vec<f64> = (0..8192).map(|k| (f64::from(k) * 0.05 * core::f64::consts::TAU).sin()).collect();
        let found = welch(&samples, 200.0, 2048);
        let peak = (0..found.density.len()).max_by(|a, b| found.density[*a].total_cmp(&found.density[*b])).unwrap();
        assert!((found.frequency_hz[peak] - 10.0).abs() < 0.1);
    }

    #[test]
    fn too_short_a_record_has_no_spectrum_and_gaps_are_left_out() {
        assert!(welch(&[1.0; 4], 10.0, 256).density.is_empty());
        let mut samples = vec![0.5; 1000];
        samples[500] = f64::NAN;
        assert!(welch(&samples, 10.0, 100).density.iter().all(|density| density.is_finite()));
    }
}
