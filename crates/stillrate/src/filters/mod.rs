//! One published filter a file, reading like its equations.
mod bank;
mod ms_imm_ikf;
mod ms_imm_ikf_cycle;
mod ms_imm_ikf_settings;
mod pt1;

pub use bank::{
    frequency::{FrequencyMemory, MotionMoments},
    mix::{Moments2, Moments4},
};
pub use ms_imm_ikf::{MsImmIkf, MsImmIkfState, OSCILLATORS, Pace, RUNGS};
pub use ms_imm_ikf_settings::MsImmIkfSettings;
pub use pt1::{Pt1, Pt1Settings, Pt1State};
