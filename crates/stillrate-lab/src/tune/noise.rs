//! Noise figures from a log, without being told where it is at rest.
//!
//! White noise: median absolute second difference, N = MAD(d2) / (.6745 sqrt 6) / sqrt(fs), which motion hardly reaches;
//! on a coarse converter, where the median is a whole number of steps, and over short stretches, where it is imprecise,
//! the root mean square of the second differences with its tails cut; never below LSB / sqrt(12 fs). It is taken over
//! the longest stretch at rest: second-long windows whose scatter is near the quietest and whose mean stays put; a
//! stretch counts as rest only if white noise explains its scatter. Rate random walk from the Allan slope over that
//! stretch: K^2 = 3 (adev(t)^2 - N^2/t) / t at t = 30 s or a quarter of it, but not below 1e-3 N, nor below
//! sqrt(3) N / length: less could not have been seen.

use core::fmt;
use core::ops::Range;

use stillrate::Real;
use stillrate::error::positive;

use super::quantum::smallest_step;
use crate::allan::{AllanSettings, Taus, allan_with};
use crate::error::LogError;
use crate::statistics::{median, quantile};

/// Where noise figures came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseReason {
    /// Measured over a stretch at rest.
    AtRest,
    /// No stretch at rest: white noise from the quietest tenth of the log, the walk assumed.
    NeverAtRest,
    /// All samples are equal: there is no noise to measure.
    Constant,
}

impl fmt::Display for NoiseReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AtRest => "measured over the longest stretch at rest",
            Self::NeverAtRest => {
                "motion dominates: nowhere at rest, white noise from its quietest tenth, rate random walk assumed"
            }
            Self::Constant => "all samples are equal: no noise to measure",
        })
    }
}

/// Noise figures of one channel, in the unit of the log (deg/s).
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseFromLog {
    /// Two-sided white density N, deg/s/sqrt(Hz); above 0.
    pub density_dps_sqrt_hz: f64,
    /// Rate random walk K, deg/s/sqrt(s); above 0.
    pub rate_random_walk_dps_sqrt_s: f64,
    /// Quantisation step, deg/s; 0 if none was seen.
    pub lsb_dps: f64,
    /// Samples (of the log as given) over which the figures were measured.
    pub quiet: Range<usize>,
    /// Part of the log, 0 to 1, in which the rate scatters more than noise does.
    pub moving_fraction: f64,
    /// Whether more than half of the log moves or no part of it is at rest: the figures are then a minor part of it.
    pub motion_dominated: bool,
    /// Where the figures came from.
    pub reason: NoiseReason,
}

/// Fewest finite samples to say anything.
const FEWEST: usize = 8;
/// Length of a window, s, and its fewest samples.
const WINDOW_S: f64 = 1.0;
const WINDOW_LEAST: usize = 32;
/// Fewest samples in a window whose second differences are judged alone.
const DIFFERENCES_LEAST: usize = 128;
/// Windows scattering more than this many times the quietest tenth are not quiet.
const QUIET: f64 = 1.6;
/// Scatter of a stretch over what white noise explains, above which it is not rest. (Low-passed and drifting sensors
/// reach 1.5 in the recordings, hand tremor and the least vibration 4 and more.)
const REST: f64 = 2.0;
/// MAD of a normal deviate over its standard deviation.
const MAD_OF_NORMAL: f64 = 0.674_489_750_196_081_7;
/// Steps of the converter below which a median of second differences is too coarse.
const COARSE: f64 = 3.0;
/// Differences from which the median is precise enough: below, it scatters 1.6 times as much as the root mean square.
const MANY: usize = 2000;
/// Longest averaging time for the walk, s, and the smallest K / N in 1/sqrt(s).
const WALK: (f64, f64) = (30.0, 1e-3);
/// Rest (s) from which the Allan deviation at 1 s is trusted, and how far it must exceed N to replace it (a low-pass in
/// the sensor hides noise from the differences).
const COLOURED: (f64, f64) = (50.0, 1.2);
/// Density assumed for a constant log, relative to its value (or absolute for zeros).
const NOTHING: f64 = 1e-9;

/// White noise, rate random walk and step of the converter from one channel of a log.
///
/// Non-finite samples are left out; `z` otherwise at a regular rate (a few odd time stamps do no harm).
///
/// # Errors
/// [`LogError`] for fewer than 8 finite samples or a sample rate out of range.
///
/// # Example
/// ```
/// use stillrate_lab::{simulate::{BedKind, BedSettings}, tune::noise_from_log};
/// let bed = BedSettings::new(BedKind::Steps, 50.0, 1).simulate().unwrap();
/// let noise = noise_from_log(&bed.measured_dps, 50.0).unwrap();
/// assert!((noise.density_dps_sqrt_hz / 0.0151 - 1.0).abs() < 0.15);
/// assert!(!noise.motion_dominated);
/// ```
pub fn noise_from_log(z: &[f64], sample_rate_hz: f64) -> Result<NoiseFromLog, LogError> {
    let rate = positive("sample_rate_hz", sample_rate_hz, "Hz")?;
    // Numbers whose squares overflow are no readings.
    let usable = |x: f64| x.is_finite() && x.magnitude() < f64::LARGEST.root() * 1e-3;
    let index: Vec<usize> = (0..z.len()).filter(|k| usable(z[*k])).collect();
    let present: Vec<f64> = index.iter().map(|k| z[*k]).collect();
    if present.len() < FEWEST {
        return Err(LogError::TooShort { finite: present.len(), needed: FEWEST });
    }
    if present.iter().all(|x| *x == present[0]) {
        return Ok(constant(present[0], 0..z.len()));
    }
    let lsb = smallest_step(&present);
    let windows = Windows::new(&present, rate);
    let run = windows.longest_quiet_run(lsb);
    let quiet = &present[run.clone()];
    let floor = lsb / (12.0 * rate).root();
    let white = white_sigma(quiet, lsb) / rate.root();
    let at_rest = windows.scatter_in(&run) / rate.root() <= REST * white.max(floor);
    let moving = || windows.quietest_tenth(&present, lsb) / rate.root();
    let measured = if at_rest { coloured(quiet, rate, white) } else { moving() };
    let length_s = quiet.len() as f64 / rate;
    // Only a record of exact straight lines has neither differences nor steps.
    let nothing = NOTHING * present.iter().fold(0.0_f64, |m, x| m.max(x.abs())).max(NOTHING);
    let density = measured.max(floor).max(nothing);
    let unseen = density * (3.0_f64.root() / length_s).max(WALK.1);
    let walk = if at_rest { walk_from_allan(quiet, rate, density).max(unseen) } else { unseen };
    let moving_fraction = windows.moving_fraction(density * rate.root());
    Ok(NoiseFromLog {
        density_dps_sqrt_hz: density,
        rate_random_walk_dps_sqrt_s: walk,
        lsb_dps: lsb,
        quiet: index[run.start]..index[run.end - 1] + 1,
        moving_fraction,
        motion_dominated: !at_rest || moving_fraction > 0.5,
        reason: if at_rest { NoiseReason::AtRest } else { NoiseReason::NeverAtRest },
    })
}

/// One pair of figures for channels that share a filter: the largest density and walk among the channels that were at
/// rest, or among all if none was (too much noise costs less than too little). `None` without channels.
///
/// # Example
/// ```
/// use stillrate_lab::tune::{noise_from_log, shared_noise};
/// let quiet = noise_from_log(&[0.0, 0.1, 0.0, -0.1, 0.1, 0.0, 0.1, 0.0, -0.1], 50.0).unwrap();
/// assert_eq!(shared_noise(&[quiet.clone()]), Some((quiet.density_dps_sqrt_hz, quiet.rate_random_walk_dps_sqrt_s)));
/// ```
#[must_use]
pub fn shared_noise(channels: &[NoiseFromLog]) -> Option<(f64, f64)> {
    let rested = |c: &&NoiseFromLog| c.reason == NoiseReason::AtRest;
    let any = channels.iter().any(|c| rested(&c));
    let used: Vec<&NoiseFromLog> = channels.iter().filter(|c| !any || rested(c)).collect();
    let largest = |f: fn(&NoiseFromLog) -> f64| used.iter().map(|c| f(c)).fold(0.0, f64::max);
    (!used.is_empty()).then(|| (largest(|c| c.density_dps_sqrt_hz), largest(|c| c.rate_random_walk_dps_sqrt_s)))
}

fn constant(value: f64, all: Range<usize>) -> NoiseFromLog {
    let density = NOTHING * value.magnitude().max(NOTHING);
    NoiseFromLog {
        density_dps_sqrt_hz: density,
        rate_random_walk_dps_sqrt_s: WALK.1 * density,
        lsb_dps: 0.0,
        quiet: all,
        moving_fraction: 0.0,
        motion_dominated: false,
        reason: NoiseReason::Constant,
    }
}

/// Standard deviation of the white part of a stretch, from its second differences.
fn white_sigma(z: &[f64], lsb: f64) -> f64 {
    let differences: Vec<f64> = z.windows(3).map(|w| (w[2] - w[1]) - (w[1] - w[0])).collect();
    let middle = median(&mut differences.clone());
    let mut deviations: Vec<f64> = differences.iter().map(|d| (d - middle).magnitude()).collect();
    let mad = median(&mut deviations);
    if mad > COARSE * lsb && deviations.len() >= MANY {
        return mad / (MAD_OF_NORMAL * 6.0_f64.root());
    }
    let limit = (4.0 * mad / MAD_OF_NORMAL).max(COARSE * lsb);
    let kept = deviations.iter().filter(|d| **d <= limit);
    let (sum, count) = kept.fold((0.0, 0.0), |(sum, n), d| (sum + d * d, n + 1.0));
    if count > 0.0 { (sum / count / 6.0).root() } else { 0.0 }
}

/// N at rest; the Allan deviation at 1 s where a long rest shows that the differences miss a part of the noise.
fn coloured(quiet: &[f64], rate: f64, white: f64) -> f64 {
    let second = adev_near(quiet, rate, 1.0);
    let long = quiet.len() as f64 / rate >= COLOURED.0;
    if long && second > COLOURED.1 * white { second } else { white }
}

/// Allan deviation at the octave nearest below `tau_s`, scaled to `tau_s` as white noise; 0 if the record is too short.
fn adev_near(quiet: &[f64], rate: f64, tau_s: f64) -> f64 {
    let settings = AllanSettings { taus: Taus::Octave, ..AllanSettings::default() };
    let Ok(curve) = allan_with(quiet, rate, settings) else { return 0.0 };
    let at = curve.tau_s.iter().rposition(|t| *t <= tau_s).unwrap_or(0);
    curve.deviation.get(at).map_or(0.0, |d| d * (curve.tau_s[at] / tau_s).root())
}

/// K from the Allan variance at 30 s or a quarter of the stretch, less what white noise adds; 0 if nothing is left.
fn walk_from_allan(quiet: &[f64], rate: f64, density: f64) -> f64 {
    let tau = WALK.0.min(quiet.len() as f64 / rate / 4.0);
    let m = (tau * rate) as usize;
    let Ok(variance) = crate::allan::variance_at(quiet, m) else { return 0.0 };
    let tau = m as f64 / rate;
    (3.0 * (variance - density * density / tau) / tau).max(0.0).root()
}

/// Second-long windows of a record without gaps: mean and standard deviation of each.
struct Windows {
    length: usize,
    mean: Vec<f64>,
    scatter: Vec<f64>,
}

impl Windows {
    fn new(z: &[f64], rate: f64) -> Self {
        let wanted = (WINDOW_S * rate).min(1e9) as usize;
        let length = wanted.max(WINDOW_LEAST).min((z.len() / 4).max(FEWEST));
        let chunks = z.chunks_exact(length);
        let mean: Vec<f64> = chunks.clone().map(|w| w.iter().sum::<f64>() / length as f64).collect();
        let scatter = chunks
            .zip(&mean)
            .map(|(w, m)| (w.iter().map(|x| (x - m) * (x - m)).sum::<f64>() / (length - 1) as f64).root())
            .collect();
        Self { length, mean, scatter }
    }

    /// Samples of the longest run of quiet windows with a steady mean.
    fn longest_quiet_run(&self, lsb: f64) -> Range<usize> {
        let level = quantile(&mut self.scatter.clone(), 0.1).max(lsb / 12.0_f64.root());
        let quiet = |k: usize| self.scatter[k] <= QUIET * level;
        let steady = |k: usize| (self.mean[k] - self.mean[k - 1]).magnitude() <= level;
        let (mut best, mut start) = (0..1, 0);
        for k in 0..self.scatter.len() {
            if !quiet(k) {
                start = k + 1;
            } else if k > start && !steady(k) {
                start = k;
            }
            if k + 1 > start && k + 1 - start > best.len() {
                best = start..k + 1;
            }
        }
        best.start * self.length..best.end * self.length
    }

    /// Median standard deviation of the windows in a range of samples.
    fn scatter_in(&self, samples: &Range<usize>) -> f64 {
        median(&mut self.scatter[samples.start / self.length..samples.end / self.length].to_vec())
    }

    /// White standard deviation of the windows, lowest tenth: motion and vibration only ever add to it.
    fn quietest_tenth(&self, z: &[f64], lsb: f64) -> f64 {
        let length = self.length.max(DIFFERENCES_LEAST).min(z.len());
        let mut sigma: Vec<f64> = z.chunks_exact(length).map(|w| white_sigma(w, lsb)).collect();
        // Second differences of n white samples are worth .51 n independent ones: estimates scatter by 1 / sqrt(n), and
        // their lowest tenth lies 1.3 of that below the mean.
        let low = 1.0 - 1.3 / (length as f64).root();
        quantile(&mut sigma, 0.1) / low
    }

    /// Part of the windows that scatter or wander more than noise of this standard deviation.
    fn moving_fraction(&self, sigma: f64) -> f64 {
        let moving = self.scatter.iter().filter(|s| **s > REST * sigma).count();
        moving as f64 / self.scatter.len() as f64
    }
}
