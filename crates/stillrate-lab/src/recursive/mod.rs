//! What the recursive filters are worth: gains, step and frequency responses, the adaptive bench, the two-fix table.

pub mod bench;
pub mod gains;
pub mod matched;
pub mod response;
pub mod scenarios;
pub mod two_fixes;
