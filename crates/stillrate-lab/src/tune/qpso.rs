//! Quantum-behaved particle swarm, mean-best form (Sun, Feng and Xu 2004; Sun, Xu and Feng 2004).
//!
//! phi = c1 r1 / (c1 r1 + c2 r2);  L = phi pbest_i + (1 - phi) gbest;  mb = mean of all pbest;
//! beta = w1 + (w2 - w1)(T - t)/T;  x = L +/- beta |mb - x| ln(1/u), plus where s < 1/2.
//! All numbers of an iteration are drawn before any point is valued (r1, r2, u, s for each particle and dimension in
//! turn), and pbest and gbest change only after all are valued: the result does not depend on threads.
//! Trap: attractors written as (c1 phi p + c2 (1 - phi) g)/(c1 + c2) pull to the origin and only look good on
//! functions whose minimum is there; the tests here are on shifted functions.

use stillrate::Real;

use crate::random::{Generator, SplitMix64};
use crate::tune::objective::{MinimiseError, Minimum, Objective, Progress, check_bounds, value_all};
use crate::tune::swarm::Swarm;

/// Where an attractor lies between a particle's own best and the swarm's.
///
/// # Example
/// ```
/// use stillrate_lab::tune::{minimise::{Method, minimise}, qpso::{Attractor, Qpso}};
/// let mut bowl = |p: &[f64]| (p[0] - 3.0) * (p[0] - 3.0); // a centre away from 0, where wrong attractors pull to
/// for attractor in [Attractor::Ratio, Attractor::Uniform] {
///     let method = Method::Qpso(Qpso { attractor, ..Qpso::default() });
///     let best = minimise(&mut bowl, &[-10.0], &[10.0], &method, &mut |_| true).unwrap();
///     assert!((best.point[0] - 3.0).abs() < 0.01);
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attractor {
    /// phi = c1 r1 / (c1 r1 + c2 r2).
    Ratio,
    /// phi = r1 (r2 is drawn and not used).
    Uniform,
}

/// What happens to a coordinate outside the box.
///
/// # Example
/// ```
/// use stillrate_lab::tune::{minimise::{Method, minimise}, qpso::{Bound, Qpso}};
/// let mut slope = |p: &[f64]| p[0];
/// let mut least = |bound| {
///     let method = Method::Qpso(Qpso { bound, ..Qpso::default() });
///     minimise(&mut slope, &[1.0], &[2.0], &method, &mut |_| true).unwrap().value
/// };
/// assert_eq!(least(Bound::Clip), 1.0); // a minimum on the edge is met exactly
/// assert!(least(Bound::Reflect) < 1.001);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// Set to the bound.
    Clip,
    /// Mirrored at the bound it crossed (and clipped if it crosses the other).
    Reflect,
}

/// Settings of the swarm.
///
/// # Example
/// ```
/// use stillrate_lab::random::{Generator, SplitMix64};
/// use stillrate_lab::tune::qpso::Qpso;
/// let mut generator = SplitMix64::new(1);
/// let mut contractions = Vec::new();
/// let last = Qpso::default().run(&mut |p: &[f64]| 1.0 + p[0] * p[0], &[-10.0], &[10.0], &mut || generator.uniform(), &mut |swarm| {
///     contractions.push(swarm.contraction);
///     true
/// })?;
/// assert_eq!((last.position.len(), contractions.len()), (100, 101)); // particles; the initial swarm and 100 iterations
/// assert_eq!(contractions[1], 1.0); // from w2, falling towards w1 = 0.5
/// assert!(contractions[100] < 0.51 && last.swarm_value < 1.0 + 1e-6);
/// # Ok::<(), stillrate_lab::tune::objective::MinimiseError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Qpso {
    /// Number of particles.
    pub particles: usize,
    /// Number of iterations, over which beta falls.
    pub iterations: usize,
    /// Last contraction coefficient (w1).
    pub last_contraction: f64,
    /// First contraction coefficient (w2).
    pub first_contraction: f64,
    /// Weight of the particle's own best (c1).
    pub own_weight: f64,
    /// Weight of the swarm's best (c2).
    pub swarm_weight: f64,
    /// Stops when the best value is at or below this; minus infinity switches it off.
    pub target: f64,
    /// Form of phi.
    pub attractor: Attractor,
    /// Treatment of the bounds.
    pub bound: Bound,
    /// Seed of the uniform numbers.
    pub seed: u64,
}

impl Default for Qpso {
    /// The published setting: 100 particles, 100 iterations, w 0.5 and 1, c 2.2, stop at 1e-5.
    fn default() -> Self {
        Self {
            particles: 100,
            iterations: 100,
            last_contraction: 0.5,
            first_contraction: 1.0,
            own_weight: 2.2,
            swarm_weight: 2.2,
            target: 1e-5,
            attractor: Attractor::Ratio,
            bound: Bound::Clip,
            seed: 1,
        }
    }
}

impl Qpso {
    pub(crate) fn minimise(
        &self,
        objective: &mut dyn Objective,
        lower: &[f64],
        upper: &[f64],
        progress: &mut dyn FnMut(&Progress) -> bool,
    ) -> Result<Minimum, MinimiseError> {
        let mut generator = SplitMix64::new(self.seed);
        let mut evaluations = 0;
        let mut uniform = || generator.uniform();
        let last = self.run(objective, lower, upper, &mut uniform, &mut |swarm| {
            evaluations += self.particles;
            progress(&Progress { iteration: swarm.iteration, evaluations, value: swarm.swarm_value })
        })?;
        let evaluations = self.particles * (last.iteration + 1);
        Ok(Minimum { point: last.swarm_best, value: last.swarm_value, evaluations })
    }

    /// Runs the swarm on any source of uniform numbers, showing each iteration (the initial swarm is number 0) to `watch`,
    /// which may stop it.
    ///
    /// # Errors
    /// [`MinimiseError`] for bounds or settings out of range, if `watch` stops the run, or if no value was finite.
    pub fn run(
        &self,
        objective: &mut dyn Objective,
        lower: &[f64],
        upper: &[f64],
        uniform: &mut dyn FnMut() -> f64,
        watch: &mut dyn FnMut(&Swarm) -> bool,
    ) -> Result<Swarm, MinimiseError> {
        check_bounds(lower, upper)?;
        self.check()?;
        let dimensions = lower.len();
        let mut swarm = Swarm::scattered(self.particles, objective, lower, upper, uniform)?;
        for t in 0..=self.iterations {
            if !watch(&swarm) {
                return Err(MinimiseError::Stopped);
            }
            if t == self.iterations || swarm.swarm_value <= self.target {
                break;
            }
            self.move_all(&mut swarm, t, (lower, upper), uniform);
            swarm.value = value_all(objective, &swarm.position, dimensions)?;
            swarm.remember(dimensions);
        }
        if swarm.swarm_value.is_finite() {
            return Ok(swarm);
        }
        Err(MinimiseError::NothingFinite { evaluations: self.particles * (swarm.iteration + 1) })
    }

    fn check(&self) -> Result<(), MinimiseError> {
        let bad = |field: &str, value: f64, range: &str| {
            Err(MinimiseError::Setting(format!("{field} = {value} (must be {range})")))
        };
        if self.particles < 2 || self.particles > 1_000_000 {
            return bad("particles", self.particles as f64, "2 to 1000000");
        }
        if self.iterations < 1 || self.iterations > 1_000_000 {
            return bad("iterations", self.iterations as f64, "1 to 1000000");
        }
        for (field, value) in [
            ("last_contraction", self.last_contraction),
            ("first_contraction", self.first_contraction),
            ("own_weight", self.own_weight),
            ("swarm_weight", self.swarm_weight),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return bad(field, value, "finite and > 0");
            }
        }
        if self.target.is_nan() {
            return bad("target", self.target, "a number or minus infinity");
        }
        Ok(())
    }

    fn move_all(
        &self,
        swarm: &mut Swarm,
        t: usize,
        (lower, upper): (&[f64], &[f64]),
        uniform: &mut dyn FnMut() -> f64,
    ) {
        let dimensions = lower.len();
        let left = (self.iterations - t) as f64 / self.iterations as f64;
        let beta = self.last_contraction + (self.first_contraction - self.last_contraction) * left;
        let mean: Vec<f64> = (0..dimensions)
            .map(|d| swarm.best.iter().skip(d).step_by(dimensions).sum::<f64>() / self.particles as f64)
            .collect();
        for i in 0..self.particles {
            for d in 0..dimensions {
                let [r1, r2, u, s] = [uniform(), uniform(), uniform(), uniform()];
                let phi = self.share(r1, r2);
                let k = i * dimensions + d;
                let attractor = phi * swarm.best[k] + (1.0 - phi) * swarm.swarm_best[d];
                // 1 - u lies in (0, 1]: the logarithm is finite.
                let jump = beta * (mean[d] - swarm.position[k]).abs() * (1.0 / (1.0 - u)).logarithm();
                let x = if s < 0.5 { attractor + jump } else { attractor - jump };
                swarm.position[k] = self.inside(x, lower[d], upper[d]);
            }
        }
        swarm.iteration = t + 1;
        swarm.contraction = beta;
        swarm.mean_best = mean;
    }

    fn share(&self, r1: f64, r2: f64) -> f64 {
        match self.attractor {
            Attractor::Uniform => r1,
            Attractor::Ratio => {
                let (own, all) = (self.own_weight * r1, self.swarm_weight * r2);
                // Both draws zero (once in 2^106): no preference.
                if own + all > 0.0 { own / (own + all) } else { 0.5 }
            }
        }
    }

    fn inside(&self, x: f64, low: f64, high: f64) -> f64 {
        let mirrored = match self.bound {
            Bound::Reflect if x < low => 2.0 * low - x,
            Bound::Reflect if x > high => 2.0 * high - x,
            Bound::Reflect | Bound::Clip => x,
        };
        mirrored.clamp(low, high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_that_are_no_box_are_refused_by_the_swarm_itself() {
        let run = |lower: &[f64], upper: &[f64]| {
            Qpso::default().run(&mut |p: &[f64]| p.iter().sum(), lower, upper, &mut || 0.5, &mut |_| true)
        };
        for (lower, upper) in [(&[] as &[f64], &[] as &[f64]), (&[0.0, 0.0], &[1.0]), (&[1.0], &[0.0])] {
            assert!(matches!(run(lower, upper), Err(MinimiseError::Bounds(_))), "{lower:?} {upper:?}");
        }
    }
}
