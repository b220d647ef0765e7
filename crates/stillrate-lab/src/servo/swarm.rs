//! The population of [`search`](super::search): children, the selection among them, and the memory of what succeeded.

use core::f64::consts::PI;

use stillrate::Real;

use super::score::{Score, Scored, order};
use crate::random::{Generator, Random};

/// The least number of points that a child can be made from, and what a run of few evaluations begins with.
pub(super) const FEWEST: usize = 4;
/// Length of the memory of F and CR, and what it starts with.
const MEMORY: usize = 6;
const FIRST_SCALE: f64 = 0.5;
const FIRST_CROSSOVER: f64 = 0.8;
/// Width of the draws around the memory.
const WIDTH: f64 = 0.1;
/// Share of the population that counts as best.
const BEST: f64 = 0.15;

/// A child with the scale and crossover it was made with.
pub(super) struct Child {
    pub(super) point: Vec<f64>,
    scale: f64,
    crossover: f64,
}

/// A population, best first, in units of its box.
pub(super) struct Swarm {
    pub(super) points: Vec<Scored>,
    beaten: Vec<Vec<f64>>,
    scales: [f64; MEMORY],
    crossovers: [f64; MEMORY],
    slot: usize,
}

impl Swarm {
    pub(super) fn new(mut points: Vec<Scored>) -> Self {
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
    pub(super) fn trials(&self, most: usize, random: &mut Random) -> Vec<Child> {
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
    pub(super) fn select(&mut self, trials: Vec<Child>, scores: &[Score], mut won: impl FnMut(&[f64], Score)) {
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

    /// Down to the best `size` points, and as many of the beaten at random.
    pub(super) fn shrink(&mut self, size: usize, random: &mut Random) {
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
