//! The layout of the published table 3 on simulated records like the paper's: six constant rates, mean squared and mean absolute error of each method.
//!
//! Every method here is trained or tuned with the truth of the very records it is scored on, as in the publication.
//! QPSO-KF searches log10 Q and log10 R with the published swarm. BP-KF is not defined in the publication; the stand-in
//! is a small network from two statistics of a record to log10(Q/R), trained on the best values of other constant records.

use stillrate::Real;
use stillrate::correction::ErrorCurve;

use crate::random::Random;
use crate::rate_table::bed::{Pair, SAMPLE_RATE_HZ, Unit};
use crate::rate_table::errors::Errors;
use crate::rate_table::network::{Network, Scaling, Shape};
use crate::rate_table::published;
use crate::rate_table::study::{PERIOD_S, subtract, tune_on};
use crate::rate_table::training::{self, Training};
use crate::tune::gain_ratio::{Criterion, GainRatio, LN_10, Walk};
use crate::tune::minimise::Method;
use crate::tune::qpso::Qpso;
use crate::tune::records::Record;
use crate::tune::track::track;
use crate::tune::white_sigma_with_gaps;

/// Records the stand-in for BP-KF learns from, and their length.
const LEARNING_RECORDS: u64 = 40;
const LEARNING_SAMPLES: usize = 6000;
/// Samples a block of the stand-in's slow statistic.
const SLOW_BLOCK: usize = 200;

/// A method's row.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::{bed::Unit, errors::Errors, table3::Table3Row};
/// // The first row is the sensor itself: its mean squared error is noise, drift and the square of its error.
/// let records = Unit::NOMINAL.published_records(1);
/// let cells = records.iter().map(|(truth, measured)| Errors::of(measured, truth)).collect();
/// let raw = Table3Row { method: "raw".into(), cells };
/// assert!(raw.cells.iter().all(|cell| (0.025..0.030).contains(&cell.mse)));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Table3Row {
    /// Name.
    pub method: String,
    /// One cell a record, in the order of the published rates.
    pub cells: Vec<Errors>,
}

/// The table for one data seed, and the published network's curve (for the staircase).
///
/// `epochs` is the most the network is trained for.
///
/// # Errors
/// A sentence if a training or tuning failed.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::{bed::Unit, table3::table3};
/// let (rows, curve) = table3(&Unit::NOMINAL, 1, 60)?;
/// // On the very records it was trained on the published network beats every other method ...
/// let mean = |row: usize| rows[row].cells.iter().map(|cell| cell.mse).sum::<f64>() / 6.0;
/// assert!(mean(2) < mean(3) && rows[2].method == "published network + QPSO-KF" && rows[3].method == "QPSO-KF");
/// // ... and a rate half-way between two of theirs it does not know.
/// assert!((curve.correct(4.5, [0.0; 2]).rate - 4.5).abs() > 0.1);
/// # Ok::<(), String>(())
/// ```
pub fn table3(unit: &Unit, seed: u64, epochs: usize) -> Result<(Vec<Table3Row>, ErrorCurve<f64>), String> {
    let records = unit.published_records(seed);
    let curve = published::train_on(&records, &Training { epochs, ..Training::published(seed) })?;
    let network: Vec<Pair> = records.iter().map(|(w, y)| (w.clone(), subtract(&curve, y))).collect();
    let swarm =
        |pairs: &[Pair]| pairs.iter().map(|pair| published_search(pair, seed)).collect::<Result<Vec<f64>, String>>();
    let bp = BpKf::trained(unit, seed)?;
    let rows = vec![
        row("raw", &records, |_, y| y.to_vec()),
        row("published network", &network, |_, y| y.to_vec()),
        {
            let q = swarm(&network)?;
            row("published network + QPSO-KF", &network, |k, y| track(Walk::RandomWalk, q[k], PERIOD_S, y))
        },
        {
            let q = swarm(&records)?;
            row("QPSO-KF", &records, |k, y| track(Walk::RandomWalk, q[k], PERIOD_S, y))
        },
        row("BP-KF (stand-in)", &records, |_, y| track(Walk::RandomWalk, bp.log10_ratio(y), PERIOD_S, y)),
    ];
    Ok((rows, curve))
}

/// The published search on one record: log10(Q/R) of the best particle. The stop rule is off, because the initial swarm already meets it
/// on compensated records and Q, R would be its draws.
fn published_search((truth, measured): &Pair, seed: u64) -> Result<f64, String> {
    let records = [Record { measured, truth: Some(truth) }];
    let method = Method::Qpso(Qpso { seed, target: f64::NEG_INFINITY, ..Qpso::default() });
    let (walk, criterion) = (Walk::RandomWalk, Criterion::Truth);
    let objective = GainRatio { records: &records, walk, criterion, period_s: PERIOD_S };
    let tuned = objective.tune(&method, true, &mut |_| true).map_err(|error| error.to_string())?;
    Ok(tuned.log10_ratio)
}

fn row(method: &str, pairs: &[Pair], run: impl Fn(usize, &[f64]) -> Vec<f64>) -> Table3Row {
    let cells = pairs.iter().enumerate().map(|(k, (w, y))| Errors::of(&run(k, y), w)).collect();
    Table3Row { method: method.to_owned(), cells }
}

/// The stand-in for BP-KF.
struct BpKf {
    network: Network,
    scaling: Scaling,
}

impl BpKf {
    fn trained(unit: &Unit, seed: u64) -> Result<Self, String> {
        let mut rows = Vec::new();
        let mut targets = Vec::new();
        for k in 0..LEARNING_RECORDS {
            let mut random = Random::new(seed, 5000 + k);
            let truth = vec![random.normal() * 3.0; LEARNING_SAMPLES];
            // Noise and drift vary from record to record, otherwise there is nothing to learn.
            let mut varied = *unit;
            varied.white_dps *= (0.5 * random.normal()).exponential();
            varied.drift_dps *= (0.5 * random.normal()).exponential();
            let measured = varied.measure(&truth, SAMPLE_RATE_HZ, &mut random);
            rows.extend(statistics(&measured));
            let pair = [(truth, measured)];
            targets.push(tune_on(&pair, Walk::RandomWalk, Criterion::Truth)?.log10_ratio);
        }
        let scaling = Scaling::spanning(&rows, 2, &targets);
        let shape = Shape { inputs: 2, hidden: 3, linear: false };
        let training = Training { shape, decay: 1e-3, epochs: 200, patience: 0, seed };
        let trained = training::fit(&training, &scaling.inward(&rows), &scaling.target_inward(&targets), &[])?;
        Ok(Self { network: trained.network, scaling })
    }

    fn log10_ratio(&self, measured: &[f64]) -> f64 {
        self.scaling.outward(self.network.output(&self.scaling.inward(&statistics(measured))))
    }
}

/// log10 of the white noise and of the spread of slow averages.
fn statistics(measured: &[f64]) -> [f64; 2] {
    let log10 = |x: f64| x.most(1e-12).logarithm() / LN_10;
    let means: Vec<f64> = measured.chunks_exact(SLOW_BLOCK).map(|b| b.iter().sum::<f64>() / b.len() as f64).collect();
    let centre = means.iter().sum::<f64>() / means.len() as f64;
    let square = means.iter().map(|m| (m - centre) * (m - centre)).sum::<f64>() / means.len() as f64;
    [log10(white_sigma_with_gaps(measured)), log10(square.root())]
}
