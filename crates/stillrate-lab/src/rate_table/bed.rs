//! The simulated turntable: units with white noise, a slow drift and a smooth error curve, and the motions they are tested on.
//!
//! The nominal unit has the figures read off the published table 3: white noise 0.162 deg/s a sample at 2 kHz, error
//! 0.030 + 0.002 w + 1e-4 w^2 - 1.5e-4 w^3, drift 0.016 deg/s (Gauss-Markov, 2 s).

use core::f64::consts::TAU;

use stillrate::Real;

use crate::random::Random;

/// Sample rate of the published records, Hz.
pub const SAMPLE_RATE_HZ: f64 = 2000.0;
/// The six published table rates, deg/s.
pub const PUBLISHED_RATES: [f64; 6] = [-6.0, -3.0, -1.5, 1.5, 3.0, 6.0];
/// Samples of the six published records. The text does not give them; the floors of its table 3 imply 6400 to 12200.
pub const PUBLISHED_SAMPLES: [usize; 6] = [6400, 8000, 9200, 10_400, 11_400, 12_200];

/// A simulated gyro.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Standard deviation of the white noise, deg/s.
    pub white_dps: f64,
    /// Coefficients of 1, w, w^2, w^3 of the error, deg/s.
    pub error: [f64; 4],
    /// Standard deviation of the drift, deg/s.
    pub drift_dps: f64,
    /// Time constant of the drift, s.
    pub drift_s: f64,
}

impl Unit {
    /// The nominal unit.
    pub const NOMINAL: Self =
        Self { white_dps: 0.162, error: [0.030, 0.002, 1e-4, -1.5e-4], drift_dps: 0.016, drift_s: 2.0 };

    /// A unit of the same kind: each error coefficient is the nominal one times a normal deviate around 1 (sigma 0.5), the offset's sign drawn.
    #[must_use]
    pub fn drawn(seed: u64) -> Self {
        let mut random = Random::new(seed, 0);
        let sign = if random.normal() < 0.0 { -1.0 } else { 1.0 };
        let mut unit = Self::NOMINAL;
        unit.error.iter_mut().for_each(|c| *c *= 1.0 + 0.5 * random.normal());
        unit.error[0] *= sign;
        unit
    }

    /// The error at a true rate.
    #[must_use]
    pub fn error_at(&self, w: f64) -> f64 {
        let [a, b, c, d] = self.error;
        a + w * (b + w * (c + w * d))
    }

    /// What the unit measures of a true rate.
    #[must_use]
    pub fn measure(&self, truth: &[f64], sample_rate_hz: f64, random: &mut Random) -> Vec<f64> {
        let keep = (-1.0 / (self.drift_s * sample_rate_hz)).exponential();
        let fresh = self.drift_dps * (1.0 - keep * keep).root();
        let mut drift = self.drift_dps * random.normal();
        truth
            .iter()
            .map(|w| {
                drift = keep * drift + fresh * random.normal();
                w + self.error_at(*w) + drift + self.white_dps * random.normal()
            })
            .collect()
    }
}

/// The true rate over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A constant rate.
    Constant(f64),
    /// A first rate and a slope, deg/s^2.
    Ramp(f64, f64),
    /// Amplitude and frequency, Hz.
    Sine(f64, f64),
    /// Amplitude and frequency, Hz: between +a and -a at once.
    Square(f64, f64),
    /// Amplitude and frequency, Hz: from -a to +a and back at once.
    Sawtooth(f64, f64),
}

/// A motion of the bed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// What it is called in tables.
    pub name: &'static str,
    /// The true rate.
    pub shape: Shape,
    /// Duration, s.
    pub seconds: f64,
}

impl Motion {
    /// The true rate at each sample.
    #[must_use]
    pub fn rates(&self, sample_rate_hz: f64) -> Vec<f64> {
        let count = (self.seconds * sample_rate_hz) as usize;
        let phase = |t: f64, hz: f64| (t * hz).rem_euclid(1.0);
        (0..count)
            .map(|k| k as f64 / sample_rate_hz)
            .map(|t| match self.shape {
                Shape::Constant(w) => w,
                Shape::Ramp(w, slope) => w + slope * t,
                Shape::Sine(a, hz) => a * (TAU * phase(t, hz)).sine_cosine().0,
                Shape::Square(a, hz) => {
                    if phase(t, hz) < 0.5 {
                        a
                    } else {
                        -a
                    }
                }
                Shape::Sawtooth(a, hz) => a * (2.0 * phase(t, hz) - 1.0),
            })
            .collect()
    }
}

const fn motion(name: &'static str, shape: Shape, seconds: f64) -> Motion {
    Motion { name, shape, seconds }
}

/// The twelve motions in range on which everything is scored.
pub const TEST_MOTIONS: [Motion; 12] = [
    motion("constant 0", Shape::Constant(0.0), 6.0),
    motion("constant 2", Shape::Constant(2.0), 6.0),
    motion("constant -2", Shape::Constant(-2.0), 6.0),
    motion("constant 4.5", Shape::Constant(4.5), 6.0),
    motion("constant -4.5", Shape::Constant(-4.5), 6.0),
    motion("ramp -6..6 in 10 s", Shape::Ramp(-6.0, 1.2), 10.0),
    motion("ramp 1/12 deg/s^2", Shape::Ramp(-0.5, 1.0 / 12.0), 12.0),
    motion("sine 4, 0.1 Hz", Shape::Sine(4.0, 0.1), 20.0),
    motion("sine 4, 0.5 Hz", Shape::Sine(4.0, 0.5), 10.0),
    motion("sine 4, 1 Hz", Shape::Sine(4.0, 1.0), 10.0),
    motion("sine 4, 2 Hz", Shape::Sine(4.0, 2.0), 10.0),
    motion("sine 0.5, 1 Hz", Shape::Sine(0.5, 1.0), 10.0),
];

/// Motions in range that jump, on which a filter with one motion model fails.
pub const JUMP_MOTIONS: [Motion; 2] = [
    motion("square 4, 0.25 Hz", Shape::Square(4.0, 0.25), 12.0),
    motion("sawtooth 5.5, 0.5 Hz", Shape::Sawtooth(5.5, 0.5), 12.0),
];

/// A motion beyond the calibrated range.
pub const OUTSIDE_MOTION: Motion = motion("sine 9, 0.5 Hz (outside)", Shape::Sine(9.0, 0.5), 10.0);

/// Motions on which noise is tuned: of the same kinds, none of them a test motion.
pub const TUNING_MOTIONS: [Motion; 6] = [
    motion("constant 1", Shape::Constant(1.0), 6.0),
    motion("constant -3.5", Shape::Constant(-3.5), 6.0),
    motion("ramp 5..-5 in 8 s", Shape::Ramp(5.0, -1.25), 8.0),
    motion("sine 3, 0.2 Hz", Shape::Sine(3.0, 0.2), 10.0),
    motion("sine 3.5, 0.8 Hz", Shape::Sine(3.5, 0.8), 10.0),
    motion("sine 3, 1.7 Hz", Shape::Sine(3.0, 1.7), 10.0),
];

/// A calibration run: `rates` evenly spaced rates in -6..=6, `seconds` each. Gives the true and the measured rate.
#[must_use]
pub fn calibration(unit: &Unit, rates: usize, seconds: f64, random: &mut Random) -> (Vec<f64>, Vec<f64>) {
    let count = (seconds * SAMPLE_RATE_HZ) as usize;
    let step = 12.0 / (rates.max(2) - 1) as f64;
    let truth: Vec<f64> = (0..rates).flat_map(|k| vec![-6.0 + step * k as f64; count]).collect();
    let measured = unit.measure(&truth, SAMPLE_RATE_HZ, random);
    (truth, measured)
}
