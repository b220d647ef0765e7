//! What the recursive filters share: how long the past counts, the weighted sums, the level and the line.
//!
//! Every one of them is a weighted mean (order 1) or a weighted straight line (order 2) of all samples so far; they differ only in
//! how much of the past's weight is lost from one sample to the next.

pub(crate) mod averaging;
pub(crate) mod innovation;
pub(crate) mod level;
pub(crate) mod line;
pub(crate) mod memory;
pub(crate) mod paced;

pub use level::LevelState;
pub use line::LineState;
