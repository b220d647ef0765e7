//! Desk-side part of the gimballed sensor head: truth, bounds, batch solution, baselines, trajectory search, studies.

pub mod batch;
pub mod bound;
pub mod random;
pub mod simulate;
pub mod trajectory;

pub use batch::{Batch, batch};
pub use bound::{Bound, Sampling, bound, sensitivities};
pub use random::Random;
pub use simulate::{Disturbance, disturb, draw, outputs};
pub use trajectory::{DEFAULT_SEGMENTS, Trajectory};
