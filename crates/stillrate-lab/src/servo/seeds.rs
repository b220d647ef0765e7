//! Seeds of gyro noise for tuning and for validation, fixed before any published tuning was run.
//!
//! Tuners use [`TUNING`] only. [`VALIDATION`] was not looked at while the tuner and its safety margins were designed; figures of an earlier
//! set influenced one design, so the whole table was tuned and measured anew with these.

/// Seeds that tuners see.
pub const TUNING: [u64; 12] = [201, 202, 203, 204, 205, 206, 207, 208, 209, 210, 211, 212];
/// Seeds that only published figures see.
pub const VALIDATION: [u64; 12] =
    [880_101, 880_102, 880_103, 880_104, 880_105, 880_106, 880_107, 880_108, 880_109, 880_110, 880_111, 880_112];
/// Seed of the search itself.
pub const SEARCH: u64 = 20_263;
