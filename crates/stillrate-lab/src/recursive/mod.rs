//! What the recursive filters are worth: step and frequency responses, the adaptive bench, the two-fix table.

pub mod bench;
pub mod response;
pub mod scenarios;
pub mod two_fixes;
