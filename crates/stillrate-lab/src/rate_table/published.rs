//! The published method, built as printed so that it can be seen to memorise: a 1-10-1 network regresses the error on the noisy
//! measured rate of six constant-rate records and is subtracted at that rate; a scalar Kalman filter follows.

use stillrate::correction::ErrorCurve;

use crate::random::Random;
use crate::rate_table::bed::{PUBLISHED_RATES, PUBLISHED_SAMPLES, SAMPLE_RATE_HZ, Unit};
use crate::rate_table::candidate::from_network;
use crate::rate_table::network::Scaling;
use crate::rate_table::training::{Trained, Training, train};

/// Six constant-rate records like the published ones: true and measured rate of each.
#[must_use]
pub fn records(unit: &Unit, seed: u64) -> Vec<(Vec<f64>, Vec<f64>)> {
    PUBLISHED_RATES
        .iter()
        .zip(PUBLISHED_SAMPLES)
        .enumerate()
        .map(|(k, (&rate, samples))| {
            let truth = vec![rate; samples];
            let measured = unit.measure(&truth, SAMPLE_RATE_HZ, &mut Random::new(seed, 100 + k as u64));
            (truth, measured)
        })
        .collect()
}

/// Trains the published network on raw samples and gives its curve (one evaluation, at the measured rate).
///
/// # Errors
/// A sentence if the samples do not suffice or are not finite.
pub fn network(measured: &[f64], truth: &[f64], training: &Training) -> Result<(ErrorCurve<f64>, Trained), String> {
    let errors: Vec<f64> = measured.iter().zip(truth).map(|(y, w)| y - w).collect();
    let scaling = Scaling::spanning(measured, 1, &errors);
    let trained = train(training, &scaling.inward(measured), &scaling.target_inward(&errors))?;
    Ok((from_network(&trained.network, &scaling, 1), trained))
}

/// The published network on six records.
///
/// # Errors
/// As [`network`].
pub fn train_on(records: &[(Vec<f64>, Vec<f64>)], training: &Training) -> Result<(ErrorCurve<f64>, Trained), String> {
    let truth: Vec<f64> = records.iter().flat_map(|r| r.0.iter().copied()).collect();
    let measured: Vec<f64> = records.iter().flat_map(|r| r.1.iter().copied()).collect();
    network(&measured, &truth, training)
}
