//! Objectives over q = Q/R of the small Kalman filters: error against a known truth, or likelihood of the innovations.
//!
//! Truth: mean (x - w)^2 over all samples of all records. Innovations (no truth needed): with R = 1 the estimate of the
//! measurement variance is R^ = mean(v^2/F), and -2 ln L / n = ln R^ + mean(ln F) + 1 up to a constant; Q = q R^.
//! Several records share one q and one R. Candidates run in groups side by side and groups on all threads.

use rayon::prelude::*;
use stillrate::Real;

use crate::tune::candidates::{RandomWalks, RateAccelerations};
use crate::tune::lanes::{self, Candidates, Sums};
use crate::tune::objective::Objective;
use crate::tune::records::Record;

/// Candidates in a group.
const WIDTH: usize = 32;
/// ln 10.
pub(crate) const LN_10: f64 = core::f64::consts::LN_10;

/// The filter whose noise is sought.
///
/// # Example
/// ```
/// use stillrate_lab::tune::gain_ratio::Walk;
/// use stillrate_lab::tune::track::track;
/// let ramp: Vec<f64> = (0..4000).map(|k| 0.01 * f64::from(k)).collect(); // 1 deg/s^2 at 100 Hz
/// let lag = |walk, log10_ratio| ramp[3999] - track(walk, log10_ratio, 0.01, &ramp)[3999];
/// // A random walk lags behind a ramp for ever, by (1 - K)/K samples (gain K = 0.095 here); two states do not.
/// assert!((lag(Walk::RandomWalk, -2.0) - 0.0951).abs() < 1e-4);
/// assert!(lag(Walk::RateAcceleration, 0.0).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Walk {
    /// The rate is a random walk (one state).
    RandomWalk,
    /// The acceleration is a random walk (two states).
    RateAcceleration,
}

/// What is to be made small.
///
/// # Example
/// ```
/// use stillrate_lab::{random::Random, tune::records::Record};
/// use stillrate_lab::tune::gain_ratio::{Criterion, GainRatio, Walk};
/// let mut random = Random::new(3, 0);
/// let truth: Vec<f64> = (0..4000).map(|k| 5.0 * (0.01 * f64::from(k)).sin()).collect();
/// let measured: Vec<f64> = truth.iter().map(|w| w + random.normal()).collect();
/// let records = [Record { measured: &measured, truth: Some(&truth) }];
/// let best = |criterion| {
///     let objective = GainRatio { records: &records, walk: Walk::RandomWalk, criterion, period_s: 0.01 };
///     objective.tune(&Default::default(), false, &mut |_| true).unwrap().log10_ratio
/// };
/// // In motion the innovations alone find nearly what the truth finds.
/// assert!((best(Criterion::Innovation) - best(Criterion::Truth)).abs() < 0.5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Criterion {
    /// Minus twice the logarithm of the innovations' likelihood, a sample.
    Innovation,
    /// Mean squared difference to the true rate.
    Truth,
}

/// The value of one candidate with what came out on the way.
///
/// # Example
/// ```
/// use stillrate_lab::{random::Random, tune::records::Record};
/// use stillrate_lab::tune::gain_ratio::{Criterion, GainRatio, Walk};
/// let measured = Random::new(1, 0).normals(20_000);
/// let records = [Record { measured: &measured, truth: None }];
/// let objective = GainRatio { records: &records, walk: Walk::RandomWalk, criterion: Criterion::Innovation, period_s: 0.01 };
/// let score = objective.scores(&[0.0])[0]; // Q = 0: the running mean
/// assert!((score.measurement_variance - 1.0).abs() < 0.03);
/// assert!((score.innovation - 1.0).abs() < 0.03); // ln 1 + ln 1 + 1
/// assert!(score.mean_square_error.is_nan()); // there is no truth
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// ln R^ + mean ln F + 1.
    pub innovation: f64,
    /// R^: measurement variance that the innovations imply, (deg/s)^2.
    pub measurement_variance: f64,
    /// Mean squared error, (deg/s)^2 (NaN without truth).
    pub mean_square_error: f64,
}

impl Score {
    /// Not valued yet.
    const NONE: Self = Self { innovation: f64::NAN, measurement_variance: f64::NAN, mean_square_error: f64::NAN };
}

/// An objective over log10 q (one dimension), or over log10 Q and log10 R (two).
///
/// # Example
/// ```
/// use stillrate_lab::{random::Random, tune::records::Record};
/// use stillrate_lab::tune::gain_ratio::{Criterion, GainRatio, Walk};
/// use stillrate_lab::tune::minimise::{Method, minimise};
/// let mut random = Random::new(1, 0);
/// let mut rate = 0.0;
/// let measured: Vec<f64> = (0..4000).map(|_| { rate += 0.1 * random.normal(); rate + random.normal() }).collect();
/// let records = [Record { measured: &measured, truth: None }];
/// let mut objective = GainRatio { records: &records, walk: Walk::RandomWalk, criterion: Criterion::Innovation, period_s: 0.01 };
/// let tuned = objective.tune(&Method::default(), false, &mut |_| true)?;
/// assert!((tuned.log10_ratio + 2.0).abs() < 0.2); // Q/R = 0.01
/// // The same by hand, as with an optimiser of one's own.
/// objective.check()?;
/// let (low, high) = objective.range();
/// let best = minimise(&mut objective, &[low], &[high], &Method::default(), &mut |_| true)?;
/// assert_eq!(objective.finish(&best.point, best.value, best.evaluations), tuned);
/// assert!(objective.scores(&[1e-3])[0].innovation > tuned.value);
/// # Ok::<(), stillrate_lab::tune::tuned::TuneError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct GainRatio<'a> {
    /// Records that share the noise.
    pub records: &'a [Record<'a>],
    /// The filter.
    pub walk: Walk,
    /// What is made small.
    pub criterion: Criterion,
    /// Sample period, s.
    pub period_s: f64,
}

impl GainRatio<'_> {
    /// Scores of candidates q = Q/R.
    #[must_use]
    pub fn scores(&self, ratios: &[f64]) -> Vec<Score> {
        if ratios.len() == 1 {
            self.groups::<1>(ratios)
        } else {
            // Neighbours of like q settle together; the value of a candidate does not depend on its neighbours.
            let mut order: Vec<usize> = (0..ratios.len()).collect();
            order.sort_by(|&a, &b| ratios[b].total_cmp(&ratios[a]));
            let sorted: Vec<f64> = order.iter().map(|&k| ratios[k]).collect();
            let mut scores = vec![Score::NONE; ratios.len()];
            let found = self.groups::<WIDTH>(&sorted);
            order.iter().zip(found).for_each(|(&k, score)| scores[k] = score);
            scores
        }
    }

    fn groups<const W: usize>(&self, ratios: &[f64]) -> Vec<Score> {
        let jobs: Vec<(usize, usize)> =
            (0..ratios.len().div_ceil(W)).flat_map(|g| (0..self.records.len()).map(move |r| (g, r))).collect();
        let sums: Vec<Sums<W>> = jobs.par_iter().map(|&(g, r)| self.run::<W>(&ratios[g * W..], r)).collect();
        sums.chunks_exact(self.records.len().max(1))
            .flat_map(|group| (0..W).map(|l| score(group, l)).collect::<Vec<_>>())
            .take(ratios.len())
            .collect()
    }

    fn run<const W: usize>(&self, ratios: &[f64], record: usize) -> Sums<W> {
        // Idle places repeat the first candidate: they settle with it and cost nothing.
        let q = core::array::from_fn(|l| ratios.get(l).copied().unwrap_or(ratios[0]));
        match self.walk {
            Walk::RandomWalk => self.run_as::<RandomWalks<W>, W>(&q, record),
            Walk::RateAcceleration => self.run_as::<RateAccelerations<W>, W>(&q, record),
        }
    }

    fn run_as<M: Candidates<W>, const W: usize>(&self, q: &[f64; W], record: usize) -> Sums<W> {
        let Record { measured, truth } = self.records[record];
        let truth = if self.criterion == Criterion::Truth { truth } else { None };
        lanes::run::<M, W>(q, self.period_s, measured, truth)
    }
}

/// The score of candidate `l` over all records.
fn score<const W: usize>(records: &[Sums<W>], l: usize) -> Score {
    let total = |part: &dyn Fn(&Sums<W>) -> f64| records.iter().map(part).sum::<f64>();
    let count = total(&|s| s.count as f64);
    let variance = total(&|s| s.weighted_square[l]) / count;
    Score {
        innovation: variance.logarithm() + total(&|s| s.log_variance[l]) / count + 1.0,
        measurement_variance: variance,
        mean_square_error: total(&|s| s.square_error[l]) / total(&|s| s.compared as f64),
    }
}

impl Objective for GainRatio<'_> {
    /// One dimension: log10 q. Two: log10 Q and log10 R; with the diffuse start only their difference matters to the truth criterion, and
    /// the innovation criterion is then that of the given R.
    fn values(&mut self, points: &[f64], dimensions: usize) -> Vec<f64> {
        let ratio = |p: &[f64]| (LN_10 * if p.len() == 2 { p[0] - p[1] } else { p[0] }).exponential();
        let ratios: Vec<f64> = points.chunks_exact(dimensions).map(ratio).collect();
        let scores = self.scores(&ratios);
        let value = |(score, p): (&Score, &[f64])| match self.criterion {
            Criterion::Truth => score.mean_square_error,
            Criterion::Innovation if p.len() == 2 => {
                let ln_r = LN_10 * p[1];
                // mean ln(R F) + mean v^2/(R F), from the parts of the concentrated form.
                score.innovation - 1.0 - score.measurement_variance.logarithm()
                    + ln_r
                    + score.measurement_variance * (-ln_r).exponential()
            }
            Criterion::Innovation => score.innovation,
        };
        scores.iter().zip(points.chunks_exact(dimensions)).map(value).collect()
    }
}
