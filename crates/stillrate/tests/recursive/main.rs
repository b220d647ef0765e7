//! Behaviour of the recursive filters: start-up, gaps, irregular time, long runs in `f32`.
mod bias;
mod level;
mod vector;

use stillrate::{Estimate, Filter, Real, Sample};

/// Runs one channel at the nominal rate.
pub fn run<T: Real, F: Filter<T>>(filter: &F, values: &[T]) -> Vec<Estimate<T>> {
    let mut state = filter.start();
    values.iter().map(|&value| filter.step(&mut state, Sample { value, dt: filter.period() })).collect()
}

/// White Gaussian numbers from a seed: SplitMix64 and Box-Muller.
pub struct Noise(pub u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
    /// One of them.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).logarithm()).root();
        radius * (core::f64::consts::TAU * self.uniform()).sine_cosine().1
    }
}
