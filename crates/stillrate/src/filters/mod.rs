//! One published filter a file, reading like its equations.
mod ar_kf;
mod biquad;
mod linear_prediction;
mod one_euro;
mod pt1;
mod sage_husa_kf;

pub use ar_kf::{ArKf, ArKfSettings, ArKfState, HIGHEST_ORDER as AR_HIGHEST_ORDER};
pub use biquad::{Biquad, BiquadSettings, BiquadState};
pub use linear_prediction::{LinearPrediction, LinearPredictionSettings, LinearPredictionState};
pub use one_euro::{OneEuro, OneEuroSettings, OneEuroState};
pub use pt1::{Pt1, Pt1Settings, Pt1State};
pub use sage_husa_kf::{SageHusaKf, SageHusaKfSettings, SageHusaKfState};
