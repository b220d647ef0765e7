// singer-imm-kf at 50 Hz in f32, exported by stillrate 0.1.0. Generated; do not edit.
/// Checked configuration.
pub const STILLRATE_CONFIG: stillrate::filters::SingerImmKf<f32> = stillrate::filters::SingerImmKf {
    period_s: 0.02,
    model: [stillrate::filters::SingerImmModel {
        alpha: 0.001,
        step: stillrate::models::SingerCoefficients {
            r: 0.019999798,
            s: 0.99998,
            q11: 3.99994e-9,
            q12: 2.9999396e-7,
            q22: 2.9999395e-5,
        },
        measurement_variance: 0.0114005,
        start_variance: [0.0114005, 1.0],
    }, stillrate::filters::SingerImmModel {
        alpha: 0.01,
        step: stillrate::models::SingerCoefficients {
            r: 0.019998,
            s: 0.9998,
            q11: 1.59976e-5,
            q12: 0.0011997599,
            q22: 0.11997599,
        },
        measurement_variance: 0.0114005,
        start_variance: [0.0114005, 100.0],
    }],
    leave: [0.05, 0.05],
    start_probability: 0.5,
    limit: 21354624.0,
};
