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
const PUBLISHED_RATES: [f64; 6] = [-6.0, -3.0, -1.5, 1.5, 3.0, 6.0];
/// Samples of the six published records. The text does not give them; the floors of its table 3 imply 6400 to 12200.
const PUBLISHED_SAMPLES: [usize; 6] = [6400, 8000, 9200, 10_400, 11_400, 12_200];

/// A true and a measured record, deg/s.
pub type Pair = (Vec<f64>, Vec<f64>);

/// A simulated gyro.
///
/// # Example
/// ```
/// use stillrate_lab::random::Random;
/// use stillrate_lab::rate_table::bed::{SAMPLE_RATE_HZ, Unit};
/// let quiet = Unit { white_dps: 0.0, drift_dps: 0.0, ..Unit::NOMINAL };
/// let measured = quiet.measure(&[2.0], SAMPLE_RATE_HZ, &mut Random::new(1, 0))[0];
/// assert!((measured - 2.0332).abs() < 1e-12); // 0.030 + 0.002 w + 1e-4 w^2 - 1.5e-4 w^3
/// let (truth, measured) = quiet.calibration(13, 0.5, &mut Random::new(1, 0));
/// assert_eq!((truth.len(), truth[0], truth[12_999]), (13_000, -6.0, 6.0));
/// assert_eq!(measured[0], measured[999]); // the table stands at each rate
/// assert_eq!(quiet.published_records(1).len(), 6);
/// assert_ne!(Unit::drawn(1).error, Unit::drawn(2).error);
/// ```
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

    /// The error at a true rate, deg/s.
    fn error_at(&self, w: f64) -> f64 {
        let [a, b, c, d] = self.error;
        a + w * (b + w * (c + w * d))
    }

    /// What the unit measures of a true rate, deg/s.
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

    /// A calibration run at [`SAMPLE_RATE_HZ`]: `rates` evenly spaced rates in -6..=6 deg/s, `seconds` each.
    #[must_use]
    pub fn calibration(&self, rates: usize, seconds: f64, random: &mut Random) -> Pair {
        let count = (seconds * SAMPLE_RATE_HZ) as usize;
        let step = 12.0 / (rates.max(2) - 1) as f64;
        let truth: Vec<f64> = (0..rates).flat_map(|k| vec![-6.0 + step * k as f64; count]).collect();
        let measured = self.measure(&truth, SAMPLE_RATE_HZ, random);
        (truth, measured)
    }

    /// Six constant-rate records like the published ones.
    #[must_use]
    pub fn published_records(&self, seed: u64) -> Vec<Pair> {
        PUBLISHED_RATES
            .iter()
            .zip(PUBLISHED_SAMPLES)
            .enumerate()
            .map(|(k, (&rate, samples))| {
                let truth = vec![rate; samples];
                let measured = self.measure(&truth, SAMPLE_RATE_HZ, &mut Random::new(seed, 100 + k as u64));
                (truth, measured)
            })
            .collect()
    }
}

/// The true rate over time, deg/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Profile {
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
pub(crate) struct Motion {
    /// What it is called in tables.
    pub(crate) name: &'static str,
    /// The true rate.
    pub(crate) profile: Profile,
    /// Duration, s.
    pub(crate) seconds: f64,
}

impl Motion {
    /// The true rate at each sample, deg/s.
    pub(crate) fn rates(&self, sample_rate_hz: f64) -> Vec<f64> {
        let count = (self.seconds * sample_rate_hz) as usize;
        let phase = |t: f64, hz: f64| (t * hz).rem_euclid(1.0);
        (0..count)
            .map(|k| k as f64 / sample_rate_hz)
            .map(|t| match self.profile {
                Profile::Constant(w) => w,
                Profile::Ramp(w, slope) => w + slope * t,
                Profile::Sine(a, hz) => a * (TAU * phase(t, hz)).sine_cosine().0,
                Profile::Square(a, hz) => {
                    if phase(t, hz) < 0.5 {
                        a
                    } else {
                        -a
                    }
                }
                Profile::Sawtooth(a, hz) => a * (2.0 * phase(t, hz) - 1.0),
            })
            .collect()
    }
}

const fn motion(name: &'static str, profile: Profile, seconds: f64) -> Motion {
    Motion { name, profile, seconds }
}

/// The twelve motions in range on which everything is scored.
pub(crate) const TEST_MOTIONS: [Motion; 12] = [
    motion("constant 0", Profile::Constant(0.0), 6.0),
    motion("constant 2", Profile::Constant(2.0), 6.0),
    motion("constant -2", Profile::Constant(-2.0), 6.0),
    motion("constant 4.5", Profile::Constant(4.5), 6.0),
    motion("constant -4.5", Profile::Constant(-4.5), 6.0),
    motion("ramp -6..6 in 10 s", Profile::Ramp(-6.0, 1.2), 10.0),
    motion("ramp 1/12 deg/s^2", Profile::Ramp(-0.5, 1.0 / 12.0), 12.0),
    motion("sine 4, 0.1 Hz", Profile::Sine(4.0, 0.1), 20.0),
    motion("sine 4, 0.5 Hz", Profile::Sine(4.0, 0.5), 10.0),
    motion("sine 4, 1 Hz", Profile::Sine(4.0, 1.0), 10.0),
    motion("sine 4, 2 Hz", Profile::Sine(4.0, 2.0), 10.0),
    motion("sine 0.5, 1 Hz", Profile::Sine(0.5, 1.0), 10.0),
];

/// Motions in range that jump, on which a filter with one motion model fails.
pub(crate) const JUMP_MOTIONS: [Motion; 2] = [
    motion("square 4, 0.25 Hz", Profile::Square(4.0, 0.25), 12.0),
    motion("sawtooth 5.5, 0.5 Hz", Profile::Sawtooth(5.5, 0.5), 12.0),
];

/// A motion beyond the calibrated range.
pub(crate) const OUTSIDE_MOTION: Motion = motion("sine 9, 0.5 Hz (outside)", Profile::Sine(9.0, 0.5), 10.0);

/// Motions on which noise is tuned: of the same kinds, none of them a test motion.
pub(crate) const TUNING_MOTIONS: [Motion; 6] = [
    motion("constant 1", Profile::Constant(1.0), 6.0),
    motion("constant -3.5", Profile::Constant(-3.5), 6.0),
    motion("ramp 5..-5 in 8 s", Profile::Ramp(5.0, -1.25), 8.0),
    motion("sine 3, 0.2 Hz", Profile::Sine(3.0, 0.2), 10.0),
    motion("sine 3.5, 0.8 Hz", Profile::Sine(3.5, 0.8), 10.0),
    motion("sine 3, 1.7 Hz", Profile::Sine(3.0, 1.7), 10.0),
];

/// Names of the motions in range and of those that jump, in the order of [`Row`](crate::rate_table::study::Row).
///
/// # Example
/// ```
/// let (in_range, jumps) = stillrate_lab::rate_table::bed::motion_names();
/// assert_eq!((in_range.len(), jumps.len()), (12, 2));
/// assert_eq!(in_range[7], "sine 4, 0.1 Hz"); // amplitude in deg/s
/// ```
#[must_use]
pub fn motion_names() -> (Vec<&'static str>, Vec<&'static str>) {
    let names = |motions: &[Motion]| motions.iter().map(|motion| motion.name).collect();
    (names(&TEST_MOTIONS), names(&JUMP_MOTIONS))
}
