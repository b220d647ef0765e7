//! `stillrate.platform`: what a filter alone does to amplitude, phase and integral, apart from any loop.

use pyo3::prelude::*;
use pyo3::types::PyList;
use stillrate_lab::servo::chain::by_name;
use stillrate_lab::servo::describing::describe;
use stillrate_lab::servo::study;

use crate::convert::config_error;
use crate::servo_objects::{bench_from, chain_from, family_from};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(servo_integration_error, module)?)?;
    module.add_function(wrap_pyfunction!(servo_describe, module)?)
}

/// Error added by integrating the filter's output of amplitude sin(2 pi f t), deg.
#[pyfunction]
fn servo_integration_error(
    py: Python<'_>,
    bench: &Bound<'_, PyAny>,
    family: &Bound<'_, PyAny>,
    parameters: Vec<f64>,
    motion: (f64, f64),
    duration_s: f64,
    seeds: Vec<u64>,
) -> PyResult<f64> {
    use stillrate::Real;
    let (bench, family) = (bench_from(bench)?, family_from(family)?);
    let (amplitude, frequency) = motion;
    let rate = |t: f64| amplitude * (std::f64::consts::TAU * frequency * t).sine_cosine().0;
    py.detach(|| study::integration_error_deg(&bench, &family, &parameters, rate, duration_s, &seeds))
        .map_err(|e| config_error(py, &e))
}

/// Gain and phase (deg) of a filter's first harmonic at each amplitude.
#[pyfunction]
fn servo_describe(
    py: Python<'_>,
    filter: &Bound<'_, PyList>,
    sample_rate_hz: f64,
    frequency_hz: f64,
    amplitudes_dps: Vec<f64>,
    noise_sigma_dps: f64,
    run: (usize, u64),
) -> PyResult<Vec<(f64, f64)>> {
    let mut filter = by_name(&chain_from(filter)?).map_err(|e| config_error(py, &e))?;
    for (name, value) in [("sample_rate_hz", sample_rate_hz), ("frequency_hz", frequency_hz)] {
        stillrate::error::positive(name, value, "Hz").map_err(|e| config_error(py, &e))?;
    }
    let (periods, seed) = run;
    Ok(py.detach(|| {
        amplitudes_dps
            .iter()
            .map(|a| describe(&mut *filter, sample_rate_hz, frequency_hz, *a, noise_sigma_dps, periods, seed))
            .map(|h| (h.gain, h.phase_deg))
            .collect()
    }))
}
