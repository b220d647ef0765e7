//! `stillrate.platform`: the servo platform in closed loop, its tuner, and drift propagation.
//!
//! Python hands over frozen configuration objects; their fields are read by name, arrays are copied once.

use numpy::{PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use stillrate::{ConfigError, GyroNoise};
use stillrate_lab::servo::PlatformDesign;
use stillrate_lab::servo::chain::{by_name, linear_equivalent};
use stillrate_lab::servo::family::standard;
use stillrate_lab::servo::measure;
use stillrate_lab::servo::open_loop::open_loop;
use stillrate_lab::servo::plant::{Plant, STATES};
use stillrate_lab::servo::platform::GyroErrors;
use stillrate_lab::servo::search::Effort;
use stillrate_lab::servo::study::{self, Row, Spread};
use stillrate_lab::servo::tuner::{self, Task};
use stillrate_lab::servo::warnings::warnings;
use stillrate_lab::settings_map::SettingsError;

use crate::convert::config_error;
use crate::servo_objects::{
    base_from, bench_from, chain_from, chain_to, controller_from, controller_to, design_from, family_from, number,
    plant_from,
};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(servo_plant, module)?)?;
    module.add_function(wrap_pyfunction!(servo_plant_fields, module)?)?;
    module.add_function(wrap_pyfunction!(servo_run, module)?)?;
    module.add_function(wrap_pyfunction!(servo_open_loop, module)?)?;
    module.add_function(wrap_pyfunction!(servo_families, module)?)?;
    module.add_function(wrap_pyfunction!(servo_tune, module)?)?;
    module.add_function(wrap_pyfunction!(servo_validate, module)?)?;
    module.add_function(wrap_pyfunction!(servo_tilt_table, module)?)
}

/// Numbers of a named parameter set, or of a design given as numbers by name.
#[pyfunction]
#[pyo3(signature = (name, design=None))]
fn servo_plant(py: Python<'_>, name: &str, design: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<f64>> {
    let plant = match (name, design) {
        ("camera-gimbal", _) => Plant::camera_gimbal(),
        (_, Some(d)) => PlatformDesign {
            mass_kg: number(d, "mass_kg")?,
            diameter_m: number(d, "diameter_m")?,
            arm_m: number(d, "arm_m")?,
            lead_m: number(d, "lead_m")?,
            motor_rpm: number(d, "motor_rpm")?,
            natural_frequency_hz: number(d, "natural_frequency_hz")?,
            motor_inertia_kg_m2: number(d, "motor_inertia_kg_m2")?,
            coupling_hz: number(d, "coupling_hz")?,
            half_backlash_deg: number(d, "half_backlash_deg")?,
            voltage_max_v: number(d, "voltage_max_v")?,
            current_max_a: number(d, "current_max_a")?,
        }
        .plant()
        .map_err(|e| config_error(py, &e))?,
        _ => Plant::platform_30kg(),
    };
    Ok(plant.numbers())
}

/// Name, symbol and unit of every number of a plant.
#[pyfunction]
fn servo_plant_fields() -> Vec<(&'static str, &'static str, &'static str)> {
    Plant::FIELDS.to_vec()
}

/// One axis: rows (tick, column), lost tick, out-of-stroke tick, warnings.
#[pyfunction]
fn servo_run<'py>(
    py: Python<'py>,
    setup: &Bound<'py, PyAny>,
    controller: &Bound<'py, PyAny>,
    filter: &Bound<'py, PyList>,
    base: &Bound<'py, PyAny>,
    gyro: &Bound<'py, PyAny>,
    times: (f64, f64, f64),
) -> PyResult<Bound<'py, PyDict>> {
    let bench = bench_from(setup)?;
    let chain = chain_from(filter)?;
    let base = base_from(base)?;
    let samples: PyReadonlyArray1<'_, f64> = gyro.getattr("samples_dps")?.extract()?;
    let errors = GyroErrors {
        white_sigma_rad_s: number(gyro, "white_sigma_dps")?.to_radians(),
        bias_rad_s: number(gyro, "bias_dps")?.to_radians(),
        scale_error: number(gyro, "scale_error")?,
        lsb_rad_s: number(gyro, "lsb_dps")?.to_radians(),
        seed: gyro.getattr("seed")?.extract()?,
        samples_rad_s: samples.as_array().iter().map(|v| if v.is_finite() { v.to_radians() } else { 0.0 }).collect(),
    };
    let (start_deg, reference_deg, duration_s) = times;
    let mut axis = bench.axis(controller_from(controller)?, 0.0).map_err(|e| config_error(py, &e))?;
    axis.angle_reference_rad = reference_deg.to_radians();
    axis.drive_range_rad = number(setup, "drive_range_deg")?.to_radians();
    let range = number(setup, "range_deg")?;
    let warnings = warnings(&axis, &base, &linear_equivalent(&chain), range);
    let record = py
        .detach(|| {
            let mut filter = by_name(&chain)?;
            Ok(axis.run(&mut *filter, &base, &errors, start_deg.to_radians(), duration_s)?)
        })
        .map_err(|e: SettingsError| config_error(py, &e))?;
    let found = PyDict::new(py);
    let rows: Vec<Vec<f64>> = record.rows.iter().map(|row| row.to_vec()).collect();
    found.set_item("record", table(py, &rows, 8)?)?;
    let residual = measure::residual(&record, 3.0, axis.period_s());
    found.set_item("residual_deg", (residual.rms_deg, residual.max_deg))?;
    found.set_item("lost_at", record.lost_at)?;
    found.set_item("out_of_stroke_at", record.out_of_stroke_at)?;
    found.set_item("warnings", warnings)?;
    Ok(found)
}

fn table<'py>(py: Python<'py>, rows: &[Vec<f64>], columns: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
    if rows.is_empty() {
        return Ok(PyArray2::zeros(py, [0, columns], false));
    }
    PyArray2::from_vec2(py, rows).map_err(|e| pyo3::exceptions::PyValueError::new_err(e.to_string()))
}

/// The plant alone under given voltages (one a period): states at the start and after every period.
#[pyfunction]
fn servo_open_loop<'py>(
    py: Python<'py>,
    plant: &Bound<'py, PyAny>,
    base: &Bound<'py, PyAny>,
    voltage: PyReadonlyArray1<'py, f64>,
    start: Vec<f64>,
    timing: (f64, usize),
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let plant = plant_from(plant)?;
    let base = base_from(base)?;
    let (dt, steps) = timing;
    let start: [f64; STATES] = start
        .try_into()
        .map_err(|_| config_error(py, &ConfigError::new("start", f64::NAN, "", "a list of 7 states")))?;
    let voltage: Vec<f64> = voltage.as_array().to_vec();
    let states = open_loop(&plant, &base, &voltage, start, dt, steps).map_err(|e| config_error(py, &e))?;
    let rows: Vec<Vec<f64>> = states.iter().map(|state| state.to_vec()).collect();
    table(py, &rows, STATES)
}

/// The study's filter families: (name, chain, open settings, linear).
#[pyfunction]
fn servo_families(py: Python<'_>, sample_rate_hz: f64, density: f64, walk: f64) -> PyResult<Bound<'_, PyList>> {
    let noise = GyroNoise { density_dps_sqrt_hz: density, rate_random_walk_dps_sqrt_s: walk };
    let list = PyList::empty(py);
    for family in standard(sample_rate_hz, noise) {
        let open: Vec<(usize, String, f64, f64, bool)> = family
            .open
            .iter()
            .map(|t| (t.link, t.field.clone(), t.range.low, t.range.high, t.range.logarithmic))
            .collect();
        list.append((&family.name, chain_to(py, &family.chain)?, open, family.linear))?;
    }
    Ok(list)
}

/// Tunes one family; `progress(evaluations)` may return False to stop.
#[pyfunction]
fn servo_tune<'py>(
    py: Python<'py>,
    bench: &Bound<'py, PyAny>,
    family: &Bound<'py, PyAny>,
    budget_percent: f64,
    effort: (usize, usize, u64),
    seeds: Vec<u64>,
    checks: Vec<u64>,
    starts: Vec<(Bound<'py, PyAny>, Vec<f64>)>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (bench, family) = (bench_from(bench)?, family_from(family)?);
    let (evaluations, restarts, seed) = effort;
    if restarts < 1 || evaluations < 4 * restarts {
        let error =
            ConfigError::new("evaluations", evaluations as f64, "", "at least 4 for each of at least 1 restart");
        return Err(config_error(py, &error));
    }
    let starts = starts.iter().map(|(gains, open)| design_from(gains, open.clone())).collect::<PyResult<_>>()?;
    let task = Task { budget_percent, effort: Effort { evaluations, restarts, seed }, seeds, checks, starts };
    let mut raised = None;
    let found = py.detach(|| {
        tuner::tune(&bench, &family, &task, &mut |done| {
            Python::attach(|py| {
                let answer = match &progress {
                    Some(call) => call.call1(py, (done,)).and_then(|a| a.extract::<Option<bool>>(py)),
                    None => Ok(None),
                };
                match answer.and_then(|a| py.check_signals().map(|()| a)) {
                    Ok(answer) => answer.unwrap_or(true),
                    Err(error) => {
                        raised = Some(error);
                        false
                    }
                }
            })
        })
    });
    if let Some(error) = raised {
        return Err(error);
    }
    let found = found.map_err(|e| config_error(py, &e))?;
    let dict = PyDict::new(py);
    dict.set_item("controller", controller_to(py, &found.design.controller)?)?;
    dict.set_item("parameters", found.design.parameters)?;
    dict.set_item("objective_deg", found.objective_deg)?;
    dict.set_item("feasible", found.feasible)?;
    dict.set_item("restarts_deg", found.restarts_deg)?;
    dict.set_item("tried", found.tried)?;
    Ok(dict)
}

/// A design's row in the table, measured on the given seeds.
#[pyfunction]
fn servo_validate<'py>(
    py: Python<'py>,
    bench: &Bound<'py, PyAny>,
    family: &Bound<'py, PyAny>,
    controller: &Bound<'py, PyAny>,
    parameters: Vec<f64>,
    seeds: Vec<u64>,
    margins: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let (bench, family) = (bench_from(bench)?, family_from(family)?);
    let design = design_from(controller, parameters)?;
    let row =
        py.detach(|| study::validate(&bench, &family, &design, &seeds, margins)).map_err(|e| config_error(py, &e))?;
    row_to(py, &row)
}

fn row_to<'py>(py: Python<'py>, row: &Row) -> PyResult<Bound<'py, PyDict>> {
    let spread = |s: &Spread| (s.mean, s.low, s.high);
    let dict = PyDict::new(py);
    dict.set_item("rms_deg", spread(&row.rms_deg))?;
    dict.set_item("max_deg", spread(&row.max_deg))?;
    dict.set_item("jitter_percent", row.jitter_percent)?;
    dict.set_item("jitter_seeds", spread(&row.jitter_seeds))?;
    dict.set_item("undisturbed_percent", row.undisturbed_percent)?;
    dict.set_item("motion_jitter_percent", row.motion_jitter_percent)?;
    dict.set_item("gain_margin", row.gain_margin)?;
    dict.set_item("delay_margin_ms", row.delay_margin_ms)?;
    dict.set_item("voltage_rms_percent", row.voltage_rms_percent)?;
    dict.set_item("levelling_deg", spread(&row.levelling_deg))?;
    dict.set_item("levelling_own_deg", spread(&row.levelling_own_deg))?;
    Ok(dict)
}

/// Peak angle of base tilts, deg, mean over both signs and the seeds.
#[pyfunction]
fn servo_tilt_table(
    py: Python<'_>,
    bench: &Bound<'_, PyAny>,
    family: &Bound<'_, PyAny>,
    controller: &Bound<'_, PyAny>,
    parameters: Vec<f64>,
    tilts_deg: Vec<f64>,
    duration_s: f64,
    seeds: Vec<u64>,
) -> PyResult<Vec<f64>> {
    let (bench, family) = (bench_from(bench)?, family_from(family)?);
    let design = design_from(controller, parameters)?;
    py.detach(|| study::tilt_table(&bench, &family, &design, &tilts_deg, duration_s, &seeds))
        .map_err(|e| config_error(py, &e))
}
