//! Logs as people have them: delimited text in and out, and what the time stamps say about the sample rate.
//!
//! Nothing here filters; it turns bytes into columns and columns into bytes, once per log.

pub mod blackbox;
pub mod delimited;
pub mod dialect;
pub mod timebase;
pub mod writer;
