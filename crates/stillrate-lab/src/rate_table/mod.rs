//! The rate-table error model: what is wrong with a gyro's rate as a function of the rate, fitted so that it holds on rates not seen.
pub mod bed;
pub mod candidate;
pub mod errors;
pub mod fit;
pub mod levenberg;
pub mod model;
pub mod network;
pub mod plateaus;
pub mod points;
mod published;
pub mod study;
pub mod table3;
pub mod training;
