//! Finding the numbers a filter needs: optimisers and what they make small.
pub mod bank_likelihood;
pub mod brent;
mod candidates;
pub mod gain_ratio;
mod lanes;
pub mod minimise;
pub mod qpso;
pub mod records;
pub mod track;
pub mod tuned;
pub mod tuned_bank;
