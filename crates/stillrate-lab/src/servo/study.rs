//! Validation of tuned designs on seeds that no tuner saw, and the tests around it.

use rayon::prelude::*;
use stillrate::{ConfigError, Real};

use super::family::Family;
use super::measure;
use super::trial::{Bench, Design, Levelling, Trial};
use crate::settings_map::SettingsError;

/// Rest after a motion whose integral is judged.
const SETTLE_S: f64 = 5.0;
/// Where levelling starts, deg.
pub(crate) const LEVEL_FROM_DEG: f64 = 20.0;

/// Mean and extremes over seeds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Smallest.
    pub low: f64,
    /// Largest.
    pub high: f64,
}

impl Spread {
    /// Of some values (infinite ones stay infinite).
    #[must_use]
    pub fn of(values: &[f64]) -> Self {
        Self {
            mean: values.iter().sum::<f64>() / values.len().max(1) as f64,
            low: values.iter().copied().fold(f64::INFINITY, f64::min),
            high: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

/// A design's row in the table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Residual rms of the sine run over seeds, deg.
    pub rms_deg: Spread,
    /// Residual maximum over seeds, deg.
    pub max_deg: Spread,
    /// Rest jitter after the tilt, root mean square over seeds, percent of the supply.
    pub jitter_percent: f64,
    /// Its values over seeds.
    pub jitter_seeds: Spread,
    /// The same without any disturbance, root mean square over seeds.
    pub undisturbed_percent: f64,
    /// Jitter in motion, percent.
    pub motion_jitter_percent: f64,
    /// Smallest gain margin over seeds.
    pub gain_margin: f64,
    /// Smallest delay margin over seeds, ms.
    pub delay_margin_ms: f64,
    /// Voltage in motion, rms in percent of the supply.
    pub voltage_rms_percent: f64,
    /// Final levelling error from 20 deg over seeds, deg.
    pub levelling_deg: Spread,
    /// What of it is the loop's own and not the gyro's drift, deg.
    pub levelling_own_deg: Spread,
}

/// What one seed gives.
struct OneSeed {
    rms: f64,
    max: f64,
    after: f64,
    before: f64,
    gain: f64,
    delay: f64,
    volts: f64,
    level: Levelling,
}

/// Measures a design on the given seeds (use some that its tuner did not see). `margins` of them also measure the margins.
///
/// # Errors
/// Settings that cannot be used.
pub fn validate(
    bench: &Bench,
    family: &Family,
    design: &Design,
    seeds: &[u64],
    margins: usize,
) -> Result<Row, SettingsError> {
    let period = 1.0 / bench.sample_rate_hz;
    let measured: Vec<OneSeed> = seeds
        .par_iter()
        .enumerate()
        .map(|(i, seed)| -> Result<OneSeed, SettingsError> {
            let mut trial = Trial::new(bench, family, design)?;
            let sine = trial.sine(*seed)?;
            let residual = measure::residual(&sine, super::trial::RESIDUAL_FROM_S, period);
            let wanted = i < margins;
            Ok(OneSeed {
                rms: residual.rms_deg,
                max: residual.max_deg,
                after: trial.jitter_after_tilt(*seed, 1.0, 0.0)?,
                before: trial.jitter_undisturbed(*seed)?,
                gain: if wanted { trial.gain_margin(*seed)? } else { f64::INFINITY },
                delay: if wanted { trial.delay_margin_ms(*seed)? } else { f64::INFINITY },
                volts: measure::voltage_rms(&sine, super::trial::RESIDUAL_FROM_S, period, bench.plant.voltage_max_v),
                level: trial.levelling(*seed, LEVEL_FROM_DEG)?,
            })
        })
        .collect::<Result<_, _>>()?;
    let column = |f: fn(&OneSeed) -> f64| measured.iter().map(f).collect::<Vec<f64>>();
    let pooled = |v: Vec<f64>| (v.iter().map(|x| x * x).sum::<f64>() / v.len().max(1) as f64).root();
    let least = |v: Vec<f64>| v.into_iter().fold(f64::INFINITY, f64::min);
    let motion = match seeds {
        [a, b, ..] => Trial::new(bench, family, design)?.motion_jitter(*a, *b)?,
        _ => f64::NAN,
    };
    Ok(Row {
        rms_deg: Spread::of(&column(|m| m.rms)),
        max_deg: Spread::of(&column(|m| m.max)),
        jitter_percent: pooled(column(|m| m.after)),
        jitter_seeds: Spread::of(&column(|m| m.after)),
        undisturbed_percent: pooled(column(|m| m.before)),
        motion_jitter_percent: motion,
        gain_margin: least(column(|m| m.gain)),
        delay_margin_ms: least(column(|m| m.delay)),
        voltage_rms_percent: column(|m| m.volts).iter().sum::<f64>() / measured.len().max(1) as f64,
        levelling_deg: Spread::of(&column(|m| m.level.error_deg)),
        levelling_own_deg: Spread::of(&column(|m| m.level.own_deg)),
    })
}

/// Peak angle of base tilts in `duration_s`, deg: mean over both signs and the seeds, one entry a tilt.
///
/// # Errors
/// Settings that cannot be used.
pub fn tilt_table(
    bench: &Bench,
    family: &Family,
    design: &Design,
    tilts_deg: &[f64],
    duration_s: f64,
    seeds: &[u64],
) -> Result<Vec<f64>, SettingsError> {
    tilts_deg
        .par_iter()
        .map(|tilt| {
            let mut trial = Trial::new(bench, family, design)?;
            let mut peaks = Vec::new();
            for seed in seeds {
                peaks.push(trial.tilt_peak_deg(*seed, *tilt, duration_s)?);
                peaks.push(trial.tilt_peak_deg(*seed, -*tilt, duration_s)?);
            }
            Ok(Spread::of(&peaks).mean)
        })
        .collect()
}

/// Error that integrating the filter's output adds to integrating the raw rate, deg: root mean square over seeds of the difference after `duration_s` of
/// `rate_dps(t)` plus white noise and then 5 s of rest, in which a filter's lag runs out: what is left is lasting.
///
/// # Errors
/// Settings that cannot be used.
pub fn integration_error_deg(
    bench: &Bench,
    family: &Family,
    parameters: &[f64],
    rate_dps: impl Fn(f64) -> f64 + Sync,
    duration_s: f64,
    seeds: &[u64],
) -> Result<f64, SettingsError> {
    let period = 1.0 / bench.sample_rate_hz;
    let sigma = bench.noise.density_dps_sqrt_hz * bench.sample_rate_hz.root();
    let squares: Vec<f64> = seeds
        .par_iter()
        .map(|seed| -> Result<f64, SettingsError> {
            let mut filter = family.build(parameters)?;
            let mut random = crate::random::Random::new(*seed, 1);
            let mut added = 0.0;
            for k in 0..((duration_s + SETTLE_S) * bench.sample_rate_hz) as usize {
                let t = k as f64 * period;
                let moving = if t < duration_s { rate_dps(t) } else { 0.0 };
                let y = moving + sigma * random.normal();
                added += period * (filter.step(y) - y);
            }
            Ok(added * added)
        })
        .collect::<Result<_, _>>()?;
    Ok((squares.iter().sum::<f64>() / squares.len().max(1) as f64).root())
}

/// What a user should know before running: a base that the drive cannot follow, an angle beyond the range, an unstable loop.
///
/// The number that shows it is in the text. `filter` is what
/// [`linear_equivalent`](super::loop_filter::linear_equivalent) makes of the loop's filter.
#[must_use]
pub fn warnings(
    axis: &super::platform::Platform,
    base: &super::base::Base,
    (filter, whole): &(super::discrete::Discrete, bool),
    range_deg: f64,
) -> Vec<String> {
    const DEGREES: f64 = 180.0 / core::f64::consts::PI;
    let mut found = Vec::new();
    let (angle, rate) = base.extremes();
    let has = axis.plant.rate_limit_rad_s();
    if rate > has {
        found.push(format!(
            "unreachable: the base needs {:.1} deg/s, the drive has {:.1} deg/s (voltage_max_v / (motor_constant_v_s gear_ratio))",
            rate * DEGREES,
            has * DEGREES
        ));
    }
    if angle * DEGREES > range_deg * (1.0 + 1e-9) {
        found.push(format!("the base tilts to {:.1} deg, the range is {range_deg:.1} deg", angle * DEGREES));
    }
    let radius = super::linear::LinearLoop::new(axis, filter).spectral_radius();
    // One eigenvalue is 1 by nature: an angle that comes from a gyro alone has no absolute reference.
    if radius > 1.0 + 1e-6 {
        found.push(if *whole {
            format!("the loop is unstable: its linearised spectral radius is {radius:.4} (must be at most 1)")
        } else {
            format!("with its filter fully open the loop would be unstable (linearised spectral radius {radius:.4}): watch its rest after a tilt")
        });
    }
    found
}

/// Checks that a bench can be built at all.
///
/// # Errors
/// [`ConfigError`] naming the field.
pub fn check(bench: &Bench) -> Result<(), ConfigError> {
    bench.axis(super::controller::Controller::default(), 0.0).map(|_| ())
}
