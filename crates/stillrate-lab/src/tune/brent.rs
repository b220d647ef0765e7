//! Minimum of a function of one variable: an even grid to find the right valley, then Brent's search inside it.
//!
//! R. P. Brent, "Algorithms for Minimization without Derivatives" (1973), chapter 5: parabolas through the three best points where
//! they shrink the bracket fast enough, golden sections where they do not. The bracket is the pair of grid points
//! beside the best one. The objective over log10(Q/R) may be flat or have a second valley towards the ends; the grid is the guard against both.

use crate::tune::objective::{MinimiseError, Minimum, Objective, Progress, check_bounds, lowest, value_all};

/// (3 - sqrt 5) / 2: the golden section.
const GOLDEN: f64 = 0.381_966_011_250_105_1;
/// Distances below this fraction of the position cannot be told apart in the objective (square root of the precision).
const ROUNDING: f64 = 1.5e-8;

/// Settings of the search.
///
/// # Example
/// ```
/// use stillrate_lab::tune::brent::Brent;
/// use stillrate_lab::tune::minimise::{Method, minimise};
/// let mut f = |p: &[f64]| (p[0] - 1.25) * (p[0] - 1.25);
/// let best = minimise(&mut f, &[-12.0], &[4.0], &Method::Brent(Brent::default()), &mut |_| true)?;
/// assert!((best.point[0] - 1.25).abs() < 1e-3);
/// # Ok::<(), stillrate_lab::tune::objective::MinimiseError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brent {
    /// Points of the grid, at least 3.
    pub grid: usize,
    /// Stop when the bracket is this narrow.
    pub tolerance: f64,
    /// Most evaluations after the grid.
    pub iterations: usize,
}

impl Default for Brent {
    /// 13 grid points, 1e-3 (a thousandth of a decade in noise tuning), 60 evaluations.
    fn default() -> Self {
        Self { grid: 13, tolerance: 1e-3, iterations: 60 }
    }
}

impl Brent {
    pub(crate) fn minimise(
        &self,
        objective: &mut dyn Objective,
        lower: &[f64],
        upper: &[f64],
        progress: &mut dyn FnMut(&Progress) -> bool,
    ) -> Result<Minimum, MinimiseError> {
        check_bounds(lower, upper)?;
        let (&[low], &[high]) = (lower, upper) else {
            let text = format!("{} dimensions (must be 1 for brent; use qpso or de)", lower.len());
            return Err(MinimiseError::Setting(text));
        };
        if self.grid < 3 || !(self.tolerance.is_finite() && self.tolerance > 0.0) {
            let text = format!("grid = {}, tolerance = {} (must be >= 3 and > 0)", self.grid, self.tolerance);
            return Err(MinimiseError::Setting(text));
        }
        let step = (high - low) / (self.grid - 1) as f64;
        let points: Vec<f64> = (0..self.grid).map(|k| low + step * k as f64).collect();
        let values = value_all(objective, &points, 1)?;
        let (best, value) = lowest(&values).ok_or(MinimiseError::NothingFinite { evaluations: self.grid })?;
        if !progress(&Progress { iteration: 0, evaluations: self.grid, value }) {
            return Err(MinimiseError::Stopped);
        }
        let bracket = (points[best.saturating_sub(1)], points[(best + 1).min(self.grid - 1)]);
        self.search(objective, bracket, (points[best], value), progress)
    }

    /// Brent's search inside a bracket, started at a point of known value.
    fn search(
        &self,
        objective: &mut dyn Objective,
        (mut a, mut b): (f64, f64),
        (start, start_value): (f64, f64),
        progress: &mut dyn FnMut(&Progress) -> bool,
    ) -> Result<Minimum, MinimiseError> {
        // x: best so far, w: second best, v: the former w.
        let (mut x, mut w, mut v) = (start, start, start);
        let (mut fx, mut fw, mut fv) = (start_value, start_value, start_value);
        let (mut step, mut before) = (0.0_f64, 0.0_f64);
        let mut evaluations = self.grid;
        for iteration in 1..=self.iterations {
            let middle = 0.5 * (a + b);
            let tolerance = self.tolerance / 3.0 + ROUNDING * x.abs();
            if (x - middle).abs() <= 2.0 * tolerance - 0.5 * (b - a) {
                break;
            }
            match parabola((x, fx), (w, fw), (v, fv)) {
                // Inside the bracket and less than half the step before last: the parabola is trusted.
                Some(s) if before.abs() > tolerance && s.abs() < 0.5 * before.abs() && x + s > a && x + s < b => {
                    before = step;
                    step = s;
                    if x + s - a < 2.0 * tolerance || b - (x + s) < 2.0 * tolerance {
                        step = if x < middle { tolerance } else { -tolerance };
                    }
                }
                _ => {
                    before = if x < middle { b - x } else { a - x };
                    step = GOLDEN * before;
                }
            }
            let u = x + if step.abs() >= tolerance { step } else { tolerance.copysign(step) };
            let fu = value_all(objective, &[u], 1)?[0];
            evaluations += 1;
            if fu <= fx {
                if u < x {
                    b = x;
                } else {
                    a = x;
                }
                (v, fv, w, fw, x, fx) = (w, fw, x, fx, u, fu);
            } else {
                if u < x {
                    a = u;
                } else {
                    b = u;
                }
                if fu <= fw || w == x {
                    (v, fv, w, fw) = (w, fw, u, fu);
                } else if fu <= fv || v == x || v == w {
                    (v, fv) = (u, fu);
                }
            }
            if !progress(&Progress { iteration, evaluations, value: fx }) {
                return Err(MinimiseError::Stopped);
            }
        }
        Ok(Minimum { point: vec![x], value: fx, evaluations })
    }
}

/// Step from `x` to the vertex of the parabola through three points, if they define one.
fn parabola((x, fx): (f64, f64), (w, fw): (f64, f64), (v, fv): (f64, f64)) -> Option<f64> {
    let r = (x - w) * (fx - fv);
    let q = (x - v) * (fx - fw);
    let numerator = (x - v) * q - (x - w) * r;
    let denominator = 2.0 * (q - r);
    let step = -numerator / denominator;
    step.is_finite().then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tune::minimise::{Method, minimise};

    fn run(f: impl FnMut(&[f64]) -> f64 + 'static, low: f64, high: f64) -> Result<Minimum, MinimiseError> {
        let mut f = f;
        minimise(&mut f, &[low], &[high], &Method::Brent(Brent::default()), &mut |_| true)
    }

    #[test]
    fn finds_minima_of_many_shapes_in_few_evaluations() {
        for centre in [-11.9, -6.0, -1.2345, 0.0, 3.99] {
            let smooth = run(move |p| (p[0] - centre).powi(2) + 0.1 * (p[0] - centre).powi(4), -12.0, 4.0).unwrap();
            assert!((smooth.point[0] - centre).abs() < 1e-3 && smooth.evaluations < 13 + 25, "{centre}: {smooth:?}");
            let kinked = run(move |p| (p[0] - centre).abs(), -12.0, 4.0).unwrap();
            assert!((kinked.point[0] - centre).abs() < 1e-3, "{centre}: {kinked:?}");
        }
    }

    #[test]
    fn takes_the_deeper_of_two_valleys() {
        let f = |p: &[f64]| (p[0] + 8.0).powi(2).min(-1.0 + (p[0] - 2.0).powi(2));
        assert!((run(f, -12.0, 4.0).unwrap().point[0] - 2.0).abs() < 1e-3);
    }

    #[test]
    fn a_minimum_at_the_end_is_reported_at_the_end() {
        let best = run(|p| p[0], -12.0, 4.0).unwrap();
        assert!(best.point[0] <= -12.0 + 2e-3, "{best:?}");
    }

    #[test]
    fn only_nan_is_an_error_and_some_nan_is_not() {
        assert!(matches!(run(|_| f64::NAN, 0.0, 1.0), Err(MinimiseError::NothingFinite { evaluations: 13 })));
        let best = run(|p| if p[0] < 0.0 { f64::NAN } else { (p[0] - 0.3).powi(2) }, -1.0, 1.0).unwrap();
        assert!((best.point[0] - 0.3).abs() < 1e-3);
    }

    #[test]
    fn bounds_that_cross_are_refused() {
        assert!(matches!(run(|_| 0.0, 1.0, 0.0), Err(MinimiseError::Bounds(_))));
    }
}
