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
use crate::tune::minimise::{MinimiseError, Minimum, Objective, Progress, lowest, value_all};

/// Where an attractor lies between a particle's own best and the swarm's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attractor {
    /// phi = c1 r1 / (c1 r1 + c2 r2).
    Ratio,
    /// phi = r1 (r2 is drawn and not used).
    Uniform,
}

/// What happens to a coordinate outside the box.
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
/// use stillrate_lab::tune::qpso::Qpso;
/// let paper = Qpso::default();
/// assert_eq!((paper.particles, paper.iterations, paper.target), (100, 100, 1e-5));
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

/// The swarm after one iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Swarm {
    /// Iterations done.
    pub iteration: usize,
    /// Contraction coefficient of this iteration (NaN before the first).
    pub contraction: f64,
    /// Mean of all particles' best positions before this iteration (empty before the first).
    pub mean_best: Vec<f64>,
    /// Positions, particle by particle.
    pub position: Vec<f64>,
    /// Values there.
    pub value: Vec<f64>,
    /// Each particle's best position.
    pub best: Vec<f64>,
    /// Values there.
    pub best_value: Vec<f64>,
    /// The swarm's best position.
    pub swarm_best: Vec<f64>,
    /// Value there.
    pub swarm_value: f64,
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
    /// [`MinimiseError`] for settings out of range, if `watch` stops the run, or if no value was finite.
    pub fn run(
        &self,
        objective: &mut dyn Objective,
        lower: &[f64],
        upper: &[f64],
        uniform: &mut dyn FnMut() -> f64,
        watch: &mut dyn FnMut(&Swarm) -> bool,
    ) -> Result<Swarm, MinimiseError> {
        self.check()?;
        let dimensions = lower.len();
        let mut swarm = self.scatter(objective, lower, upper, uniform)?;
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

    /// Particles spread evenly over the box.
    fn scatter(
        &self,
        objective: &mut dyn Objective,
        lower: &[f64],
        upper: &[f64],
        uniform: &mut dyn FnMut() -> f64,
    ) -> Result<Swarm, MinimiseError> {
        let position: Vec<f64> = (0..self.particles)
            .flat_map(|_| lower.iter().zip(upper).map(|(lo, hi)| lo + (hi - lo) * uniform()).collect::<Vec<_>>())
            .collect();
        let value = value_all(objective, &position, lower.len())?;
        let (first, swarm_value) = lowest(&value).unwrap_or((0, f64::INFINITY));
        Ok(Swarm {
            iteration: 0,
            contraction: f64::NAN,
            mean_best: Vec::new(),
            swarm_best: position[first * lower.len()..(first + 1) * lower.len()].to_vec(),
            best: position.clone(),
            best_value: value.clone(),
            position,
            value,
            swarm_value,
        })
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

impl Swarm {
    /// Updates each particle's best (strictly better only), then the swarm's.
    fn remember(&mut self, dimensions: usize) {
        for (i, (&value, best)) in self.value.iter().zip(&mut self.best_value).enumerate() {
            if value < *best {
                *best = value;
                let range = i * dimensions..(i + 1) * dimensions;
                self.best[range.clone()].copy_from_slice(&self.position[range]);
            }
        }
        if let Some((i, value)) = lowest(&self.best_value) {
            self.swarm_value = value;
            self.swarm_best.copy_from_slice(&self.best[i * dimensions..(i + 1) * dimensions]);
        }
    }
}
