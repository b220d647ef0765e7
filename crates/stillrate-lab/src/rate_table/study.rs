//! The comparison behind the verdict: every method on the same simulated unit, on motions none of them was fitted or tuned on.
//!
//! Calibration (13 rates of 10 s), tuning motions and test motions have their own noise. What a method is allowed to see is
//! what its owner would have: the rate table gives the truth for the calibration; noise is tuned on motions with truth or by the
//! innovations without.

use stillrate::correction::ErrorCurve;
use stillrate::filters::{MsImmIkf, MsImmIkfSettings};
use stillrate::{Filter, Real, Sample, Settings};

use crate::metrics::rmse;
use crate::random::Random;
use crate::rate_table::bed::{
    JUMP_MOTIONS, Motion, OUTSIDE_MOTION, Pair, SAMPLE_RATE_HZ, TEST_MOTIONS, TUNING_MOTIONS, Unit,
};
use crate::rate_table::candidate::{self, Candidate};
use crate::rate_table::fit::{Fit, Options, fit};
use crate::rate_table::points::Log;
use crate::rate_table::published;
use crate::rate_table::training::Training;
use crate::tune::gain_ratio::{Criterion, GainRatio, Walk};
use crate::tune::minimise;
use crate::tune::records::Record;
use crate::tune::track::track;
use crate::tune::tuned::Tuned;
use crate::tune::tuned_bank::tune_bank;

/// Rates of the calibration run.
const CALIBRATION_RATES: usize = 13;
/// Duration of each, s.
const CALIBRATION_S: f64 = 10.0;
/// Streams of a unit's seed: 0 draws the unit, 100 and on the published records.
const STREAMS: [u64; 3] = [1, 1000, 2000];
/// Sample period of the bed, s.
pub(crate) const PERIOD_S: f64 = 1.0 / SAMPLE_RATE_HZ;

/// From measured to estimated rate.
type Method<'a> = Box<dyn Fn(&[f64]) -> Vec<f64> + Sync + 'a>;

/// Everything that was fitted and tuned for a unit, and how every method did with it.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::{bed::Unit, study::Study};
/// let study = Study::of(&Unit::NOMINAL, 1, 0)?; // without the published network
/// let overall = |name: &str| study.rows.iter().find(|row| row.method == name).map(|row| row.overall()).unwrap();
/// // The calibration takes away next to nothing of a sample's error; the filter behind it does the work.
/// assert!(overall("calibration only") > 0.95 * overall("raw"));
/// assert!(overall("two-state KF, innovations, then calibration") < 0.3 * overall("raw"));
/// // Tuned on constant rates by the truth, as published, Q/R is ten thousand times too small for motion.
/// assert!(study.on_constants[1].log10_ratio < study.seen[0].log10_ratio - 4.0);
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug)]
pub struct Study {
    /// The honest calibration.
    pub fit: Fit,
    /// Noise tuned on the tuning motions by innovations: random walk, rate and acceleration.
    pub blind: [Tuned; 2],
    /// The same by the true rate.
    pub seen: [Tuned; 2],
    /// Random walk tuned on constants only: by innovations, by the true rate (the published objective).
    pub on_constants: [Tuned; 2],
    /// Every method on motions that none was fitted or tuned on.
    pub rows: Vec<Row>,
}

/// How a method did on one unit; all figures are root mean squares of estimated less true rate, deg/s.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::study::Row;
/// let row = Row { method: "raw".into(), in_range: vec![0.3, 0.4], jumps: vec![9.0], outside: 9.0 };
/// assert!((row.overall() - 0.125_f64.sqrt()).abs() < 1e-15); // neither jumps nor what lies outside count
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the method.
    pub method: String,
    /// On each test motion in range.
    pub in_range: Vec<f64>,
    /// On each motion that jumps.
    pub jumps: Vec<f64>,
    /// On the motion beyond the calibrated range.
    pub outside: f64,
}

impl Row {
    /// Root mean square over all test motions in range.
    #[must_use]
    pub fn overall(&self) -> f64 {
        (self.in_range.iter().map(|v| v * v).sum::<f64>() / self.in_range.len() as f64).root()
    }
}

/// What only the methods need to know of a unit, beside a [`Study`].
struct Prepared {
    /// A straight line through the calibration points.
    line: ErrorCurve<f64>,
    /// The published network, if asked for.
    published: Option<ErrorCurve<f64>>,
    /// The recommended bank with the noise its innovations on the tuning motions imply.
    bank: MsImmIkf<f64>,
}

/// Records of a list of motions.
fn measure_all(unit: &Unit, motions: &[Motion], seed: u64, stream: u64) -> Vec<Pair> {
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

/// Tunes on pairs by Brent's search.
pub(crate) fn tune_on(pairs: &[Pair], walk: Walk, criterion: Criterion) -> Result<Tuned, String> {
    let records: Vec<Record<'_>> = pairs.iter().map(|(w, y)| Record { measured: y, truth: Some(w) }).collect();
    let objective = GainRatio { records: &records, walk, criterion, period_s: PERIOD_S };
    objective.tune(&minimise::Method::default(), false, &mut |_| true).map_err(|error| error.to_string())
}

/// Subtracts a curve from each sample.
pub(crate) fn subtract(curve: &ErrorCurve<f64>, rates: &[f64]) -> Vec<f64> {
    rates.iter().map(|y| curve.correct(*y, [0.0; 2]).rate).collect()
}

fn compensated(curve: &ErrorCurve<f64>, pairs: &[Pair]) -> Vec<Pair> {
    pairs.iter().map(|(w, y)| (w.clone(), subtract(curve, y))).collect()
}

impl Study {
    /// Calibrates and tunes for a unit, then scores every method. `published_epochs` is the most the published network is trained for;
    /// 0 leaves it out.
    ///
    /// # Errors
    /// A sentence if a step could not be done.
    pub fn of(unit: &Unit, seed: u64, published_epochs: usize) -> Result<Self, String> {
        let (truth, measured) = unit.calibration(CALIBRATION_RATES, CALIBRATION_S, &mut Random::new(seed, STREAMS[0]));
        let points = Log { measured: &measured, truth: &truth, temperature: None }.points()?;
        let line = candidate::fit(Candidate::Polynomial(1), &points, 1).ok_or("no line through the points")?;
        let fit = fit(points, &Options::default())?;
        let tuning = compensated(&fit.curve, &measure_all(unit, &TUNING_MOTIONS, seed, STREAMS[1]));
        let constants = &tuning[..2];
        let published = if published_epochs > 0 {
            let training = Training { epochs: published_epochs, ..Training::published(seed) };
            Some(published::train_on(&unit.published_records(seed), &training)?)
        } else {
            None
        };
        let blind_records: Vec<Record<'_>> = tuning.iter().map(|(_, y)| Record { measured: y, truth: None }).collect();
        let noise = tune_bank(&blind_records, PERIOD_S, &mut |_| true).map_err(|error| error.to_string())?.noise;
        let bank = MsImmIkfSettings::defaults(SAMPLE_RATE_HZ, noise).build().map_err(|error| error.to_string())?;
        let mut study = Self {
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
            rows: Vec::new(),
        };
        study.rows = {
            let prepared = Prepared { line, published, bank };
            score(unit, seed, &contenders(&study, &prepared))
        };
        Ok(study)
    }
}

/// The methods of the comparison for a prepared unit, each with its name in tables.
fn contenders<'a>(study: &'a Study, prepared: &'a Prepared) -> Vec<(&'static str, Method<'a>)> {
    let curve = &study.fit.curve;
    let line = &prepared.line;
    let walk = move |tuned: &Tuned, y: &[f64]| track(Walk::RandomWalk, tuned.log10_ratio, PERIOD_S, y);
    let two = move |tuned: &Tuned, y: &[f64]| track(Walk::RateAcceleration, tuned.log10_ratio, PERIOD_S, y);
    let [blind, blind_two] = &study.blind;
    let [seen, seen_two] = &study.seen;
    let [still, still_seen] = &study.on_constants;
    let mut all: Vec<(&'static str, Method<'a>)> = vec![
        ("raw", Box::new(<[f64]>::to_vec)),
        ("calibration only", Box::new(|y| subtract(curve, y))),
        ("KF, truth on motion", Box::new(move |y| walk(seen, y))),
        ("line + KF, truth on motion", Box::new(move |y| walk(seen, &subtract(line, y)))),
        ("calibration + KF, truth on motion", Box::new(move |y| walk(seen, &subtract(curve, y)))),
        ("calibration + KF, innovations on motion", Box::new(move |y| walk(blind, &subtract(curve, y)))),
        ("calibration + KF, innovations on constants", Box::new(move |y| walk(still, &subtract(curve, y)))),
        ("calibration + KF, truth on constants", Box::new(move |y| walk(still_seen, &subtract(curve, y)))),
        ("two-state KF, innovations on motion", Box::new(move |y| two(blind_two, y))),
        ("two-state KF, innovations, then calibration", Box::new(move |y| subtract(curve, &two(blind_two, y)))),
        ("two-state KF, truth, then calibration", Box::new(move |y| subtract(curve, &two(seen_two, y)))),
    ];
    let bank = &prepared.bank;
    all.push(("IMM bank, innovations, then calibration", Box::new(|y| subtract(curve, &run_bank(bank, y)))));
    if let Some(published) = &prepared.published {
        all.push(("published network", Box::new(|y| subtract(published, y))));
        let slow = move |y: &[f64]| track(Walk::RandomWalk, -12.0, PERIOD_S, &subtract(published, y));
        all.push(("published network + its KF", Box::new(slow)));
    }
    all
}

/// Scores methods on the test motions, the jumps and the motion outside.
fn score(unit: &Unit, seed: u64, contenders: &[(&str, Method<'_>)]) -> Vec<Row> {
    let motions: Vec<Motion> = TEST_MOTIONS.iter().chain(&JUMP_MOTIONS).chain([&OUTSIDE_MOTION]).copied().collect();
    let pairs = measure_all(unit, &motions, seed, STREAMS[2]);
    contenders
        .iter()
        .map(|(name, run)| {
            let errors: Vec<f64> = pairs.iter().map(|(w, y)| rmse(&run(y), w)).collect();
            let (in_range, rest) = errors.split_at(TEST_MOTIONS.len());
            let (jumps, outside) = rest.split_at(JUMP_MOTIONS.len());
            Row { method: (*name).to_owned(), in_range: in_range.to_vec(), jumps: jumps.to_vec(), outside: outside[0] }
        })
        .collect()
}

/// Rates of the bank at each sample.
fn run_bank(bank: &MsImmIkf<f64>, measured: &[f64]) -> Vec<f64> {
    let mut state = bank.start();
    measured.iter().map(|&value| bank.step(&mut state, Sample { value, dt: PERIOD_S }).rate).collect()
}
