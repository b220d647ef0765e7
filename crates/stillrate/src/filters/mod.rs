//! One published filter a file, reading like its equations.
//!
//! A filter is built from its settings ([`Settings::build`](crate::Settings::build)), which check everything; from there on nothing fails.
mod ar_kf;
mod ar_kf_settings;
mod biquad;
pub mod closed_forms;
mod cusum_forgetting;
pub mod fir;
mod fir_settings;
mod hmm_rls;
mod linear_prediction;
mod ms_imm_ikf;
mod ms_imm_ikf_paper;
mod ms_imm_ikf_paper_fading;
mod ms_imm_ikf_paper_settings;
mod one_euro;
mod online_ar;
mod pt1;
mod random_walk_kf;
mod recursive;
mod sage_husa_kf;
mod singer_imm_kf;
mod singer_imm_kf_compact;
mod singer_imm_kf_settings;
mod singer_imm_model;
mod singer_kf;
mod singer_pair;
mod variable_forgetting;
mod variable_forgetting_settings;
mod vector_rls;

pub use ar_kf::{ArKf, ArKfState, HIGHEST_ORDER as AR_HIGHEST_ORDER};
pub use ar_kf_settings::ArKfSettings;
pub use biquad::{Biquad, BiquadSettings, BiquadState};
pub use cusum_forgetting::{CusumForgetting, CusumForgettingSettings, CusumForgettingState};
pub use fir::{FirLowPass, FirLowPassState};
pub use fir_settings::FirLowPassSettings;
pub use hmm_rls::{
    DEFAULT_TAU_S, RecursiveLeastSquares, RecursiveLeastSquaresSettings, RecursiveLeastSquaresState, WeightedMean,
};
pub use linear_prediction::{LinearPrediction, LinearPredictionSettings, LinearPredictionState};
pub use ms_imm_ikf::{MsImmIkf, MsImmIkfSettings, MsImmIkfState, OSCILLATORS, Pace, RUNGS};
pub use ms_imm_ikf_paper::{MsImmIkfPaper, MsImmIkfPaperState, PaperModel};
pub use ms_imm_ikf_paper_settings::{
    ALPHA_MIXING, FADING_GATES, FADING_SCOPES, FADING_SOURCES, FADINGS, JACOBIANS, MODES, MsImmIkfPaperSettings,
};
pub use one_euro::{OneEuro, OneEuroSettings, OneEuroState};
pub use online_ar::{OnlineAr, OnlineArState};
pub use pt1::{Pt1, Pt1Settings, Pt1State};
pub use random_walk_kf::{RandomWalkKf, RandomWalkKfSettings};
pub use recursive::{LevelState, LineState};
pub use sage_husa_kf::{SageHusaKf, SageHusaKfSettings, SageHusaKfState};
pub use singer_imm_kf::{SingerImmKf, SingerImmKfState};
pub use singer_imm_kf_settings::SingerImmKfSettings;
pub use singer_imm_model::SingerImmModel;
pub use singer_kf::{SingerKf, SingerKfSettings, SingerKfState};
pub use singer_pair::SingerPair;
pub use variable_forgetting::{VariableForgetting, VariableForgettingState};
pub use variable_forgetting_settings::VariableForgettingSettings;
pub use vector_rls::{VectorRls, VectorRlsEstimate, VectorRlsSettings, VectorRlsState};
