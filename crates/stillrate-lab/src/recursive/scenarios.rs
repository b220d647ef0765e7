//! Motion for the bench of the adaptive filters: rest, steps, ramps, sines, and quiet stretches between bursts of a hand.
//!
//! 200 Hz, white noise of sigma 0.05 deg/s, 24 000 samples. Random streams are one a purpose, so that a change of one scenario leaves the
//! others alone.

use core::f64::consts::{PI, TAU};

use stillrate::Real;

use crate::random::{Generator, Random};

/// Sample rate of the bench, Hz.
pub const SAMPLE_RATE_HZ: f64 = 200.0;
/// Standard deviation of the white noise, deg/s.
pub const SIGMA_DPS: f64 = 0.05;
/// Samples of a run.
const SAMPLES: usize = 24_000;

/// A motion of the bench.
///
/// # Example
/// ```
/// use stillrate_lab::recursive::scenarios::{SCENARIOS, Scenario};
/// assert_eq!(SCENARIOS[0], ("quiet", Scenario::Quiet));
/// assert_eq!(SCENARIOS[5], ("1 Hz", Scenario::Sine(1.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scenario {
    /// Nothing moves.
    Quiet,
    /// Normal steps of 0.1 deg/s every 2 s.
    SmallSteps,
    /// A new level within plus or minus 1 deg/s every 2 s.
    LargeSteps,
    /// Triangle of plus or minus 5 deg/s, period 4 s.
    Ramps,
    /// Sine of 5 deg/s at a frequency in Hz.
    Sine(f64),
    /// Bursts of 5 deg/s RMS below 3 Hz in the first half of every 10 s.
    Mixed,
}

/// The scenarios of the table, in its order.
pub const SCENARIOS: [(&str, Scenario); 8] = [
    ("quiet", Scenario::Quiet),
    ("step 2s", Scenario::SmallSteps),
    ("step 20s", Scenario::LargeSteps),
    ("ramp", Scenario::Ramps),
    (".5 Hz", Scenario::Sine(0.5)),
    ("1 Hz", Scenario::Sine(1.0)),
    ("3 Hz", Scenario::Sine(3.0)),
    ("mixed", Scenario::Mixed),
];

/// True rate of a scenario, deg/s.
pub(super) fn truth(scenario: Scenario, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed, 1);
    let time = |k: usize| k as f64 / SAMPLE_RATE_HZ;
    let hold = (2.0 * SAMPLE_RATE_HZ) as usize;
    match scenario {
        Scenario::Quiet => vec![0.0; SAMPLES],
        Scenario::SmallSteps => {
            let mut level = 0.0;
            levels(hold, || {
                level += 0.1 * random.normal();
                level
            })
        }
        Scenario::LargeSteps => levels(hold, || 2.0 * random.uniform() - 1.0),
        Scenario::Ramps => (0..SAMPLES)
            .map(|k| {
                let phase = (time(k) / 4.0).fract();
                5.0 * if phase < 0.5 { 4.0 * phase - 1.0 } else { 3.0 - 4.0 * phase }
            })
            .collect(),
        Scenario::Sine(hz) => (0..SAMPLES).map(|k| 5.0 * (TAU * hz * time(k)).sine_cosine().0).collect(),
        Scenario::Mixed => mixed(&mut random),
    }
}

/// Measured rate, deg/s: the truth with white noise.
pub(super) fn measured(truth: &[f64], seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed, 2);
    truth.iter().map(|rate| rate + SIGMA_DPS * random.normal()).collect()
}

fn levels(hold: usize, mut next: impl FnMut() -> f64) -> Vec<f64> {
    let mut level = 0.0;
    (0..SAMPLES)
        .map(|k| {
            if k % hold == 0 {
                level = next();
            }
            level
        })
        .collect()
}

fn mixed(random: &mut Random) -> Vec<f64> {
    let mut motion: Vec<f64> = random.normals(SAMPLES);
    // Fourth-order Butterworth: two sections with the pole pairs at 22.5 and 67.5 degrees.
    for angle in [PI / 8.0, 3.0 * PI / 8.0] {
        section(&mut motion, 3.0 / SAMPLE_RATE_HZ, 0.5 / angle.sine_cosine().1);
    }
    let scale = 5.0 / (motion.iter().map(|x| x * x).sum::<f64>() / SAMPLES as f64).root();
    let period = (10.0 * SAMPLE_RATE_HZ) as usize;
    let gate: Vec<f64> = (0..SAMPLES).map(|k| if k % period < period / 2 { 1.0 } else { 0.0 }).collect();
    let window: Vec<f64> = (0..100).map(|k| 0.5 - 0.5 * (TAU * f64::from(k) / 99.0).sine_cosine().1).collect();
    let sum: f64 = window.iter().sum();
    (0..SAMPLES)
        .map(|k| {
            let smooth: f64 = window
                .iter()
                .enumerate()
                .map(|(j, w)| w * (k + 50).checked_sub(j).and_then(|i| gate.get(i)).copied().unwrap_or(0.0))
                .sum();
            scale * motion[k] * smooth / sum
        })
        .collect()
}

/// Second-order low-pass of a quality factor by the bilinear transform, in place.
fn section(x: &mut [f64], frequency: f64, quality: f64) {
    let (sine, cosine) = (PI * frequency).sine_cosine();
    let k = sine / cosine;
    let norm = 1.0 / (1.0 + k / quality + k * k);
    let (b, a1, a2) = (k * k * norm, 2.0 * (k * k - 1.0) * norm, (1.0 - k / quality + k * k) * norm);
    let (mut z1, mut z2) = (0.0, 0.0);
    for value in x {
        let y = b * *value + z1;
        z1 = 2.0 * b * *value - a1 * y + z2;
        z2 = b * *value - a2 * y;
        *value = y;
    }
}
