//! Noise figures from a log, without being told where it is at rest.
//!
//! White noise: median absolute second difference, N = MAD(d2) / (.6745 sqrt 6) / sqrt(fs), which motion hardly reaches;
//! on a coarse converter, where the median is a whole number of steps, and over short stretches, where it is imprecise,
//! the root mean square of the second differences with its tails cut; never below LSB / sqrt(12 fs). It is taken over
//! the longest stretch at rest: second-long windows whose scatter is near the quietest and whose mean stays put (see
//! `windows`); a stretch counts as rest only if white noise explains its scatter. Rate random walk from the Allan slope over that
//! stretch: K^2 = 3 (adev(t)^2 - N^2/t) / t at t = 30 s or a quarter of it, but not below 1e-3 N, nor below
//! sqrt(3) N / length: less could not have been seen.

use core::fmt;
use core::ops::Range;

use stillrate::Real;
use stillrate::error::positive;

use super::quantum::smallest_step;
use super::second_differences::white_sigma;
use super::windows::{REST, Windows};
use crate::error::LogError;
use crate::statistics::median;

/// Where noise figures came from.
///
/// # Example
/// ```
/// use stillrate_lab::tune::{NoiseReason, noise_from_log};
/// let stuck = noise_from_log(&[0.3; 100], 50.0).unwrap();
/// assert_eq!(stuck.reason, NoiseReason::Constant);
/// assert_eq!(stuck.reason.to_string(), "all samples are equal: no noise to measure");
/// ```
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
///
/// # Example
/// ```
/// use stillrate_lab::{simulate::GyroNoiseModel, tune::noise_from_log};
/// let model = GyroNoiseModel { density_dps_sqrt_hz: 0.1, lsb_dps: 1.0, ..GyroNoiseModel::perfect() };
/// let mut z = model.record(&[20.0; 4000], 100.0, 1).unwrap().measured_dps;
/// (0..1000).for_each(|k| z[k] += f64::from((k / 100 % 2) as u8) * 40.0); // moves for the first 10 s
/// let noise = noise_from_log(&z, 100.0).unwrap();
/// assert_eq!(noise.lsb_dps, 1.0);
/// assert!(noise.quiet.start >= 900 && (noise.moving_fraction - 0.25).abs() < 0.05);
/// assert!(noise.density_dps_sqrt_hz > 0.1); // the converter's step adds its own noise
/// ```
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
/// Longest averaging time for the walk, s, and the smallest K / N in 1/sqrt(s).
const WALK: (f64, f64) = (30.0, 1e-3);
/// Rest (s) from which the Allan deviation at 1 s is trusted, and how far it must exceed N to replace it (a low-pass in
/// the sensor hides noise from the differences).
const COLOURED: (f64, f64) = (50.0, 1.2);
/// Seconds of a piece whose Allan variance at 1 s is taken alone, and the median of such over their mean.
const PIECE: (usize, f64) = (9, 0.92);
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
    let floor = lsb / (12.0 * rate).root();
    let rest = windows.longest_rest(floor * rate.root());
    let run = rest.run.clone();
    let quiet = &present[run.clone()];
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
    let moving_fraction = windows.moving_fraction(density * rate.root(), &rest);
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

/// N at rest; the Allan deviation at 1 s where a long rest shows that the differences miss a part of the noise.
///
/// It is the median over pieces of the rest, which an unnoticed nudge in a few of them doesn't reach.
fn coloured(quiet: &[f64], rate: f64, white: f64) -> f64 {
    let length_s = quiet.len() as f64 / rate;
    if length_s < COLOURED.0 {
        return white;
    }
    let m = rate.max(1.0) as usize;
    let pieces = quiet.chunks_exact(PIECE.0 * m);
    let mut variances: Vec<f64> = pieces.filter_map(|piece| crate::allan::variance_at(piece, m).ok()).collect();
    if variances.is_empty() {
        return white;
    }
    let second = (median(&mut variances) / PIECE.1 * m as f64 / rate).root();
    let chance = 1.0 + 2.0 / length_s.root();
    if second > COLOURED.1 * chance * white { second } else { white }
}

/// K from the Allan variance at 30 s or a quarter of the stretch, less what white noise adds; 0 if nothing is left.
fn walk_from_allan(quiet: &[f64], rate: f64, density: f64) -> f64 {
    let tau = WALK.0.min(quiet.len() as f64 / rate / 4.0);
    let m = (tau * rate) as usize;
    let Ok(variance) = crate::allan::variance_at(quiet, m) else { return 0.0 };
    let tau = m as f64 / rate;
    (3.0 * (variance - density * density / tau) / tau).max(0.0).root()
}
