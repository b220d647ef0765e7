//! Steady-state responses of any linear filter, from the filter itself: delay, bandwidth, noise, step.

use stillrate::{Filter, Real, Sample};

/// Samples at zero before the step, so that start-up is over.
const SETTLE: usize = 6000;
/// Length of the recorded response.
const LENGTH: usize = 6000;

/// A filter's steady-state figures; delays and times in samples, frequencies as a fraction of the sample rate.
///
/// # Example
/// ```
/// let rows = stillrate_lab::recursive::matched::responses()?;
/// let [exponential, mean] = [0, 1].map(|row| rows[row].1);
/// assert!((mean.delay - 19.5).abs() < 1e-9 && (mean.noise_ratio - 40_f64.sqrt().recip()).abs() < 1e-9);
/// assert!((exponential.delay - 0.9512 / 0.0488).abs() < 1e-9); // lambda/(1 - lambda): at equal noise the same lag
/// assert_eq!((mean.half, mean.settled, mean.overshoot < 1e-9), (19, 39, true));
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Standard deviation of the output for white input of 1.
    pub noise_ratio: f64,
    /// Group delay at zero frequency.
    pub delay: f64,
    /// Phase delay at 1 Hz with 200 Hz sampling.
    pub phase_delay: f64,
    /// Frequency of -3 dB (the last crossing below 0.25); NaN if none.
    pub half_power: f64,
    /// Samples after a step until half of it.
    pub half: usize,
    /// Until nine tenths.
    pub nine_tenths: usize,
    /// Until it stays within 2 %.
    pub settled: usize,
    /// Overshoot as a fraction of the step.
    pub overshoot: f64,
}

/// Measures what `run` makes of a step.
pub(super) fn response(mut run: impl FnMut(f64) -> f64) -> Response {
    for _ in 0..SETTLE {
        run(0.0);
    }
    let step: Vec<f64> = (0..LENGTH).map(|_| run(1.0)).collect();
    let mut before = 0.0;
    let impulse: Vec<f64> = step.iter().map(|&y| (y - core::mem::replace(&mut before, y), ()).0).collect();
    let first = |level: f64| step.iter().position(|&y| y >= level).unwrap_or(LENGTH);
    let settled = step.iter().rposition(|&y| (y - 1.0).abs() > 0.02).map_or(0, |k| k + 1);
    let highest = step.iter().copied().fold(0.0, f64::max);
    let weighted: f64 = impulse.iter().enumerate().map(|(k, h)| k as f64 * h).sum();
    let (real, imaginary) = transfer(&impulse, 1.0 / 200.0);
    Response {
        noise_ratio: impulse.iter().map(|h| h * h).sum::<f64>().root(),
        delay: weighted / impulse.iter().sum::<f64>(),
        phase_delay: (-imaginary).angle_over(real) * 200.0 / core::f64::consts::TAU,
        half_power: half_power(&impulse),
        half: first(0.5),
        nine_tenths: first(0.9),
        settled,
        overshoot: (highest - 1.0).max(0.0),
    }
}

/// A closure that feeds one filter at its nominal rate.
pub(super) fn feed<F: Filter<f64>>(filter: F) -> impl FnMut(f64) -> f64 {
    let mut state = filter.start();
    move |value| filter.step(&mut state, Sample { value, dt: filter.period() }).rate
}

fn transfer(impulse: &[f64], frequency: f64) -> (f64, f64) {
    impulse.iter().enumerate().fold((0.0, 0.0), |(re, im), (k, h)| {
        let (sine, cosine) = (core::f64::consts::TAU * frequency * k as f64).sine_cosine();
        (re + h * cosine, im - h * sine)
    })
}

fn half_power(impulse: &[f64]) -> f64 {
    let power = |f: f64| {
        let (re, im) = transfer(impulse, f);
        re * re + im * im
    };
    // Low-pass: the first crossing on a grid, refined by bisection.
    let grid = 0.0005;
    let Some(above) = (1..500).map(|k| f64::from(k) * grid).find(|&f| power(f) < 0.5) else { return f64::NAN };
    let (mut low, mut high) = (above - grid, above);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if power(middle) < 0.5 { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}
