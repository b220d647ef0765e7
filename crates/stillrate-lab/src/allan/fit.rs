//! Noise figures from an Allan curve: the white density N, the flicker floor B and the rate random walk K, from
//! adev^2 = N^2 / tau + (2 ln 2 / pi) B^2 + K^2 tau / 3 (IEEE Std 952-2020, annex C).
//!
//! Weighted least squares on the variances, which are unbiased, with no figure below zero. Weights follow the fitted
//! curve, not the measured one (a point that happens to lie low would else pull), and a floor on the relative error
//! of every point keeps the well-measured short end from dictating a curve it only nearly follows. Intervals come from
//! the covariance of all points under the fitted noise, through the same linear map as the figures.
//!
//! Flicker does not go on to any frequency, and where white noise hides it no record tells where it ends. The fit
//! takes the mean over ends from none to where white noise takes over, and adds their scatter to weights and intervals.

use nalgebra::{Matrix3, Vector3};
use stillrate::Real;

use super::deviation::Point;
use super::freedom::{Mixture, Quadratic, covariance, expected, freedom, unit_variances};
use super::interval::interval;

/// Relative error of a variance that no point is believed to be below, however long the record.
const MODEL_ERROR: f64 = 0.002;
/// Degrees of freedom from which a point is trusted to show that the record is something else.
const WELL_MEASURED: f64 = 30.0;
/// Flicker may end within so many samples even where no white noise hides it: sampling alone changes it there.
const SAMPLED: f64 = 4.0;
/// An end less than so many times shorter than where white noise takes over would show in the points.
const CLEAR_OF: f64 = 8.0;
/// Rounds of weighting by the fitted curve.
const ROUNDS: usize = 20;

/// The points and, for each pair, the covariance of their variances.
struct Curve<'a> {
    points: &'a [Point],
    /// Row by row, the lower triangle.
    covariance: Vec<Vec<Quadratic>>,
}

/// Squared strengths per sample with the interval of each.
pub(crate) struct Fit {
    pub(crate) mixture: Mixture,
    pub(crate) low: Mixture,
    pub(crate) high: Mixture,
}

/// The ways in which flicker may end towards short times, each as likely: what is left of it at each point.
struct Ends {
    left: Vec<Vec<f64>>,
    mean: Vec<f64>,
}

impl Ends {
    /// Flicker without an end, and with ends an octave apart up to where white noise hides it under a mixture.
    fn of(points: &[Point], [white, flicker, _]: &Mixture) -> Self {
        let [unit_white, unit_flicker, _] = unit_variances(1);
        let hidden = if *flicker > 0.0 { white * unit_white / (flicker * unit_flicker) } else { 0.0 };
        let longest = points.last().map_or(1.0, |p| p.cluster as f64);
        let (mut left, mut end) = (vec![vec![1.0; points.len()]], 1.0);
        while end <= (hidden / CLEAR_OF).clamp(SAMPLED, longest.max(SAMPLED)) {
            // A sum of Gauss-Markov processes that begins at time T has m / (m + T) of the floor, within .07 of it.
            left.push(points.iter().map(|p| p.cluster as f64 / (p.cluster as f64 + end)).collect());
            end *= 2.0;
        }
        let mean = |i: usize| left.iter().map(|one| one[i]).sum::<f64>() / left.len() as f64;
        let mean = (0..points.len()).map(mean).collect();
        Self { left, mean }
    }

    /// Mean square over the ends of `f` of what each leaves beyond their mean.
    fn mean_square(&self, f: impl Fn(&dyn Fn(usize) -> f64) -> f64) -> f64 {
        let one = |left: &Vec<f64>| {
            let found = f(&|i| left[i] - self.mean[i]);
            found * found
        };
        self.left.iter().map(one).sum::<f64>() / self.left.len() as f64
    }

    /// Row of the design: what unit strengths add at point `i`.
    fn design(&self, points: &[Point], i: usize) -> Vector3<f64> {
        let [white, flicker, walk] = unit_variances(points[i].cluster);
        Vector3::new(white * points[i].thinning, flicker * self.mean[i], walk)
    }
}

/// Least squares restricted to the components in `subset`; `None` if they cannot be told apart or one is negative.
fn solve_subset(normal: &Matrix3<f64>, right: &Vector3<f64>, subset: u8) -> Option<Vector3<f64>> {
    // Scaled to a unit diagonal: strengths differ by ten powers of ten.
    let scale = Vector3::from_fn(|i, _| if normal[(i, i)] > 0.0 { 1.0 / normal[(i, i)].root() } else { 0.0 });
    let used = |i: usize| subset & (1 << i) != 0;
    let matrix = Matrix3::from_fn(|i, j| match (used(i) && used(j), i == j) {
        (true, _) => normal[(i, j)] * scale[i] * scale[j],
        (false, true) => 1.0,
        (false, false) => 0.0,
    });
    let vector = Vector3::from_fn(|i, _| if used(i) { right[i] * scale[i] } else { 0.0 });
    let solution = matrix.lu().solve(&vector)?.component_mul(&scale);
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}

/// The non-negative least-squares solution: the best of the seven ways to leave components out.
fn non_negative(normal: &Matrix3<f64>, right: &Vector3<f64>) -> Vector3<f64> {
    // Squared error less its constant part.
    let cost = |x: &Vector3<f64>| (x.transpose() * normal * x)[0] - 2.0 * right.dot(x);
    (1..8)
        .filter_map(|subset| solve_subset(normal, right, subset))
        .filter(|x| x.iter().all(|value| *value >= 0.0))
        .min_by(|a, b| cost(a).total_cmp(&cost(b)))
        .unwrap_or_else(Vector3::zeros)
}

impl Curve<'_> {
    fn new(points: &[Point]) -> Curve<'_> {
        let row = |i: usize| (0..=i).map(|j| covariance(&points[i], &points[j])).collect();
        Curve { points, covariance: (0..points.len()).map(row).collect() }
    }

    /// Degrees of freedom of point `i`.
    fn freedom(&self, mixture: &Mixture, i: usize) -> f64 {
        freedom(mixture, &self.points[i], &self.covariance[i][i])
    }

    /// Weights 1 / variance under a mixture.
    fn weights(&self, mixture: &Mixture, ends: &Ends, model_error: f64) -> Vec<f64> {
        let of = |i: usize| {
            let model = expected(mixture, self.points[i].cluster);
            let [_, flicker, _] = unit_variances(self.points[i].cluster);
            let ended = ends.mean_square(|left| left(i)) * (mixture[1] * flicker / model).powi(2);
            let relative = 2.0 / self.freedom(mixture, i) + model_error * model_error + ended;
            if model > 0.0 { 1.0 / (model * model * relative) } else { 0.0 }
        };
        (0..self.points.len()).map(of).collect()
    }

    /// Weights before anything is known: the measured variances, as uncertain as those of a random walk.
    fn first_weights(&self, model_error: f64) -> Vec<f64> {
        let of = |i: usize| {
            let variance = self.points[i].variance;
            let relative = 2.0 / self.freedom(&[0.0, 0.0, 1.0], i) + model_error * model_error;
            if variance > 0.0 { 1.0 / (variance * variance * relative) } else { 0.0 }
        };
        (0..self.points.len()).map(of).collect()
    }

    fn solve(&self, weight: Vec<f64>, ends: Ends) -> Solution {
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (i, (p, w)) in self.points.iter().zip(&weight).enumerate() {
            let a = ends.design(self.points, i);
            normal += a * a.transpose() * *w;
            right += a * (w * p.variance);
        }
        let best = non_negative(&normal, &right);
        Solution { mixture: [best[0], best[1], best[2]], weight, ends, normal, right }
    }

    /// Weighted least squares, reweighted by its own curve until it settles.
    fn reweighted(&self, model_error: f64) -> Solution {
        let mut solution = self.solve(self.first_weights(model_error), Ends::of(self.points, &[0.0; 3]));
        for _ in 0..ROUNDS {
            let ends = Ends::of(self.points, &solution.mixture);
            let next = self.solve(self.weights(&solution.mixture, &ends, model_error), ends);
            let settled = next.mixture == solution.mixture;
            solution = next;
            if settled {
                break;
            }
        }
        solution
    }

    /// How far the well-measured points lie off the curve beyond three standard errors, relative, at worst.
    fn misfit(&self, solution: &Solution) -> f64 {
        let strengths = Vector3::from(solution.mixture);
        let off = |i: usize| {
            let (model, freedom) =
                (solution.ends.design(self.points, i).dot(&strengths), self.freedom(&solution.mixture, i));
            let known = freedom > WELL_MEASURED && model > 0.0;
            let apart = (self.points[i].variance / model - 1.0).magnitude();
            // An end of the flicker that explains it is no misfit.
            let [_, flicker, _] = unit_variances(self.points[i].cluster);
            let ended = solution.ends.mean_square(|left| left(i) * flicker * strengths[1] / model);
            if known { (apart - 3.0 * (2.0 / freedom + ended).root()).max(0.0) } else { 0.0 }
        };
        (0..self.points.len()).map(off).fold(0.0, f64::max)
    }

    /// Variance of each freely fitted strength, as a form in the strengths: the fit's linear map applied to the points.
    fn spread(&self, solution: &Solution) -> [Quadratic; 3] {
        let map = solution.map(self.points);
        let mut sum = [Quadratic::default(); 3];
        for i in 0..self.points.len() {
            for j in 0..=i {
                let twice = if i == j { 1.0 } else { 2.0 };
                for component in 0..3 {
                    let scale = twice * map[i][component] * map[j][component];
                    sum[component].add(scale, &self.covariance[i][j]);
                }
            }
        }
        sum
    }

    /// Mean square of what each strength moves by with the end of the flicker.
    fn ended(&self, solution: &Solution) -> [f64; 3] {
        let map = solution.map(self.points);
        let [_, flicker, _] = unit_variances(1);
        let hidden = flicker * solution.mixture[1];
        [0, 1, 2].map(|k| solution.ends.mean_square(|left| (0..map.len()).map(|i| map[i][k] * hidden * left(i)).sum()))
    }
}

/// A weighted fit and the equations it came from.
struct Solution {
    mixture: Mixture,
    weight: Vec<f64>,
    ends: Ends,
    normal: Matrix3<f64>,
    right: Vector3<f64>,
}

impl Solution {
    /// What each point's variance contributes to each freely fitted strength.
    fn map(&self, points: &[Point]) -> Vec<Vector3<f64>> {
        let unit = |i: usize| Vector3::from_fn(|j, _| f64::from(u8::from(i == j)));
        let columns = [0, 1, 2].map(|i| solve_subset(&self.normal, &unit(i), 7).unwrap_or_else(Vector3::zeros));
        // The normal matrix is symmetric, so a column of its inverse is also a row.
        let row = |i: usize| {
            let design = self.ends.design(points, i);
            Vector3::from_fn(|k, _| columns[k].dot(&design) * self.weight[i])
        };
        (0..points.len()).map(row).collect()
    }

    /// The strengths where component `i` is held at `x`, none below zero.
    fn with(&self, i: usize, x: f64) -> Mixture {
        let right = self.right - self.normal.column(i) * x;
        let others = solve_subset(&self.normal, &right, 7 & !(1 << i)).unwrap_or_else(|| Vector3::from(self.mixture));
        core::array::from_fn(|k| if k == i { x } else { others[k].max(0.0) })
    }

    /// The strengths without the bound at zero.
    fn free(&self) -> Vector3<f64> {
        solve_subset(&self.normal, &self.right, 7).unwrap_or_else(|| Vector3::from(self.mixture))
    }
}

/// Fits the three strengths to the points; `confidence` is the probability inside each interval.
pub(crate) fn fit(points: &[Point], confidence: f64) -> Fit {
    let curve = Curve::new(points);
    let mut solution = curve.reweighted(MODEL_ERROR);
    // A record that does not follow the three slopes is fitted as a whole, not at its best-measured end.
    let model_error = curve.misfit(&solution).min(1.0);
    if model_error > MODEL_ERROR {
        solution = curve.reweighted(model_error);
    }
    let (spread, free) = (curve.spread(&solution), solution.free());
    let ended = curve.ended(&solution);
    let mut result = Fit { mixture: solution.mixture, low: [0.0; 3], high: [0.0; 3] };
    for i in 0..3 {
        let off = model_error * solution.mixture[i];
        // Under another strength of this component the others would have been fitted otherwise.
        let form = |x: f64| {
            let [a, b, c] = spread[i].in_component(i, &solution.with(i, x));
            [a + ended[i] + off * off, b, c]
        };
        let (low, high) = interval(free[i], form, confidence);
        (result.low[i], result.high[i]) = (low.min(solution.mixture[i]), high.max(solution.mixture[i]));
    }
    result
}
