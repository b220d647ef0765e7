//! What a report shows of a log: where it is quiet, how much a filter took away, its spectrum.

pub mod quiet;
pub mod spectrum;
