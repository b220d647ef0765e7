//! Before a run: its commands, its bound, the search for a better one.

use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate::gimbal::COUNT;
use stillrate_lab::gimbal::{self as lab, Sampling, Search, Trajectory};

use super::arrays::{Rows, table, triples};
use super::settings::{model_from, settings_from};
use crate::convert::config_error;

pub(super) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(gimbal_bound, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_trajectory, module)?)?;
    module.add_function(wrap_pyfunction!(gimbal_plan, module)?)
}

/// Cramer-Rao bound of a run before it is made.
#[pyfunction]
fn gimbal_bound<'py>(
    py: Python<'py>,
    command: PyReadonlyArray2<'py, f64>,
    dt_s: f64,
    sigma_m_s2: f64,
    half_window: usize,
    skip_jumps: bool,
    settings: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let settings = settings_from(py, settings)?;
    let commands = triples(&command, "command_rad_s")?;
    stillrate::error::positive("dt_s", dt_s, "s").map_err(|e| config_error(py, &e))?;
    stillrate::error::positive("sigma_m_s2", sigma_m_s2, "m/s^2").map_err(|e| config_error(py, &e))?;
    let indices = settings.indices().map_err(|e| config_error(py, &e))?;
    let sampling =
        Sampling { interval_s: dt_s, half_window, sigma_m_s2, skip_jumps, cut_off_rad: settings.cut_off_rad };
    let bound =
        py.detach(|| lab::bound(&settings.model, &settings.prior, &settings.scale, &indices, &commands, &sampling));
    let result = PyDict::new(py);
    result.set_item("deviation", PyArray1::from_slice(py, &bound.deviation))?;
    result.set_item("singular_values", PyArray1::from_slice(py, &bound.singular_values))?;
    result.set_item("directions", table(py, &bound.directions))?;
    result.set_item("indices", bound.indices.clone())?;
    result.set_item("kappa_deviation", bound.kappa_deviation)?;
    result.set_item("weakest", bound.weakest(5))?;
    result.set_item("unobservable", bound.unobservable(&settings.scale))?;
    Ok(result)
}

/// Commands of a tumbling programme, rad/s.
#[pyfunction]
fn gimbal_trajectory<'py>(
    py: Python<'py>,
    segments_deg_s: Option<PyReadonlyArray2<'py, f64>>,
    segment_s: f64,
    slew_deg_s2: f64,
    interval_s: f64,
    settings: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let model = model_from(py, settings)?;
    let segments_deg_s = match segments_deg_s {
        Some(array) => triples(&array, "segments_deg_s")?,
        None => lab::DEFAULT_SEGMENTS.to_vec(),
    };
    let trajectory = lab::Trajectory { segments_deg_s, segment_s, slew_deg_s2, interval_s };
    let commands = trajectory.commands(&model).map_err(|e| config_error(py, &e))?;
    Ok(table(py, &commands.iter().map(|c| c.to_vec()).collect::<Vec<_>>()))
}

/// A better trajectory within limits: segments and figures.
#[pyfunction]
fn gimbal_plan<'py>(
    py: Python<'py>,
    segments_deg_s: Option<PyReadonlyArray2<'py, f64>>,
    limits: (f64, f64, f64, f64),
    effort: (usize, usize, u64),
    kappa_weight: f64,
    sampling: (usize, f64),
    settings: &Bound<'py, PyDict>,
) -> PyResult<(Rows, Vec<f64>, Vec<f64>)> {
    let settings = settings_from(py, settings)?;
    let (rate_max_deg_s, slew_deg_s2, segment_s, interval_s) = limits;
    let (moves, climbs, seed) = effort;
    let start = Trajectory {
        segments_deg_s: match segments_deg_s {
            Some(array) => triples(&array, "segments_deg_s")?,
            None => lab::DEFAULT_SEGMENTS.iter().map(|s| s.map(|x| x * rate_max_deg_s)).collect(),
        },
        segment_s,
        slew_deg_s2,
        interval_s,
    };
    let sampling = Sampling { interval_s, half_window: sampling.0, sigma_m_s2: sampling.1, ..Sampling::default() };
    let indices = settings.indices().map_err(|e| config_error(py, &e))?;
    let search = Search { start, rate_max_deg_s, moves, climbs, kappa_weight, seed };
    let list = |f: &lab::Figures| vec![f.drift, f.g_sensitive, f.kappa, f.mounting, f.accelerometer];
    let found = py.detach(|| -> Result<_, stillrate::ConfigError> {
        let commands = search.start.commands(&settings.model)?;
        let zero = [0.0; COUNT];
        let at_start = lab::bound(&settings.model, &zero, &settings.scale, &indices, &commands, &sampling);
        let before = lab::figures(&at_start, &settings.scale);
        let (best, figures) = lab::plan(&settings.model, &settings.scale, &indices, &sampling, &search)?;
        Ok((best, before, figures))
    });
    let (best, before, after) = found.map_err(|e| config_error(py, &e))?;
    Ok((best.segments_deg_s.iter().map(|s| s.to_vec()).collect(), list(&before), list(&after)))
}
