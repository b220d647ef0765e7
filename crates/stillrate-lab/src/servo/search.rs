//! Differential evolution with constraints, the same numbers for any number of threads.
//!
//! L-SHADE (Tanabe and Fukunaga, Improving the search performance of SHADE using linear population size reduction, 2014):
//! current-to-pbest/1 with an archive of beaten parents, scale F and crossover CR drawn around a memory of what succeeded, a population that
//! shrinks linearly from 40 to 6. Deb's rules for constraints (2000): a feasible point beats an infeasible one, two
//! infeasible ones compare by violation, two feasible ones by value; successes count equally, because values and
//! violations have no common weight. Every trial is evaluated against its own parent, so an evaluation may stop as soon as it cannot win.
//! Libraries' optimisers draw on the platform's random numbers and libm, which this project's results may not depend on.

use core::cmp::Ordering;
use core::f64::consts::PI;

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
            (value.most(self.low) / self.low).logarithm() / (self.high / self.low).logarithm()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        unit.limited(0.0, 1.0)
    }
}

/// How hard to search: one number, the same for everything that is to be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Evaluations in total.
    pub evaluations: usize,
    /// Independent restarts that share them.
    pub restarts: usize,
    /// Seed of the search.
    pub seed: u64,
}

/// A point and its score.
pub type Scored = (Vec<f64>, Score);

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// For every restart the points that beat their parent, best first. The spread of the first says how far to trust the search.
    pub restarts: Vec<Vec<Scored>>,
}

/// Points of the first generation, of the last, and what a run of few evaluations begins with.
const FIRST: usize = 40;
const LAST: usize = 6;
const FEWEST: usize = 4;
/// Length of the memory of F and CR, and what it starts with.
const MEMORY: usize = 6;
const FIRST_SCALE: f64 = 0.5;
const FIRST_CROSSOVER: f64 = 0.8;
/// Width of the draws around the memory.
const WIDTH: f64 = 0.1;
/// Share of the population that counts as best.
const BEST: f64 = 0.15;

/// Minimises `evaluate(point, score to beat)` from a Latin hypercube and `starts`.
///
/// `progress(evaluations)` is called after every generation and may stop the search by returning false.
///
/// # Example
/// ```
/// use stillrate_lab::servo::search::{Effort, Range, Score, minimise};
/// let range = Range { low: -2.0, high: 2.0, logarithmic: false };
/// let bowl = |x: &[f64], _: Score| Score { violation: (0.5 - x[0]).max(0.0), value: x[0] * x[0] + x[1] * x[1] };
/// let effort = Effort { evaluations: 1200, restarts: 1, seed: 1 };
/// let (point, _) = &minimise(&[range; 2], &[], effort, bowl, &mut |_| true).restarts[0][0];
/// assert!((point[0] - 0.5).abs() < 1e-3 && point[1].abs() < 0.05);
/// ```
pub fn minimise(
    ranges: &[Range],
    starts: &[Vec<f64>],
    effort: Effort,
    evaluate: impl Fn(&[f64], Score) -> Score + Sync,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Found {
    let values = |units: &[f64]| ranges.iter().zip(units).map(|(r, u)| r.value(*u)).collect::<Vec<f64>>();
    // What is not a number has no rank.
    let evaluate = |units: &[f64], best: Score| {
        let score = evaluate(&values(units), best);
        if score.violation.is_nan() || score.value.is_nan() { Score::WORST } else { score }
    };
    let each = effort.evaluations / effort.restarts.max(1);
    let first = FIRST.min(each / 5).max(FEWEST);
    let mut restarts = Vec::new();
    for restart in 0..effort.restarts {
        let mut random = Random::new(effort.seed, restart as u64);
        let points = first_generation(ranges, starts, first, &mut random);
        let scores: Vec<Score> = points.par_iter().map(|p| evaluate(p, Score::WORST)).collect();
        let mut swarm = Swarm::new(points.into_iter().zip(scores).collect());
        let mut done = first;
        let mut ranked: Vec<Scored> = swarm.points.iter().map(|(p, s)| (values(p), *s)).collect();
        let mut more = progress(restart * each + done);
        while more && done < each {
            let trials = swarm.trials(each - done, &mut random);
            let scored: Vec<Score> =
                trials.par_iter().zip(&swarm.points).map(|(t, (_, parent))| evaluate(&t.point, *parent)).collect();
            done += trials.len();
            swarm.select(trials, &scored, |p, s| ranked.push((values(p), s)));
            let left = (each - done) as f64 / each as f64;
            swarm.shrink((LAST as f64 + left * (first as f64 - LAST as f64) + 0.5) as usize, &mut random);
            more = progress(restart * each + done);
        }
        ranked.sort_by(order);
        restarts.push(ranked);
        if !more {
            break;
        }
    }
    Found { restarts }
}

fn order(a: &Scored, b: &Scored) -> Ordering {
    if a.1.beats(b.1) {
        Ordering::Less
    } else if b.1.beats(a.1) {
        Ordering::Greater
    } else {
        Ordering::Equal
    }
}

/// A Latin hypercube, its first points replaced by the starts.
fn first_generation(ranges: &[Range], starts: &[Vec<f64>], count: usize, random: &mut Random) -> Vec<Vec<f64>> {
    let mut points = vec![vec![0.0; ranges.len()]; count];
    for d in 0..ranges.len() {
        let mut rows: Vec<usize> = (0..count).collect();
        for i in (1..count).rev() {
            rows.swap(i, random.below(i as u64 + 1) as usize);
        }
        for (point, row) in points.iter_mut().zip(rows) {
            point[d] = (row as f64 + random.uniform()) / count as f64;
        }
    }
    for (point, start) in points.iter_mut().zip(starts) {
        *point = ranges.iter().zip(start).map(|(r, v)| r.unit(*v)).collect();
    }
    points
}

/// A child with the scale and crossover it was made with.
struct Child {
    point: Vec<f64>,
    scale: f64,
    crossover: f64,
}

/// A population, best first, in units of its box.
struct Swarm {
    points: Vec<Scored>,
    beaten: Vec<Vec<f64>>,
    scales: [f64; MEMORY],
    crossovers: [f64; MEMORY],
    slot: usize,
}

impl Swarm {
    fn new(mut points: Vec<Scored>) -> Self {
        points.sort_by(order);
        Self {
            points,
            beaten: Vec::new(),
            scales: [FIRST_SCALE; MEMORY],
            crossovers: [FIRST_CROSSOVER; MEMORY],
            slot: 0,
        }
    }

    /// One child a point, at most `most` of them.
    fn trials(&self, most: usize, random: &mut Random) -> Vec<Child> {
        let leaders = ((BEST * self.points.len() as f64).ceil() as u64).max(2);
        (0..self.points.len().min(most)).map(|parent| self.child(parent, leaders, random)).collect()
    }

    /// Parent, pulled towards one of the leaders and along a difference; halfway to the wall where it would leave the box.
    fn child(&self, parent: usize, leaders: u64, random: &mut Random) -> Child {
        let memory = random.below(MEMORY as u64) as usize;
        let crossover = (self.crossovers[memory] + WIDTH * random.normal()).limited(0.0, 1.0);
        let scale = cauchy(self.scales[memory], random);
        let leader = &self.points[random.below(leaders) as usize].0;
        let count = self.points.len();
        let mut pick = |among: usize, taken: [usize; 2]| loop {
            let found = random.below(among as u64) as usize;
            if !taken.contains(&found) {
                break found;
            }
        };
        let a = pick(count, [parent; 2]);
        let b = pick(count + self.beaten.len(), [parent, a]);
        let (from, to) = (self.points.get(b).map_or_else(|| &self.beaten[b - count], |(p, _)| p), &self.points[a].0);
        let x = &self.points[parent].0;
        let certain = random.below(x.len().max(1) as u64) as usize;
        let point = (0..x.len())
            .map(|d| {
                let moved = x[d] + scale * (leader[d] - x[d]) + scale * (to[d] - from[d]);
                let inside = if moved < 0.0 {
                    0.5 * x[d]
                } else if moved > 1.0 {
                    0.5 * (1.0 + x[d])
                } else {
                    moved
                };
                if random.uniform() < crossover || d == certain { inside } else { x[d] }
            })
            .collect();
        Child { point, scale, crossover }
    }

    /// Children that beat their parents replace them, and what made them is remembered.
    fn select(&mut self, trials: Vec<Child>, scores: &[Score], mut won: impl FnMut(&[f64], Score)) {
        let (mut scale, mut crossover) = ([0.0; 2], [0.0; 2]);
        for ((child, score), parent) in trials.into_iter().zip(scores).zip(&mut self.points) {
            if score.beats(parent.1) {
                won(&child.point, *score);
                for (sums, x) in [(&mut scale, child.scale), (&mut crossover, child.crossover)] {
                    sums[0] += x;
                    sums[1] += x * x;
                }
                self.beaten.push(core::mem::replace(parent, (child.point, *score)).0);
            }
        }
        if scale[0] > 0.0 {
            // Lehmer means: they favour large steps.
            self.scales[self.slot] = scale[1] / scale[0];
            self.crossovers[self.slot] = if crossover[0] > 0.0 { crossover[1] / crossover[0] } else { 0.0 };
            self.slot = (self.slot + 1) % MEMORY;
        }
        self.points.sort_by(order);
    }

    fn shrink(&mut self, size: usize, random: &mut Random) {
        self.points.truncate(size.max(FEWEST));
        while self.beaten.len() > self.points.len() {
            self.beaten.swap_remove(random.below(self.beaten.len() as u64) as usize);
        }
    }
}

/// A Cauchy deviate around `centre`, above 0 and at most 1.
fn cauchy(centre: f64, random: &mut Random) -> f64 {
    loop {
        let (sine, cosine) = (PI * (random.uniform() - 0.5)).sine_cosine();
        let scale = centre + WIDTH * sine / cosine;
        if scale > 0.0 {
            return scale.min(1.0);
        }
    }
}
