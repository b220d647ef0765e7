//! Logs as people have them: delimited text in and out, and what the time stamps say about the sample rate.
//!
//! Nothing here filters; it turns bytes into columns and columns into bytes, once per log.

pub mod blackbox;
pub mod delimited;
mod dialect;
mod guarded;
pub mod timebase;
pub mod writer;
