//! One published filter a file, reading like its equations.
mod pt1;

pub use pt1::{Pt1, Pt1Settings, Pt1State};
