//! A swarm of particles: where each is, the best place each has seen, and the best of all.

use crate::tune::objective::{MinimiseError, Objective, lowest, value_all};

/// The swarm after one iteration.
///
/// # Example
/// ```
/// use stillrate_lab::tune::{qpso::Qpso, swarm::Swarm};
/// let mut numbers = [0.25, 0.75].into_iter(); // two particles at a quarter and three quarters of -10..=10
/// let mut first = None;
/// let mut keep = |swarm: &Swarm| {
///     first = Some(swarm.clone());
///     false
/// };
/// let settings = Qpso { particles: 2, ..Qpso::default() };
/// settings.run(&mut |p: &[f64]| p[0], &[-10.0], &[10.0], &mut || numbers.next().unwrap(), &mut keep).unwrap_err();
/// assert_eq!(first.unwrap().swarm_best, [-5.0]);
/// ```
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

impl Swarm {
    /// Particles spread evenly over the box.
    pub(super) fn scattered(
        particles: usize,
        objective: &mut dyn Objective,
        lower: &[f64],
        upper: &[f64],
        uniform: &mut dyn FnMut() -> f64,
    ) -> Result<Self, MinimiseError> {
        let position: Vec<f64> = (0..particles)
            .flat_map(|_| lower.iter().zip(upper).map(|(lo, hi)| lo + (hi - lo) * uniform()).collect::<Vec<_>>())
            .collect();
        let value = value_all(objective, &position, lower.len())?;
        let (first, swarm_value) = lowest(&value).unwrap_or((0, f64::INFINITY));
        Ok(Self {
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

    /// Updates each particle's best (strictly better only), then the swarm's.
    pub(super) fn remember(&mut self, dimensions: usize) {
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
