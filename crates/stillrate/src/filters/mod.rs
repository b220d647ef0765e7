//! One published filter a file, reading like its equations.
mod ms_imm_ikf;
mod ms_imm_ikf_cycle;
mod ms_imm_ikf_paper;
mod ms_imm_ikf_paper_settings;
mod ms_imm_ikf_settings;
mod pt1;
mod singer_imm_kf;
mod singer_kf;

pub use ms_imm_ikf::{MsImmIkf, MsImmIkfState, OSCILLATORS, Pace, RUNGS};
pub use ms_imm_ikf_paper::{FadingGate, MsImmIkfPaper, MsImmIkfPaperState, PaperModel};
pub use ms_imm_ikf_paper_settings::{
    ALPHA_MIXING, FADING_GATES, FADING_SCOPES, FADING_SOURCES, FADINGS, JACOBIANS, MODES, MsImmIkfPaperSettings,
};
pub use ms_imm_ikf_settings::MsImmIkfSettings;
pub use pt1::{Pt1, Pt1Settings, Pt1State};
pub use singer_imm_kf::{SingerImmKf, SingerImmKfSettings, SingerImmKfState, SingerImmModel};
pub use singer_kf::{SingerKf, SingerKfSettings, SingerKfState};
