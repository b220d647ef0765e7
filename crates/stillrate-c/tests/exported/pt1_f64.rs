// pt1 at 50 Hz in f64, exported by stillrate 0.1.0. Generated; do not edit.
/// Checked configuration.
pub const STILLRATE_CONFIG: stillrate::filters::Pt1<f64> = stillrate::filters::Pt1 {
    period_s: 0.02,
    gain: 0.6110154703516573,
    corner_rad_s: 78.53981633974483,
    limit: 10000000000.0,
};
