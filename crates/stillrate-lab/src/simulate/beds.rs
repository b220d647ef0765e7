//! The beds on which filters are scored: rest, waves that calm down, rough waves, steps with slews, and a chirp.
//!
//! Waves: g(t) (E0 cos w0 t - E1 sin w0 t), w0 = 2 pi 2 rad/s, E0 and E1 independent, unit variance, three-fold pole at
//! .5 rad/s; g(t) = 30 (.62 + .38 sin(2 pi t / 23)) min(1, t/3) deg/s up to t1 = 124.2 s, then
//! (g(t1) - .15) exp(-(t - t1)/1.5) + .15: the calm. Rough waves: g(t) times a resonator with gamma = .25 rad/s.
//! Steps: levels through two equal first-order lags exp(-2 pi 15 / fs), plus slews. Chirp: logarithmic, .1 to 10 Hz
//! over the run, 20 deg/s. The gyro is [`GyroNoiseModel::bench`] unless given.

use core::f64::consts::TAU;
use core::ops::Range;

use stillrate::Real;
use stillrate::error::{ConfigError, between, positive};

use super::gyro_noise::GyroNoiseModel;
use super::motion::{carrier, resonator, sample_path, smooth_process};
use crate::random::Random;

/// Which motion.
///
/// # Example
/// ```
/// use stillrate_lab::simulate::{BedKind, BedSettings};
/// let steps = BedSettings::new(BedKind::Steps, 100.0, 0).simulate().unwrap();
/// assert!(steps.motion_dps[999] == 0.0 && (steps.motion_dps[1500] - 5.0).abs() < 1e-9); // 5 deg/s from 10 s on
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BedKind {
    /// At rest, 60 s.
    Static,
    /// Smooth waves near 2 Hz, then calm, 180 s.
    Waves,
    /// Rough waves near 2 Hz (a resonator driven by white noise), then calm, 180 s.
    RoughWaves,
    /// Steps and slews, 120 s.
    Steps,
    /// Logarithmic chirp, 60 s.
    Chirp,
}

/// Frequency of the waves, Hz.
pub(crate) const WAVE_FREQUENCY_HZ: f64 = 2.0;
/// Three-fold pole of the wave amplitudes, rad/s.
pub(crate) const WAVE_POLE_RAD_S: f64 = 0.5;
/// Damping gamma of the rough waves, rad/s.
pub(crate) const ROUGH_DAMPING_RAD_S: f64 = 0.25;
/// Where the score of a wave run begins, s (sample 200 at 50 Hz).
const SCORE_FROM_S: f64 = 4.0;
/// Wait after the waves end before the calm is scored, s.
const CALM_AFTER_S: f64 = 5.0;
/// Amplitude left in the calm, deg/s, and the time over which the waves die down to it, s.
const CALM: (f64, f64) = (0.15, 1.5);
/// Corner of the two lags of the steps, Hz.
const STEP_LAG_HZ: f64 = 15.0;
/// Level (deg/s) from a time (s) on.
const LEVELS: [(f64, f64); 8] =
    [(10.0, 5.0), (16.0, -10.0), (22.0, 30.0), (28.0, 0.0), (40.0, 1.0), (46.0, 0.0), (52.0, 0.3), (58.0, 0.0)];
/// Slew from, to (s), at deg/s^2.
const SLEWS: [(f64, f64, f64); 4] = [(70.0, 73.0, 20.0), (78.0, 81.0, -20.0), (85.0, 95.0, 2.0), (100.0, 110.0, -2.0)];
/// Chirp: first and last frequency, Hz, and amplitude, deg/s.
const CHIRP: (f64, f64, f64) = (0.1, 10.0, 20.0);

/// Streams of the seed used by the motion (the gyro uses 0 to 3).
mod stream {
    pub(super) const IN_PHASE: u64 = 16;
    pub(super) const QUADRATURE: u64 = 17;
    pub(super) const ROUGH: u64 = 18;
}

/// What to simulate. Start from [`BedSettings::new`] and change what differs.
///
/// # Example
/// ```
/// use stillrate_lab::simulate::{BedKind, BedSettings};
/// let bed = BedSettings { duration_s: 30.0, waves_end_s: 20.0, ..BedSettings::new(BedKind::Waves, 200.0, 1) }
///     .simulate()
///     .unwrap();
/// assert_eq!(bed.measured_dps.len(), 6000);
/// assert!(bed.settings.has_waves());
/// // Scored from 4 s until the waves end; the calm begins 5 s later.
/// assert_eq!(bed.scored, bed.settings.sample_at(4.0)..bed.settings.sample_at(20.0));
/// assert_eq!(bed.calm, Some(5000..6000));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BedSettings {
    /// The motion.
    pub kind: BedKind,
    /// Sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Seed of the motion and of the gyro.
    pub seed: u64,
    /// Length of the run, s.
    pub duration_s: f64,
    /// When the waves begin to die down, s (waves and rough waves only).
    pub waves_end_s: f64,
    /// The gyro.
    pub noise: GyroNoiseModel,
}

/// A simulated run.
#[derive(Clone, Debug, PartialEq)]
pub struct Bed {
    /// What was asked for.
    pub settings: BedSettings,
    /// Time of each sample, s: k / sample rate.
    pub t_s: Vec<f64>,
    /// Motion without drift, deg/s.
    pub motion_dps: Vec<f64>,
    /// Slow drift of the gyro (Gauss-Markov bias + rate random walk), deg/s.
    pub drift_dps: Vec<f64>,
    /// Motion + drift: errors are counted against this, deg/s.
    pub truth_dps: Vec<f64>,
    /// What the gyro reads, deg/s; NaN where a sample is missing.
    pub measured_dps: Vec<f64>,
    /// Samples over which the motion is scored: all at rest, in steps and in chirps; waves from 4 s to their end.
    pub scored: Range<usize>,
    /// Samples of the calm, from 5 s after the waves end (wave beds only).
    pub calm: Option<Range<usize>>,
}

impl BedSettings {
    /// A bed with its usual length and gyro.
    #[must_use]
    pub fn new(kind: BedKind, sample_rate_hz: f64, seed: u64) -> Self {
        let duration_s = match kind {
            BedKind::Static | BedKind::Chirp => 60.0,
            BedKind::Waves | BedKind::RoughWaves => 180.0,
            BedKind::Steps => 120.0,
        };
        Self { kind, sample_rate_hz, seed, duration_s, waves_end_s: 124.2, noise: GyroNoiseModel::bench() }
    }

    /// Whether the motion is one of the two wave kinds.
    #[must_use]
    pub fn has_waves(&self) -> bool {
        matches!(self.kind, BedKind::Waves | BedKind::RoughWaves)
    }

    /// Amplitude profile g(t) of the waves, deg/s.
    ///
    /// # Example
    /// ```
    /// use stillrate_lab::simulate::{BedKind, BedSettings};
    /// let g = BedSettings::new(BedKind::Waves, 50.0, 0);
    /// assert_eq!(g.wave_amplitude_dps(0.0), 0.0);
    /// assert!((g.wave_amplitude_dps(180.0) - 0.15).abs() < 1e-9);
    /// ```
    #[must_use]
    pub fn wave_amplitude_dps(&self, t_s: f64) -> f64 {
        let swell = |t: f64| 30.0 * (0.62 + 0.38 * (TAU * t / 23.0).sine_cosine().0) * (t / 3.0).min(1.0);
        let t1 = self.waves_end_s;
        if t_s <= t1 {
            return swell(t_s);
        }
        (swell(t1) - CALM.0) * (-(t_s - t1) / CALM.1).exponential() + CALM.0
    }

    /// Runs the simulation.
    ///
    /// # Errors
    /// [`ConfigError`] for a setting out of range.
    pub fn simulate(&self) -> Result<Bed, ConfigError> {
        let rate = positive("sample_rate_hz", self.sample_rate_hz, "Hz")?;
        between("duration_s", self.duration_s, 0.0, 1e9 / rate, "s", "above 0 and at most 1e9 samples long, in")?;
        positive("waves_end_s", self.waves_end_s, "s")?;
        let count = self.sample_at(self.duration_s);
        let t_s: Vec<f64> = (0..count).map(|k| k as f64 / rate).collect();
        let motion_dps = self.motion(&t_s);
        let record = self.noise.record(&motion_dps, rate, self.seed)?;
        let (scored, calm) = self.ranges(count);
        Ok(Bed {
            settings: *self,
            t_s,
            motion_dps,
            drift_dps: record.drift_dps,
            truth_dps: record.truth_dps,
            measured_dps: record.measured_dps,
            scored,
            calm,
        })
    }

    /// Number of the sample at a time.
    #[must_use]
    pub fn sample_at(&self, t_s: f64) -> usize {
        (t_s.max(0.0) * self.sample_rate_hz).round() as usize
    }

    fn ranges(&self, count: usize) -> (Range<usize>, Option<Range<usize>>) {
        if !self.has_waves() {
            return (0..count, None);
        }
        let end = self.sample_at(self.waves_end_s).min(count);
        let calm = self.sample_at(self.waves_end_s + CALM_AFTER_S);
        (self.sample_at(SCORE_FROM_S).min(end)..end, (calm < count).then_some(calm..count))
    }

    fn motion(&self, t_s: &[f64]) -> Vec<f64> {
        match self.kind {
            BedKind::Static => vec![0.0; t_s.len()],
            BedKind::Waves => self.waves(t_s),
            BedKind::RoughWaves => self.rough_waves(t_s),
            BedKind::Steps => self.steps(t_s),
            BedKind::Chirp => self.chirp(t_s),
        }
    }

    fn waves(&self, t_s: &[f64]) -> Vec<f64> {
        let amplitude =
            |stream| smooth_process(WAVE_POLE_RAD_S, t_s, self.duration_s, &mut Random::new(self.seed, stream));
        let (in_phase, quadrature) = (amplitude(stream::IN_PHASE), amplitude(stream::QUADRATURE));
        let wave = |(t, (e0, e1)): (&f64, (&f64, &f64))| {
            let (sine, cosine) = carrier(WAVE_FREQUENCY_HZ, *t);
            self.wave_amplitude_dps(*t) * (e0 * cosine - e1 * sine)
        };
        t_s.iter().zip(in_phase.iter().zip(&quadrature)).map(wave).collect()
    }

    fn rough_waves(&self, t_s: &[f64]) -> Vec<f64> {
        let step = resonator(TAU * WAVE_FREQUENCY_HZ, ROUGH_DAMPING_RAD_S, 1.0 / self.sample_rate_hz);
        let wave = sample_path(&step, 0, t_s.len(), &mut Random::new(self.seed, stream::ROUGH));
        t_s.iter().zip(&wave).map(|(t, w)| self.wave_amplitude_dps(*t) * w).collect()
    }

    fn steps(&self, t_s: &[f64]) -> Vec<f64> {
        let keep = (-TAU * STEP_LAG_HZ / self.sample_rate_hz).exponential();
        let (mut first, mut second) = (0.0, 0.0);
        t_s.iter()
            .map(|&t| {
                let level = LEVELS.iter().rev().find(|(from, _)| t >= *from).map_or(0.0, |(_, level)| *level);
                first = level + keep * (first - level);
                second = first + keep * (second - first);
                let slewed: f64 = SLEWS.iter().map(|(from, to, a)| a * (t.clamp(*from, *to) - from)).sum();
                second + slewed
            })
            .collect()
    }

    fn chirp(&self, t_s: &[f64]) -> Vec<f64> {
        let (low, high, amplitude) = CHIRP;
        // f(t) = low e^(rate t); turns = low (e^(rate t) - 1) / rate.
        let rate = (high / low).logarithm() / self.duration_s;
        t_s.iter().map(|t| amplitude * carrier(low / rate, (rate * t).exponential_less_one()).0).collect()
    }
}

impl Bed {
    /// Samples from `wait_s` after the waves end to the end of the run (empty where there are none).
    ///
    /// # Example
    /// ```
    /// use stillrate_lab::simulate::{BedKind, BedSettings};
    /// let bed = BedSettings::new(BedKind::Waves, 50.0, 0).simulate().unwrap();
    /// assert_eq!(bed.calm_after(12.0), 6810..9000);
    /// ```
    #[must_use]
    pub fn calm_after(&self, wait_s: f64) -> Range<usize> {
        let count = self.measured_dps.len();
        self.settings.sample_at(self.settings.waves_end_s + wait_s).min(count)..count
    }
}
