//! Validation of tuned designs on seeds that no tuner saw, and the tests around it.

use rayon::prelude::*;
use stillrate::Real;

use super::bench::{Bench, Design};
use super::family::Family;
use super::measure;
use super::trial::{Levelling, RESIDUAL_FROM_S, Trial};
use crate::random::Random;
use crate::settings_map::SettingsError;

/// Rest after a motion whose integral is judged.
const SETTLE_S: f64 = 5.0;

/// Mean and extremes over seeds.
///
/// # Example
/// ```
/// use stillrate_lab::servo::study::Spread;
/// assert_eq!(Spread::of(&[3.0, 1.0, 2.0]), Spread { mean: 2.0, low: 1.0, high: 3.0 });
/// // One seed on which the platform was lost cannot hide among the others.
/// assert_eq!(Spread::of(&[3.0, f64::INFINITY]).mean, f64::INFINITY);
/// ```
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
///
/// # Example
/// ```
/// use stillrate_lab::servo::bench::{Bench, Design};
/// use stillrate_lab::servo::{controller::Controller, family::standard, study::validate};
/// let bench = Bench::paper(50.0);
/// let design = Design { controller: Controller::default(), parameters: vec![] };
/// let row = validate(&bench, &standard(50.0, bench.noise)[0], &design, &[1, 2], 1).unwrap();
/// // Half of the supply's voltage goes into a swing of 10 deg at 1 Hz, a twentieth of a percent into the gyro's noise at rest.
/// assert!(row.voltage_rms_percent > 40.0 && row.jitter_percent < 0.1);
/// // What is left after levelling is the gyro's bias and noise, hardly the loop's own.
/// assert!(row.levelling_own_deg.mean < 0.5 * row.levelling_deg.mean);
/// assert!(row.gain_margin >= 2.0 && row.delay_margin_ms >= 10.0);
/// ```
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
///
/// # Example
/// ```
/// use stillrate_lab::servo::bench::{Bench, Design};
/// use stillrate_lab::servo::{controller::Controller, family::standard, study::validate};
/// let bench = Bench::paper(50.0);
/// let [none, pt1, ..] = &standard(50.0, bench.noise)[..] else { unreachable!() };
/// let measured = |family, parameters| {
///     let design = Design { controller: Controller::default(), parameters };
///     validate(&bench, family, &design, &[1, 2], 0).unwrap().rms_deg.mean
/// };
/// // With the controller as it is, a low-pass in the loop makes the platform no stiller.
/// assert!(measured(pt1, vec![5.3]) > measured(none, vec![]));
/// ```
pub fn validate(
    bench: &Bench,
    family: &Family,
    design: &Design,
    seeds: &[u64],
    margins: usize,
) -> Result<Row, SettingsError> {
    let period = bench.period();
    let measured: Vec<OneSeed> = seeds
        .par_iter()
        .enumerate()
        .map(|(i, seed)| -> Result<OneSeed, SettingsError> {
            let mut trial = Trial::new(bench, family, design)?;
            let sine = trial.sine(*seed)?;
            let residual = measure::residual(&sine, RESIDUAL_FROM_S, period);
            let wanted = i < margins;
            Ok(OneSeed {
                rms: residual.rms_deg,
                max: residual.max_deg,
                after: trial.jitter_after_tilt(*seed, 1.0, 0.0)?,
                before: trial.jitter_undisturbed(*seed)?,
                gain: if wanted { trial.gain_margin(*seed)? } else { f64::INFINITY },
                delay: if wanted { trial.delay_margin_ms(*seed)? } else { f64::INFINITY },
                volts: measure::voltage_rms(&sine, RESIDUAL_FROM_S, period, bench.plant.voltage_max_v),
                level: trial.levelling(*seed)?,
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
///
/// # Example
/// ```
/// use stillrate_lab::servo::bench::{Bench, Design};
/// use stillrate_lab::servo::{controller::Controller, family::standard, study::tilt_table};
/// let bench = Bench::paper(50.0);
/// let none = &standard(50.0, bench.noise)[0];
/// let design = Design { controller: Controller::default(), parameters: vec![] };
/// let peaks = tilt_table(&bench, none, &design, &[20.0, 10.0], 0.4, &[1]).unwrap();
/// assert!((peaks[0] / peaks[1] - 2.0).abs() < 0.1); // nearly in proportion to the tilt: the loop's bandwidth, not friction
/// ```
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
///
/// # Example
/// ```
/// use stillrate_lab::servo::{bench::Bench, family::standard, study::integration_error_deg};
/// let bench = Bench::paper(50.0);
/// let families = standard(50.0, bench.noise);
/// let added = |name: &str, parameters: &[f64]| {
///     let family = families.iter().find(|f| f.name == name).unwrap();
///     let slow = |t: f64| 0.2 * (core::f64::consts::TAU * 0.05 * t).sin();
///     integration_error_deg(&bench, family, parameters, slow, 25.0, &[1, 2]).unwrap()
/// };
/// assert_eq!(added("none", &[]), 0.0);
/// // A low-pass hands on all that it is given; the bank takes a motion below the noise for none.
/// assert!(added("ms-imm-ikf+pt1", &[3.6]) > 10.0 * added("pt1", &[3.6]));
/// ```
pub fn integration_error_deg(
    bench: &Bench,
    family: &Family,
    parameters: &[f64],
    rate_dps: impl Fn(f64) -> f64 + Sync,
    duration_s: f64,
    seeds: &[u64],
) -> Result<f64, SettingsError> {
    let period = bench.period();
    let sigma = bench.noise.density_dps_sqrt_hz * bench.sample_rate_hz.root();
    let squares: Vec<f64> = seeds
        .par_iter()
        .map(|seed| -> Result<f64, SettingsError> {
            let mut filter = family.build(parameters)?;
            let mut random = Random::new(*seed, 1);
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
