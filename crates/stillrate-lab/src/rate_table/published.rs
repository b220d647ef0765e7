//! The published method, built as printed so that it can be seen to memorise: a 1-10-1 network regresses the error on the noisy
//! measured rate of six constant-rate records and is subtracted at that rate; a scalar Kalman filter follows.

use stillrate::correction::ErrorCurve;

use crate::rate_table::bed::Pair;
use crate::rate_table::candidate::from_network;
use crate::rate_table::network::Scaling;
use crate::rate_table::training::Training;

/// Trains the published network on the raw samples of some records and gives its curve (one evaluation, at the measured rate).
pub(crate) fn train_on(records: &[Pair], training: &Training) -> Result<ErrorCurve<f64>, String> {
    let measured: Vec<f64> = records.iter().flat_map(|r| r.1.iter().copied()).collect();
    let errors: Vec<f64> = records.iter().flat_map(|(truth, y)| y.iter().zip(truth).map(|(y, w)| y - w)).collect();
    let scaling = Scaling::spanning(&measured, 1, &errors);
    let trained = training.train(&scaling.inward(&measured), &scaling.target_inward(&errors))?;
    Ok(from_network(&trained.network, &scaling, 1))
}
