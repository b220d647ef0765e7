//! Seeds of gyro noise for tuning and for validation, fixed before any published tuning was run.
//!
//! Tuners use [`TUNING`] only. [`VALIDATION`] was not looked at while the tuner and its safety margins were designed.

/// Seeds that tuners see.
pub const TUNING: [u64; 12] = [101, 102, 103, 104, 105, 106, 107, 108, 109, 110, 111, 112];
/// Seeds that only published figures see.
pub const VALIDATION: [u64; 12] =
    [770_001, 770_002, 770_003, 770_004, 770_005, 770_006, 770_007, 770_008, 770_009, 770_010, 770_011, 770_012];
/// Seed of the search itself.
pub const SEARCH: u64 = 20_261;
