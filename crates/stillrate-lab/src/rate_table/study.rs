//! The comparison behind the verdict: every method on the same simulated unit, on motions none of them was fitted or tuned on.
//!
//! Calibration (13 rates of 10 s), tuning motions and test motions have their own noise. What a method is allowed to see is
//! what its owner would have: the rate table gives the truth for the calibration; noise is tuned on motions with truth or by the
//! innovations without.

// A boxed closure from record to record is as simple as it gets.
#![allow(clippy::type_complexity)]

use stillrate::correction::ErrorCurve;
use stillrate::filters::{MsImmIkf, MsImmIkfSettings};
use stillrate::{Filter, Real, Sample, Settings};

use crate::random::Random;
use crate::rate_table::bed::{
    JUMP_MOTIONS, Motion, OUTSIDE_MOTION, SAMPLE_RATE_HZ, TEST_MOTIONS, TUNING_MOTIONS, Unit, calibration,
};
use crate::rate_table::candidate::{self, Candidate};
use crate::rate_table::fit::{Fit, Options, fit};
use crate::rate_table::points::{Log, from_log};
use crate::rate_table::published;
use crate::rate_table::training::Training;
use crate::tune::brent::Brent;
use crate::tune::gain_ratio::{Criterion, Walk};
use crate::tune::minimise::Method;
use crate::tune::records::Record;
use crate::tune::track::track;
use crate::tune::tuned::{Tuned, tune};
use crate::tune::tuned_bank::tune_bank;

/// Rates of the calibration run.
const CALIBRATION_RATES: usize = 13;
/// Duration of each, s.
const CALIBRATION_S: f64 = 10.0;
/// Streams of a unit's seed: 0 draws the unit, 100 and on the published records.
const STREAMS: [u64; 3] = [1, 1000, 2000];
/// Sample period of the bed, s.
pub const PERIOD_S: f64 = 1.0 / SAMPLE_RATE_HZ;

/// A true and a measured record.
pub type Pair = (Vec<f64>, Vec<f64>);

/// A method of the comparison: how its output comes from the measured record.
pub struct Contender<'a> {
    /// Name in tables.
    pub name: String,
    /// From measured to estimated rate.
    pub run: Box<dyn Fn(&[f64]) -> Vec<f64> + Sync + 'a>,
}

/// How a method did on one unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the method.
    pub method: String,
    /// Root mean square error on each test motion.
    pub in_range: Vec<f64>,
    /// On each motion that jumps.
    pub jumps: Vec<f64>,
    /// On the motion beyond the calibrated range.
    pub outside: f64,
}

impl Row {
    /// Root mean square over all test motions.
    #[must_use]
    pub fn overall(&self) -> f64 {
        (self.in_range.iter().map(|v| v * v).sum::<f64>() / self.in_range.len() as f64).root()
    }
}

/// Everything that was fitted and tuned for a unit.
pub struct Prepared {
    /// The honest calibration.
    pub fit: Fit,
    /// A straight line through the same points.
    pub line: ErrorCurve<f64>,
    /// The published network, if asked for.
    pub published: Option<ErrorCurve<f64>>,
    /// Noise tuned on the tuning motions by innovations: random walk, rate and acceleration.
    pub blind: [Tuned; 2],
    /// The same by the true rate.
    pub seen: [Tuned; 2],
    /// Random walk tuned on constants only: by innovations, by the true rate (the published objective).
    pub on_constants: [Tuned; 2],
    /// The recommended bank with the noise its innovations on the tuning motions imply.
    pub bank: MsImmIkf<f64>,
}

/// Records of a list of motions.
#[must_use]
pub fn measure_all(unit: &Unit, motions: &[Motion], seed: u64, stream: u64) -> Vec<Pair> {
    motions
        .iter()
        .enumerate()
        .map(|(k, motion)| {
            let truth = motion.rates(SAMPLE_RATE_HZ);
            let measured = unit.measure(&truth, SAMPLE_RATE_HZ, &mut Random::new(seed, stream + k as u64));
            (truth, measured)
        })
        .collect()
}

/// Tunes on pairs after subtracting a curve.
///
/// # Errors
/// A sentence if a record cannot be used.
pub fn tune_on(pairs: &[Pair], walk: Walk, criterion: Criterion) -> Result<Tuned, String> {
    let records: Vec<Record<'_>> = pairs.iter().map(|(w, y)| Record { measured: y, truth: Some(w) }).collect();
    let method = Method::Brent(Brent::default());
    tune(&records, PERIOD_S, walk, criterion, &method, false, &mut |_| true).map_err(|error| error.to_string())
}

/// Subtracts a curve from each sample.
#[must_use]
pub fn subtract(curve: &ErrorCurve<f64>, rates: &[f64]) -> Vec<f64> {
    rates.iter().map(|y| curve.correct(*y, [0.0; 2]).rate).collect()
}

fn compensated(curve: &ErrorCurve<f64>, pairs: &[Pair]) -> Vec<Pair> {
    pairs.iter().map(|(w, y)| (w.clone(), subtract(curve, y))).collect()
}

/// Calibrates and tunes for a unit.
///
/// # Errors
/// A sentence if a step could not be done.
pub fn prepare(unit: &Unit, seed: u64, published_epochs: usize) -> Result<Prepared, String> {
    let (truth, measured) = calibration(unit, CALIBRATION_RATES, CALIBRATION_S, &mut Random::new(seed, STREAMS[0]));
    let points = from_log(Log { measured: &measured, truth: &truth, temperature: None })?;
    let line = candidate::fit(Candidate::Polynomial(1), &points, 1).ok_or("no line through the points")?;
    let fit = fit(points, &Options::default())?;
    let tuning = compensated(&fit.curve, &measure_all(unit, &TUNING_MOTIONS, seed, STREAMS[1]));
    let constants = &tuning[..2];
    let published = if published_epochs > 0 {
        let training = Training { epochs: published_epochs, ..Training::published(seed) };
        Some(published::train_on(&published::records(unit, seed), &training)?.0)
    } else {
        None
    };
    let blind_records: Vec<Record<'_>> = tuning.iter().map(|(_, y)| Record { measured: y, truth: None }).collect();
    let noise = tune_bank(&blind_records, PERIOD_S, &mut |_| true).map_err(|error| error.to_string())?.noise;
    let bank = MsImmIkfSettings::defaults(SAMPLE_RATE_HZ, noise).build().map_err(|error| error.to_string())?;
    Ok(Prepared {
        bank,
        line,
        published,
        blind: [
            tune_on(&tuning, Walk::RandomWalk, Criterion::Innovation)?,
            tune_on(&tuning, Walk::RateAcceleration, Criterion::Innovation)?,
        ],
        seen: [
            tune_on(&tuning, Walk::RandomWalk, Criterion::Truth)?,
            tune_on(&tuning, Walk::RateAcceleration, Criterion::Truth)?,
        ],
        on_constants: [
            tune_on(constants, Walk::RandomWalk, Criterion::Innovation)?,
            tune_on(constants, Walk::RandomWalk, Criterion::Truth)?,
        ],
        fit,
    })
}

/// The methods of the comparison for a prepared unit.
#[must_use]
pub fn contenders(prepared: &Prepared) -> Vec<Contender<'_>> {
    let curve = &prepared.fit.curve;
    let line = &prepared.line;
    let walk = move |tuned: &Tuned, y: &[f64]| track(Walk::RandomWalk, tuned.log10_ratio, PERIOD_S, y);
    let two = move |tuned: &Tuned, y: &[f64]| track(Walk::RateAcceleration, tuned.log10_ratio, PERIOD_S, y);
    let [blind, blind_two] = &prepared.blind;
    let [seen, seen_two] = &prepared.seen;
    let [still, still_seen] = &prepared.on_constants;
    let contender = |name: &str, run: Box<dyn Fn(&[f64]) -> Vec<f64> + Sync>| Contender { name: name.to_owned(), run };
    let mut all = vec![
        contender("raw", Box::new(<[f64]>::to_vec)),
        contender("calibration only", Box::new(|y| subtract(curve, y))),
        contender("KF, truth on motion", Box::new(move |y| walk(seen, y))),
        contender("line + KF, truth on motion", Box::new(move |y| walk(seen, &subtract(line, y)))),
        contender("calibration + KF, truth on motion", Box::new(move |y| walk(seen, &subtract(curve, y)))),
        contender("calibration + KF, innovations on motion", Box::new(move |y| walk(blind, &subtract(curve, y)))),
        contender("calibration + KF, innovations on constants", Box::new(move |y| walk(still, &subtract(curve, y)))),
        contender("calibration + KF, truth on constants", Box::new(move |y| walk(still_seen, &subtract(curve, y)))),
        contender("two-state KF, innovations on motion", Box::new(move |y| two(blind_two, y))),
        contender(
            "two-state KF, innovations, then calibration",
            Box::new(move |y| subtract(curve, &two(blind_two, y))),
        ),
        contender("two-state KF, truth, then calibration", Box::new(move |y| subtract(curve, &two(seen_two, y)))),
    ];
    let bank = &prepared.bank;
    all.push(contender("IMM bank, innovations, then calibration", Box::new(|y| subtract(curve, &run_bank(bank, y)))));
    if let Some(published) = &prepared.published {
        all.push(contender("published network", Box::new(|y| subtract(published, y))));
        let slow = move |y: &[f64]| track(Walk::RandomWalk, -12.0, PERIOD_S, &subtract(published, y));
        all.push(contender("published network + its KF", Box::new(slow)));
    }
    all
}

/// Scores methods on the test motions, the jumps and the motion outside.
#[must_use]
pub fn score(unit: &Unit, seed: u64, contenders: &[Contender<'_>]) -> Vec<Row> {
    let motions: Vec<Motion> = TEST_MOTIONS.iter().chain(&JUMP_MOTIONS).chain([&OUTSIDE_MOTION]).copied().collect();
    let pairs = measure_all(unit, &motions, seed, STREAMS[2]);
    contenders
        .iter()
        .map(|contender| {
            let errors: Vec<f64> = pairs.iter().map(|(w, y)| root_mean_square(&(contender.run)(y), w)).collect();
            let (in_range, rest) = errors.split_at(TEST_MOTIONS.len());
            let (jumps, outside) = rest.split_at(JUMP_MOTIONS.len());
            Row {
                method: contender.name.clone(),
                in_range: in_range.to_vec(),
                jumps: jumps.to_vec(),
                outside: outside[0],
            }
        })
        .collect()
}

/// Rates of the bank at each sample.
fn run_bank(bank: &MsImmIkf<f64>, measured: &[f64]) -> Vec<f64> {
    let mut state = bank.start();
    measured.iter().map(|&value| bank.step(&mut state, Sample { value, dt: PERIOD_S }).rate).collect()
}

/// Root mean square difference of two records.
#[must_use]
pub fn root_mean_square(estimate: &[f64], truth: &[f64]) -> f64 {
    let sum: f64 = estimate.iter().zip(truth).map(|(x, w)| (x - w) * (x - w)).sum();
    (sum / truth.len() as f64).root()
}
