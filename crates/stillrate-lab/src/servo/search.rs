//! Differential evolution with constraints, the same numbers for any number of threads.
//!
//! DE/current-to-best with dithered scale (Storn and Price, Differential Evolution, 1997) and Deb's rules for constraints (2000): a
//! feasible point beats an infeasible one, two infeasible ones compare by violation, two feasible ones by value. A generation is
//! evaluated in parallel, every trial against its own parent, so an evaluation may stop as soon as it cannot win.
//! Libraries' optimisers draw on the platform's random numbers and libm, which this project's results may not depend on.

use rayon::prelude::*;
use stillrate::Real;

use crate::random::{Generator, Random};

/// How good a point is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Sum of constraint violations, 0 for a feasible point.
    pub violation: f64,
    /// Value to minimise.
    pub value: f64,
}

impl Score {
    /// Worse than anything.
    pub const WORST: Self = Self { violation: f64::INFINITY, value: f64::INFINITY };

    /// Deb's comparison; NaN never wins.
    #[must_use]
    pub fn beats(self, other: Self) -> bool {
        if self.violation != other.violation {
            return self.violation < other.violation;
        }
        self.value < other.value
    }
}

/// Range of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Whether the search moves in the logarithm (then `low` > 0).
    pub logarithmic: bool,
}

impl Range {
    /// From 0..1 to the range.
    #[must_use]
    pub fn value(&self, unit: f64) -> f64 {
        if self.logarithmic {
            self.low * (unit * (self.high / self.low).logarithm()).exponential()
        } else {
            self.low + unit * (self.high - self.low)
        }
    }
    /// From the range to 0..1.
    #[must_use]
    pub fn unit(&self, value: f64) -> f64 {
        let unit = if self.logarithmic {
            (value / self.low).logarithm() / (self.high / self.low).logarithm()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        unit.limited(0.0, 1.0)
    }
}

/// How hard to search; the same for everything that is to be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Points in a generation.
    pub population: usize,
    /// Generations after the first.
    pub generations: usize,
    /// Independent restarts.
    pub restarts: usize,
    /// Seed of the search.
    pub seed: u64,
}

impl Effort {
    /// Evaluations in total.
    #[must_use]
    pub fn evaluations(&self) -> usize {
        self.restarts * self.population * (self.generations + 1)
    }
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The best point.
    pub point: Vec<f64>,
    /// Its score.
    pub score: Score,
    /// Best score of every restart: their spread says how far to trust the search.
    pub restarts: Vec<Score>,
}

/// Minimises `evaluate(point, score to beat)`, starting among random points and `starts`.
///
/// `progress(evaluations)` is called after every generation and may stop the search by returning false.
///
/// # Example
/// ```
/// use stillrate_lab::servo::search::{Effort, Range, Score, minimise};
/// let range = Range { low: -2.0, high: 2.0, logarithmic: false };
/// let bowl = |x: &[f64], _: Score| Score { violation: (0.5 - x[0]).max(0.0), value: x[0] * x[0] + x[1] * x[1] };
/// let effort = Effort { population: 20, generations: 60, restarts: 1, seed: 1 };
/// let found = minimise(&[range; 2], &[], effort, bowl, &mut |_| true);
/// assert!((found.point[0] - 0.5).abs() < 1e-3 && found.point[1].abs() < 0.05);
/// ```
pub fn minimise(
    ranges: &[Range],
    starts: &[Vec<f64>],
    effort: Effort,
    evaluate: impl Fn(&[f64], Score) -> Score + Sync,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Found {
    let values = |units: &[f64]| ranges.iter().zip(units).map(|(r, u)| r.value(*u)).collect::<Vec<f64>>();
    let mut best: (Vec<f64>, Score) = (vec![0.5; ranges.len()], Score::WORST);
    let mut restarts = Vec::new();
    let mut done = 0;
    'restarts: for restart in 0..effort.restarts {
        let mut random = Random::new(effort.seed, restart as u64);
        let mut points = first_generation(ranges, starts, effort.population, &mut random);
        let mut scores: Vec<Score> = points.par_iter().map(|p| evaluate(&values(p), Score::WORST)).collect();
        done += effort.population;
        for generation in 0..=effort.generations {
            let leader = leader_of(&scores);
            if scores[leader].beats(best.1) {
                best = (points[leader].clone(), scores[leader]);
            }
            if !progress(done) {
                restarts.push(scores[leader]);
                break 'restarts;
            }
            if generation == effort.generations {
                restarts.push(scores[leader]);
                break;
            }
            let trials: Vec<Vec<f64>> = (0..points.len()).map(|i| trial(&points, i, leader, &mut random)).collect();
            let results: Vec<Score> =
                trials.par_iter().zip(&scores).map(|(t, parent)| evaluate(&values(t), *parent)).collect();
            done += effort.population;
            for (i, (t, score)) in trials.into_iter().zip(results).enumerate() {
                if score.beats(scores[i]) {
                    (points[i], scores[i]) = (t, score);
                }
            }
        }
    }
    Found { point: values(&best.0), score: best.1, restarts }
}

fn first_generation(ranges: &[Range], starts: &[Vec<f64>], count: usize, random: &mut Random) -> Vec<Vec<f64>> {
    let mut points: Vec<Vec<f64>> =
        starts.iter().take(count).map(|start| ranges.iter().zip(start).map(|(r, v)| r.unit(*v)).collect()).collect();
    while points.len() < count {
        points.push(ranges.iter().map(|_| random.uniform()).collect());
    }
    points
}

fn leader_of(scores: &[Score]) -> usize {
    (0..scores.len()).fold(0, |best, i| if scores[i].beats(scores[best]) { i } else { best })
}

/// Parent, pulled towards the leader and along a random difference; bounced back into the box.
fn trial(points: &[Vec<f64>], parent: usize, leader: usize, random: &mut Random) -> Vec<f64> {
    let n = points.len() as u64;
    let (a, b, c) = (random.below(n) as usize, random.below(n) as usize, random.below(n) as usize);
    let scale = 0.3 + 0.6 * random.uniform();
    let pull = random.uniform() < 0.5;
    let dimensions = points[parent].len();
    let certain = random.below(dimensions.max(1) as u64) as usize;
    (0..dimensions)
        .map(|d| {
            let (from, towards) = if pull {
                (points[parent][d], scale * (points[leader][d] - points[parent][d]))
            } else {
                (points[c][d], 0.0)
            };
            let moved = from + towards + scale * (points[a][d] - points[b][d]);
            let keep = random.uniform() > 0.9 && d != certain;
            let bounced = if moved < 0.0 {
                -moved
            } else if moved > 1.0 {
                2.0 - moved
            } else {
                moved
            };
            if keep { points[parent][d] } else { bounced.limited(0.0, 1.0) }
        })
        .collect()
}
