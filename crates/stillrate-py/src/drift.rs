//! `stillrate.platform.drift` and `variance`: gyro noise through rate loops and tracked loops.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use stillrate_lab::servo::drift::{
    DriftError, DriftLoop, FilterPosition, LoopNoise, TransferFunction, drift, drift_in_band, lyapunov, quadrature,
    steady_state, van_loan,
};

use crate::convert::config_error;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(servo_variance, module)?)?;
    module.add_function(wrap_pyfunction!(servo_drift, module)?)
}

type Polynomials = (Vec<f64>, Vec<f64>);

/// Variance of a transfer function's output for white noise of two-sided density 1.
#[pyfunction]
#[pyo3(signature = (transfer, time_s, band_rad_s, algorithm))]
fn servo_variance(
    py: Python<'_>,
    transfer: Polynomials,
    time_s: Option<f64>,
    band_rad_s: Option<(f64, f64)>,
    algorithm: &str,
) -> PyResult<f64> {
    let compute = || -> Result<f64, DriftError> {
        let h = TransferFunction::new(&transfer.0, &transfer.1)?;
        match (time_s, band_rad_s, algorithm) {
            (_, Some((low, high)), _) => quadrature::band_variance(|w| h.power_gain(w), low, high, 1e-13),
            (Some(t), None, _) => van_loan::variance_after(&h, t),
            (None, None, "lyapunov") => lyapunov::steady_state(&h),
            (None, None, "van-loan") => van_loan::steady_state(&h),
            _ => steady_state(&h),
        }
    };
    compute().map_err(|e| config_error(py, &e))
}

/// (white, Gauss-Markov, rate random walk) variances of the angle, and the bias gain.
#[pyfunction]
#[pyo3(signature = (rate_loop, tracking, filter, position, dead_time_s, noise, time_s, band_rad_s))]
fn servo_drift(
    py: Python<'_>,
    rate_loop: Option<Polynomials>,
    tracking: Option<Polynomials>,
    filter: Option<Polynomials>,
    position: &str,
    dead_time_s: f64,
    noise: (f64, f64, f64, f64),
    time_s: Option<f64>,
    band_rad_s: Option<(f64, f64)>,
) -> PyResult<(f64, f64, f64, f64)> {
    let position = match position {
        "before-loop" => FilterPosition::BeforeLoop,
        "rate-feedback" => FilterPosition::RateFeedback,
        "forward-path" => FilterPosition::ForwardPath,
        other => {
            return Err(PyValueError::new_err(format!(
                "filter_position = {other} (must be before-loop, rate-feedback or forward-path)"
            )));
        }
    };
    let compute = || -> Result<(f64, f64, f64, f64), DriftError> {
        // Without a rate loop the platform follows its gyro perfectly: a pure integrator.
        let (num, den) = rate_loop.unwrap_or((vec![1.0], vec![1.0]));
        let mut servo = DriftLoop::rate_only(TransferFunction::new(&num, &den)?).delayed(dead_time_s)?;
        if let Some((kb, ka)) = &tracking {
            servo = servo.tracked(kb, ka)?;
        }
        if let Some((num, den)) = &filter {
            servo = servo.filtered(TransferFunction::new(num, den)?, position);
        }
        let (white, sigma, tau, walk) = noise;
        let mut noise = LoopNoise::from_density_two_sided(white)?.with_rate_random_walk(walk)?;
        if sigma != 0.0 {
            noise = noise.with_gauss_markov(sigma, tau)?;
        }
        let bias = servo.bias_gain();
        let d = match band_rad_s {
            Some(band) => drift_in_band(&servo, &noise, band)?,
            None => drift(&servo.noise_path()?, &noise, time_s)?,
        };
        Ok((d.white, d.gauss_markov, d.rate_random_walk, bias))
    };
    compute().map_err(|e| config_error(py, &e))
}
