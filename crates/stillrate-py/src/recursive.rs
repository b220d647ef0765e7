//! Closed forms of the recursive filters, and the tables of their bench.

use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use stillrate::filters::{FirLowPassSettings, OneEuroSettings, closed_forms};
use stillrate::{ConfigError, GyroNoise, Settings};
use stillrate_lab::recursive::{bench, gains, matched, scenarios, two_fixes};

use crate::convert::config_error;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(closed_form, module)?)?;
    module.add_function(wrap_pyfunction!(order_2_gains, module)?)?;
    module.add_function(wrap_pyfunction!(fir_taps, module)?)?;
    module.add_function(wrap_pyfunction!(recursive_responses, module)?)?;
    module.add_function(wrap_pyfunction!(recursive_bench, module)?)?;
    module.add_function(wrap_pyfunction!(two_fix_table, module)?)
}

/// A closed form by name; `second` is the sample number or the frequency where there is one.
#[pyfunction]
#[pyo3(signature = (name, first, second=0.0))]
fn closed_form(name: &str, first: f64, second: f64) -> PyResult<f64> {
    Ok(match name {
        "rls_gain" => closed_forms::rls_gain(first, second as u64),
        "kf_gain" => closed_forms::kf_gain(first, second as u64),
        "rls_noise" => closed_forms::rls_noise(first, second as u64),
        "steady_noise" => closed_forms::steady_noise(first),
        "steady_noise_order_2" => closed_forms::steady_noise_order_2(first),
        "lag_samples" => closed_forms::lag_samples(first),
        "boxcar_length" => closed_forms::boxcar_length(first),
        "phase_delay_samples" => closed_forms::phase_delay_samples(first, second),
        "half_power_frequency" => closed_forms::half_power_frequency(first).unwrap_or(f64::NAN),
        "tau_samples" => closed_forms::tau_samples(first),
        "forgetting_factor_of_tau" => closed_forms::forgetting_factor_of_tau(first),
        "variance_ratio" => closed_forms::variance_ratio(first),
        "forgetting_factor_of_variance_ratio" => closed_forms::forgetting_factor_of_variance_ratio(first),
        other => return Err(PyValueError::new_err(format!("no closed form '{other}'"))),
    })
}

type Columns<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Gains g1 and g2 of order 2 at samples 1..=count.
#[pyfunction]
fn order_2_gains(py: Python<'_>, forgetting_factor: f64, count: usize) -> PyResult<Columns<'_>> {
    let (level, slope) = gains::order_2_gains(forgetting_factor, count).map_err(|error| config_error(py, &error))?;
    Ok((level.into_pyarray(py), slope.into_pyarray(py)))
}

/// Taps of a windowed low-pass.
#[pyfunction]
fn fir_taps<'py>(py: Python<'py>, window: &str, length: f64, cutoff: f64) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let windows = stillrate::filters::fir::WINDOWS;
    let Some(window) = windows.iter().position(|name| *name == window) else {
        return Err(PyValueError::new_err(format!("window = '{window}' (must be one of {})", windows.join(", "))));
    };
    let defaults = FirLowPassSettings::defaults(1.0, GyroNoise::from_density_two_sided(1.0));
    let settings = FirLowPassSettings { window, length, cutoff_hz: cutoff, ..defaults };
    let (taps, count) = settings.designed().map_err(|error| config_error(py, &error))?;
    Ok(PyArray1::from_slice(py, &taps[..count]))
}

/// Steady-state responses of the filters with matched noise reduction.
#[pyfunction]
fn recursive_responses(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let rows = py.detach(matched::responses).map_err(|error| config_error(py, &error))?;
    let dicts = rows.into_iter().map(|(name, found)| -> PyResult<_> {
        let dict = PyDict::new(py);
        dict.set_item("name", name)?;
        dict.set_item("noise_ratio", found.noise_ratio)?;
        dict.set_item("delay", found.delay)?;
        dict.set_item("phase_delay", found.phase_delay)?;
        dict.set_item("half_power", found.half_power)?;
        dict.set_item("half", found.half)?;
        dict.set_item("nine_tenths", found.nine_tenths)?;
        dict.set_item("settled", found.settled)?;
        dict.set_item("overshoot", found.overshoot)?;
        Ok(dict)
    });
    PyList::new(py, dicts.collect::<PyResult<Vec<_>>>()?)
}

/// The adaptive filters on the bench: one-euro is tuned on `tuning_seeds`, everything is judged on `seeds`.
#[pyfunction]
fn recursive_bench(
    py: Python<'_>,
    seeds: Vec<u64>,
    tuning_seeds: Vec<u64>,
    draws: usize,
) -> PyResult<Bound<'_, PyDict>> {
    let found = py.detach(|| -> Result<(OneEuroSettings, Vec<bench::Row>), ConfigError> {
        let one_euro = bench::tune_one_euro(draws, 1, &tuning_seeds);
        let rows = bench::table(&seeds, &one_euro)?;
        Ok((one_euro, rows))
    });
    let (one_euro, rows) = found.map_err(|error| config_error(py, &error))?;
    let dict = PyDict::new(py);
    dict.set_item("scenarios", scenarios::SCENARIOS.iter().map(|(name, _)| *name).collect::<Vec<_>>())?;
    let tuned = (one_euro.minimum_cutoff_hz, one_euro.beta, one_euro.derivative_cutoff_hz);
    dict.set_item("one_euro", tuned)?;
    let rows: Vec<(String, Vec<f64>, f64)> = rows.into_iter().map(|row| (row.name, row.error, row.lag)).collect();
    dict.set_item("rows", rows)?;
    Ok(dict)
}

/// Motion, method and error an axis (deg/h) of the bias from two fixes.
#[pyfunction]
fn two_fix_table(py: Python<'_>, time_s: f64, dt_s: f64) -> PyResult<Vec<(&'static str, &'static str, [f64; 3])>> {
    let rows = py.detach(|| two_fixes::table(time_s, dt_s)).map_err(|error| config_error(py, &error))?;
    Ok(rows.into_iter().map(|row| (row.motion, row.method, row.error_deg_h)).collect())
}
