//! Differential evolution with constraints, the same numbers for any number of threads.
//!
//! L-SHADE (Tanabe and Fukunaga, Improving the search performance of SHADE using linear population size reduction, 2014):
//! current-to-pbest/1 with an archive of beaten parents, scale F and crossover CR drawn around a memory of what succeeded, a population that
//! shrinks linearly from 40 to 6. Deb's rules for constraints (2000): a feasible point beats an infeasible one, two
//! infeasible ones compare by violation, two feasible ones by value; successes count equally, because values and
//! violations have no common weight. Every trial is evaluated against its own parent, so an evaluation may stop as soon as it cannot win.
//! Libraries' optimisers draw on the platform's random numbers and libm, which this project's results may not depend on.

use rayon::prelude::*;
use stillrate::Real;

use super::score::{Score, Scored, order};
use super::swarm::{FEWEST, Swarm};
use crate::random::{Generator, Random};

/// Range of one coordinate.
///
/// # Example
/// ```
/// use stillrate_lab::servo::search::Range;
/// let gain = Range { low: 0.01, high: 100.0, logarithmic: true };
/// assert!((gain.value(0.5) - 1.0).abs() < 1e-12); // halfway is the geometric mean
/// assert!((gain.unit(10.0) - 0.75).abs() < 1e-12);
/// assert_eq!(gain.unit(1e-9), 0.0); // what lies outside is drawn to the edge
/// ```
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

/// How hard to search: the same for everything that is to be compared.
///
/// # Example
/// ```
/// use stillrate_lab::servo::bench::Bench;
/// use stillrate_lab::servo::family::standard;
/// use stillrate_lab::servo::search::Effort;
/// use stillrate_lab::servo::tuner::{Task, tune};
/// let bench = Bench::paper(50.0);
/// let effort = Effort { evaluations: 8, restarts: 2, seed: 5 };
/// let task = Task { budget_percent: 0.2, effort, seeds: vec![1], checks: vec![], starts: vec![] };
/// let mut seen = Vec::new();
/// let none = &standard(50.0, bench.noise)[0];
/// tune(&bench, none, &task, &mut |done| { seen.push(done); true }).unwrap();
/// assert_eq!(seen, [4, 8]); // the restarts share the evaluations
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Evaluations in total.
    pub evaluations: usize,
    /// Independent restarts that share them.
    pub restarts: usize,
    /// Seed of the search.
    pub seed: u64,
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Found {
    /// For every restart the points that beat their parent, best first. The spread of the first says how far to trust the search.
    pub(crate) restarts: Vec<Vec<Scored>>,
}

/// Points of the first generation and of the last.
const FIRST: usize = 40;
const LAST: usize = 6;

/// Minimises `evaluate(point, score to beat)` from a Latin hypercube and `starts`.
///
/// `progress(evaluations)` is called after every generation and may stop the search by returning false.
pub(crate) fn minimise(
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_ends_on_the_constraint_that_holds_it_back() {
        let range = Range { low: -2.0, high: 2.0, logarithmic: false };
        let bowl = |x: &[f64], _: Score| Score { violation: (0.5 - x[0]).max(0.0), value: x[0] * x[0] + x[1] * x[1] };
        let effort = Effort { evaluations: 1200, restarts: 1, seed: 1 };
        let (point, _) = &minimise(&[range; 2], &[], effort, bowl, &mut |_| true).restarts[0][0];
        assert!((point[0] - 0.5).abs() < 1e-3 && point[1].abs() < 0.05, "{point:?}");
    }

    #[test]
    fn a_search_gives_the_same_numbers_on_any_number_of_threads() {
        let bowl = |x: &[f64], _: Score| Score { violation: (0.3 - x[0]).max(0.0), value: x[0] * x[0] + x[1] * x[1] };
        let range = Range { low: -2.0, high: 2.0, logarithmic: false };
        let effort = Effort { evaluations: 500, restarts: 2, seed: 9 };
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| minimise(&[range; 2], &[], effort, bowl, &mut |_| true))
        };
        assert_eq!(on(1), on(3));
    }

    #[test]
    fn a_search_finds_the_lower_of_two_valleys() {
        // A wide valley at x = -1 and a narrow, deeper one at x = 1.5.
        let valleys = |x: &[f64], _: Score| {
            let wide = (x[0] + 1.0).powi(2);
            let narrow = 20.0 * (x[0] - 1.5).powi(2) - 0.5;
            Score { violation: 0.0, value: wide.min(narrow) + x[1..].iter().map(|v| v * v).sum::<f64>() }
        };
        let range = Range { low: -3.0, high: 3.0, logarithmic: false };
        let found =
            minimise(&[range; 4], &[], Effort { evaluations: 4800, restarts: 4, seed: 2 }, valleys, &mut |_| true);
        let best = found.restarts.iter().map(|ranked| ranked[0].1.value).fold(f64::INFINITY, f64::min);
        assert!(best < -0.49, "{best}");
    }

    #[test]
    fn what_is_not_a_number_never_wins() {
        let range = Range { low: 0.0, high: 1.0, logarithmic: false };
        let holes = |x: &[f64], _: Score| Score { violation: 0.0, value: if x[0] < 0.5 { f64::NAN } else { x[0] } };
        let effort = Effort { evaluations: 300, restarts: 1, seed: 3 };
        let found = minimise(&[range], &[], effort, holes, &mut |_| true);
        assert!((found.restarts[0][0].0[0] - 0.5).abs() < 1e-2);
    }
}
