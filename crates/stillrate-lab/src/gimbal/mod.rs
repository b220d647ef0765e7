//! Desk-side part of the gimballed sensor head: truth, bounds, batch solution, baselines, trajectory search, studies.

pub mod batch;
pub mod bound;
pub mod calibrate;
pub mod gauge;
pub mod hidden;
pub mod literal;
pub mod plan;
pub mod prepare;
pub mod residuals;
pub mod score;
pub mod simulate;
pub mod study;
pub mod trajectory;
pub mod triangle;

pub use batch::{Batch, batch};
pub use bound::{Bound, Sampling, bound, sensitivities};
pub use calibrate::{History, Method, Outcome, Settings, calibrate};
pub use gauge::to_gauge;
pub use hidden::hidden;
pub use plan::{Figures, Search, figures, plan};
pub use prepare::{LogError, Prepared, prepare};
pub use residuals::{ResidualTests, Residuals};
pub use score::{Score, score, settling_time};
pub use simulate::{Disturbance, disturb, draw, outputs};
pub use study::{Draw, Start, Study, median, run_draw, run_study};
pub use trajectory::{DEFAULT_SEGMENTS, Trajectory};
