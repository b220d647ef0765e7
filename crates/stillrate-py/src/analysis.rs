//! Simulation, bounds, figures of merit, Allan deviation and noise from a log: slices in, dictionaries of arrays out.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate::ConfigError;
use stillrate_lab::allan::{self, AllanSettings, Figure, Taus};
use stillrate_lab::bounds;
use stillrate_lab::error::LogError;
use stillrate_lab::metrics;
use stillrate_lab::simulate::{Bed, BedKind, BedSettings, GyroNoiseModel};
use stillrate_lab::tune::{self, NoiseFromLog};

use crate::convert::{config_error, exception};

type Column<'py> = PyReadonlyArray1<'py, f64>;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(allan_deviation, module)?)?;
    module.add_function(wrap_pyfunction!(noise_from_log, module)?)?;
    module.add_function(wrap_pyfunction!(simulate_bed, module)?)?;
    module.add_function(wrap_pyfunction!(simulate_gyro, module)?)?;
    module.add_function(wrap_pyfunction!(best_at_rest, module)?)?;
    module.add_function(wrap_pyfunction!(rmse, module)?)?;
    module.add_function(wrap_pyfunction!(rms_about_mean, module)?)?;
    module.add_function(wrap_pyfunction!(nees_mean, module)?)?;
    module.add_function(wrap_pyfunction!(pit_variance, module)?)?;
    module.add_function(wrap_pyfunction!(lag_ms, module)?)?;
    module.add_function(wrap_pyfunction!(settling, module)?)
}

fn log_error(py: Python<'_>, error: LogError) -> PyErr {
    match error {
        LogError::Setting(error) => config_error(py, &error),
        LogError::TooShort { .. } => exception(py, "LogError", &error.to_string()),
    }
}

#[pyfunction]
fn allan_deviation<'py>(
    py: Python<'py>,
    z: Column<'py>,
    sample_rate_hz: f64,
    taus: &str,
    per_decade: usize,
    confidence: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let taus = match taus {
        "octave" => Taus::Octave,
        "dense" => Taus::PerDecade(per_decade),
        "all" => Taus::All,
        other => {
            let text = format!("taus = {other:?} (must be \"octave\", \"dense\" or \"all\")");
            return Err(config_error(py, &text));
        }
    };
    let z = z.as_slice()?;
    let settings = AllanSettings { taus, confidence };
    let curve = py.detach(|| allan::allan_with(z, sample_rate_hz, settings)).map_err(|error| log_error(py, error))?;
    let dict = PyDict::new(py);
    dict.set_item("tau_s", PyArray1::from_vec(py, curve.tau_s))?;
    dict.set_item("deviation", PyArray1::from_vec(py, curve.deviation))?;
    dict.set_item("lower", PyArray1::from_vec(py, curve.lower))?;
    dict.set_item("upper", PyArray1::from_vec(py, curve.upper))?;
    dict.set_item("fitted", PyArray1::from_vec(py, curve.fitted))?;
    dict.set_item("degrees_of_freedom", PyArray1::from_vec(py, curve.freedom))?;
    let figure = |f: Figure| (f.value, f.lower, f.upper);
    dict.set_item("angle_random_walk", figure(curve.angle_random_walk))?;
    dict.set_item("bias_instability", figure(curve.bias_instability))?;
    dict.set_item("rate_random_walk", figure(curve.rate_random_walk))?;
    dict.set_item("misfit", curve.misfit)?;
    Ok(dict)
}

fn noise_dict<'py>(py: Python<'py>, noise: &NoiseFromLog) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("density_dps_sqrt_hz", noise.density_dps_sqrt_hz)?;
    dict.set_item("rate_random_walk_dps_sqrt_s", noise.rate_random_walk_dps_sqrt_s)?;
    dict.set_item("lsb_dps", noise.lsb_dps)?;
    dict.set_item("quiet", (noise.quiet.start, noise.quiet.end))?;
    dict.set_item("moving_fraction", noise.moving_fraction)?;
    dict.set_item("motion_dominated", noise.motion_dominated)?;
    dict.set_item("reason", noise.reason.to_string())?;
    Ok(dict)
}

/// Figures of each channel, then the pair for a filter that they share.
#[pyfunction]
fn noise_from_log<'py>(
    py: Python<'py>,
    channels: Vec<Column<'py>>,
    sample_rate_hz: f64,
) -> PyResult<(Vec<Bound<'py, PyDict>>, (f64, f64))> {
    let slices = channels.iter().map(|z| z.as_slice()).collect::<Result<Vec<_>, _>>()?;
    let found = py
        .detach(|| slices.iter().map(|z| tune::noise_from_log(z, sample_rate_hz)).collect::<Result<Vec<_>, _>>())
        .map_err(|error| log_error(py, error))?;
    let shared = tune::shared_noise(&found).ok_or_else(|| exception(py, "LogError", "the record holds no channel"))?;
    Ok((found.iter().map(|noise| noise_dict(py, noise)).collect::<PyResult<_>>()?, shared))
}

/// The numbers of `GyroNoiseModel` in the order of the Python class.
type ModelNumbers = (f64, f64, f64, f64, f64, f64, f64, usize, f64);

fn model_from(numbers: ModelNumbers) -> GyroNoiseModel {
    GyroNoiseModel {
        density_dps_sqrt_hz: numbers.0,
        bias_sigma_dps: numbers.1,
        bias_time_s: numbers.2,
        rate_random_walk_dps_sqrt_s: numbers.3,
        lsb_dps: numbers.4,
        saturation_dps: numbers.5,
        missing_probability: numbers.6,
        gap_samples: numbers.7,
        bias_instability_dps: numbers.8,
    }
}

/// A bed as a dictionary of columns, with the clairvoyant estimate where there is one and it is asked for.
#[pyfunction]
fn simulate_bed<'py>(
    py: Python<'py>,
    kind: &str,
    sample_rate_hz: f64,
    seed: u64,
    duration_s: Option<f64>,
    waves_end_s: Option<f64>,
    noise: Option<ModelNumbers>,
    bound: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let kind = match kind {
        "static" => BedKind::Static,
        "waves" => BedKind::Waves,
        "rough-waves" => BedKind::RoughWaves,
        "steps" => BedKind::Steps,
        "chirp" => BedKind::Chirp,
        other => {
            let text =
                format!("kind = {other:?} (must be \"static\", \"waves\", \"rough-waves\", \"steps\" or \"chirp\")");
            return Err(config_error(py, &text));
        }
    };
    let mut settings = BedSettings::new(kind, sample_rate_hz, seed);
    settings.duration_s = duration_s.unwrap_or(settings.duration_s);
    settings.waves_end_s = waves_end_s.unwrap_or(settings.waves_end_s);
    settings.noise = noise.map_or(settings.noise, model_from);
    let run = || -> Result<(Bed, Option<bounds::Clairvoyant>), ConfigError> {
        let bed = settings.simulate()?;
        let best = if bound { bounds::clairvoyant(&bed) } else { None };
        Ok((bed, best))
    };
    let (bed, best) = py.detach(run).map_err(|error| config_error(py, &error))?;
    let dict = PyDict::new(py);
    dict.set_item("scored", (bed.scored.start, bed.scored.end))?;
    dict.set_item("calm", bed.calm.as_ref().map(|range| (range.start, range.end)))?;
    dict.set_item("t_s", PyArray1::from_vec(py, bed.t_s))?;
    dict.set_item("motion_dps", PyArray1::from_vec(py, bed.motion_dps))?;
    dict.set_item("drift_dps", PyArray1::from_vec(py, bed.drift_dps))?;
    dict.set_item("truth_dps", PyArray1::from_vec(py, bed.truth_dps))?;
    dict.set_item("measured_dps", PyArray1::from_vec(py, bed.measured_dps))?;
    let (rate, variance) = best.map_or((None, None), |b| (Some(b.rate_dps), Some(b.variance)));
    dict.set_item("bound_dps", rate.map(|x| PyArray1::from_vec(py, x)))?;
    dict.set_item("bound_variance", variance.map(|x| PyArray1::from_vec(py, x)))?;
    Ok(dict)
}

/// (measured, truth, drift) of a gyro that sees `motion_dps`.
#[pyfunction]
fn simulate_gyro<'py>(
    py: Python<'py>,
    motion_dps: Column<'py>,
    sample_rate_hz: f64,
    seed: u64,
    noise: ModelNumbers,
) -> PyResult<[Bound<'py, PyArray1<f64>>; 3]> {
    let (motion, model) = (motion_dps.as_slice()?, model_from(noise));
    let record = py.detach(|| model.record(motion, sample_rate_hz, seed)).map_err(|error| config_error(py, &error))?;
    Ok([record.measured_dps, record.truth_dps, record.drift_dps].map(|x| PyArray1::from_vec(py, x)))
}

/// (rate, variance) of the best linear filter for a gyro at rest.
#[pyfunction]
fn best_at_rest<'py>(
    py: Python<'py>,
    measured_dps: Column<'py>,
    sample_rate_hz: f64,
    noise: ModelNumbers,
) -> PyResult<[Bound<'py, PyArray1<f64>>; 2]> {
    let (z, model) = (measured_dps.as_slice()?, model_from(noise));
    let best = py
        .detach(|| bounds::best_filter_at_rest(z, &model, sample_rate_hz))
        .map_err(|error| config_error(py, &error))?;
    Ok([best.rate_dps, best.variance].map(|x| PyArray1::from_vec(py, x)))
}

/// Both columns, if they are equally long.
fn pair<'a>(a: &'a Column<'_>, b: &'a Column<'_>) -> PyResult<(&'a [f64], &'a [f64])> {
    let (a, b) = (a.as_slice()?, b.as_slice()?);
    if a.len() == b.len() {
        Ok((a, b))
    } else {
        Err(PyValueError::new_err(format!("columns of {} and {} samples (must be equally long)", a.len(), b.len())))
    }
}

#[pyfunction]
fn rmse(estimate: Column<'_>, truth: Column<'_>) -> PyResult<f64> {
    let (e, s) = pair(&estimate, &truth)?;
    Ok(metrics::rmse(e, s))
}

#[pyfunction]
fn rms_about_mean(z: Column<'_>) -> PyResult<f64> {
    Ok(metrics::rms_about_mean(z.as_slice()?))
}

#[pyfunction]
fn nees_mean(estimate: Column<'_>, truth: Column<'_>, variance: Column<'_>) -> PyResult<f64> {
    let (e, s) = pair(&estimate, &truth)?;
    let (_, v) = pair(&estimate, &variance)?;
    Ok(metrics::nees_mean(e, s, v))
}

/// Mean square normal score of samples under mixtures given row by row: (n, models) flattened.
#[pyfunction]
fn pit_variance(weights: Column<'_>, innovations: Column<'_>, variances: Column<'_>, models: usize) -> PyResult<f64> {
    let (c, nu) = pair(&weights, &innovations)?;
    let (_, s) = pair(&innovations, &variances)?;
    let models = models.max(1);
    let rows = c.chunks(models).zip(nu.chunks(models)).zip(s.chunks(models));
    let scores: Vec<f64> = rows.map(|((c, nu), s)| metrics::mixture_score(c, nu, s)).collect();
    Ok(metrics::pit_variance(&scores))
}

#[pyfunction]
fn lag_ms(
    py: Python<'_>,
    estimate: Column<'_>,
    truth: Column<'_>,
    sample_rate_hz: f64,
    max_lag_s: f64,
) -> PyResult<f64> {
    let (e, s) = pair(&estimate, &truth)?;
    Ok(py.detach(|| metrics::lag_ms(e, s, sample_rate_hz, max_lag_s)))
}

/// (peak, time in s) over samples start..end.
#[pyfunction]
fn settling(
    estimate: Column<'_>,
    truth: Column<'_>,
    sample_rate_hz: f64,
    start: usize,
    end: usize,
    band: f64,
) -> PyResult<(f64, f64)> {
    let (e, s) = pair(&estimate, &truth)?;
    let found = metrics::settling(e, s, sample_rate_hz, start..end, band);
    Ok((found.peak, found.time_s))
}
