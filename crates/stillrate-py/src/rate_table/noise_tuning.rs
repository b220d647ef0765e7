//! The tuning of Q/R and of the bank over records, and the small filters that it scores.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate_lab::rate_table::errors::Errors;
use stillrate_lab::tune::gain_ratio::{Criterion, GainRatio, Walk};
use stillrate_lab::tune::objective::{Objective, Progress};
use stillrate_lab::tune::records::Record;
use stillrate_lab::tune::track;
use stillrate_lab::tune::tuned::Tuned;
use stillrate_lab::tune::tuned_bank::tune_bank as tune_bank_on;

use super::search::{ask, method_from};
use super::{slice, value_error};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(kalman_random_walk, module)?)?;
    module.add_function(wrap_pyfunction!(kalman_track, module)?)?;
    module.add_function(wrap_pyfunction!(compare_rates, module)?)?;
    module.add_function(wrap_pyfunction!(tune_noise, module)?)?;
    module.add_function(wrap_pyfunction!(tune_bank, module)?)?;
    module.add_class::<NoiseObjective>()
}

/// Mean squared and mean absolute difference.
#[pyfunction]
fn compare_rates(estimate: PyReadonlyArray1<'_, f64>, truth: PyReadonlyArray1<'_, f64>) -> PyResult<(f64, f64)> {
    let (estimate, truth) = (slice(&estimate)?, slice(&truth)?);
    if estimate.len() != truth.len() || truth.is_empty() {
        return Err(value_error(format!(
            "{} estimates for {} true rates (must be as many)",
            estimate.len(),
            truth.len()
        )));
    }
    let errors = Errors::of(estimate, truth);
    Ok((errors.mse, errors.mae))
}

/// Rate, variance and gain of the scalar random-walk filter, with the score of its innovations, R^ and the settled gain.
#[pyfunction]
fn kalman_random_walk<'py>(
    py: Python<'py>,
    measured: PyReadonlyArray1<'py, f64>,
    process_noise: f64,
    measurement_variance: f64,
    start_rate: f64,
    start_variance: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let z = slice(&measured)?;
    let run = track::random_walk(z, process_noise, measurement_variance, start_rate, start_variance);
    let run = run.map_err(value_error)?;
    let dict = PyDict::new(py);
    dict.set_item("rate_dps", PyArray1::from_vec(py, run.rate))?;
    dict.set_item("variance", PyArray1::from_vec(py, run.variance))?;
    dict.set_item("gain", PyArray1::from_vec(py, run.gain))?;
    dict.set_item("innovation", run.innovation)?;
    dict.set_item("implied_variance", run.implied_variance)?;
    dict.set_item("settled_gain", run.settled_gain)?;
    Ok(dict)
}

/// Rate of the small filter of a given log10(Q/R).
#[pyfunction]
fn kalman_track<'py>(
    py: Python<'py>,
    measured: PyReadonlyArray1<'py, f64>,
    model: &str,
    log10_ratio: f64,
    period_s: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let rate = track::track(walk_from(model)?, log10_ratio, period_s, slice(&measured)?);
    Ok(PyArray1::from_vec(py, rate))
}

fn walk_from(model: &str) -> PyResult<Walk> {
    match model {
        "random-walk" => Ok(Walk::RandomWalk),
        "rate-acceleration" => Ok(Walk::RateAcceleration),
        other => Err(value_error(format!("model = {other:?} (must be 'random-walk', 'rate-acceleration' or 'imm')"))),
    }
}

/// Records owned for the time of a search, and the objective over them.
#[pyclass(module = "stillrate._native")]
struct NoiseObjective {
    measured: Vec<Vec<f64>>,
    truth: Option<Vec<Vec<f64>>>,
    walk: Walk,
    criterion: Criterion,
    period_s: f64,
}

impl NoiseObjective {
    fn records(&self) -> Vec<Record<'_>> {
        let truth = |k: usize| self.truth.as_ref().map(|t| t[k].as_slice());
        self.measured.iter().enumerate().map(|(k, y)| Record { measured: y, truth: truth(k) }).collect()
    }

    fn over<'a>(&self, records: &'a [Record<'a>]) -> GainRatio<'a> {
        GainRatio { records, walk: self.walk, criterion: self.criterion, period_s: self.period_s }
    }
}

#[pymethods]
impl NoiseObjective {
    #[new]
    fn new(
        measured: Vec<PyReadonlyArray1<'_, f64>>,
        truth: Option<Vec<PyReadonlyArray1<'_, f64>>>,
        model: &str,
        criterion: &str,
        period_s: f64,
    ) -> PyResult<Self> {
        let own = |arrays: &[PyReadonlyArray1<'_, f64>]| {
            arrays.iter().map(|a| slice(a).map(<[f64]>::to_vec)).collect::<PyResult<Vec<_>>>()
        };
        let criterion = match criterion {
            "innovation" => Criterion::Innovation,
            "truth" => Criterion::Truth,
            other => return Err(value_error(format!("objective = {other:?} (must be 'innovation' or 'truth')"))),
        };
        let objective = Self {
            measured: own(&measured)?,
            truth: truth.as_deref().map(own).transpose()?,
            walk: walk_from(model)?,
            criterion,
            period_s,
        };
        if let Some(truth) = objective.truth.as_ref().filter(|truth| truth.len() != objective.measured.len()) {
            return Err(value_error(format!("{} true records for {} measured", truth.len(), objective.measured.len())));
        }
        objective.over(&objective.records()).check().map_err(value_error)?;
        Ok(objective)
    }

    /// Whether something moves in at least one record.
    fn moving(&self) -> bool {
        self.records().iter().any(|record| record.moves(self.period_s))
    }

    /// Lower and upper end of log10(Q/R).
    fn range(&self) -> (f64, f64) {
        self.over(&[]).range()
    }

    /// Values at points of one dimension (log10 Q/R) or two (log10 Q, log10 R), given row after row.
    fn values<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray1<'py, f64>,
        dimensions: usize,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        if dimensions != 1 && dimensions != 2 {
            return Err(value_error(format!("dimensions = {dimensions} (must be 1 or 2)")));
        }
        let points = slice(&points)?;
        let values = py.detach(|| self.over(&self.records()).values(points, dimensions));
        Ok(PyArray1::from_vec(py, values))
    }

    /// Completes a point found elsewhere.
    fn finish<'py>(
        &self,
        py: Python<'py>,
        point: Vec<f64>,
        value: f64,
        evaluations: usize,
    ) -> PyResult<Bound<'py, PyDict>> {
        as_dict(py, &self.over(&self.records()).finish(&point, value, evaluations))
    }
}

fn as_dict<'py>(py: Python<'py>, tuned: &Tuned) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("log10_ratio", tuned.log10_ratio)?;
    dict.set_item("process_noise", tuned.process_noise)?;
    dict.set_item("measurement_variance", tuned.measurement_variance)?;
    dict.set_item("objective", tuned.value)?;
    dict.set_item("evaluations", tuned.evaluations)?;
    dict.set_item("moving", tuned.moving)?;
    dict.set_item("warnings", tuned.warnings())?;
    Ok(dict)
}

/// Asks the Python callback from a search that has let go of the interpreter.
fn asked(progress: Option<&Py<PyAny>>, state: &Progress) -> bool {
    progress.is_none_or(|callback| Python::attach(|py| ask(Some(callback.bind(py)), state)))
}

/// Tunes Q/R by Brent or QPSO.
#[pyfunction]
fn tune_noise<'py>(
    py: Python<'py>,
    objective: &NoiseObjective,
    method: &str,
    options: &Bound<'py, PyDict>,
    separate: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let method = method_from(method, options)?;
    let records = objective.records();
    let found =
        py.detach(|| objective.over(&records).tune(&method, separate, &mut |state| asked(progress.as_ref(), state)));
    as_dict(py, &found.map_err(value_error)?)
}

/// Tunes density and rate random walk of the recommended bank: (density, walk, objective, evaluations).
#[pyfunction]
fn tune_bank(
    py: Python<'_>,
    objective: &NoiseObjective,
    progress: Option<Py<PyAny>>,
) -> PyResult<(f64, f64, f64, usize)> {
    let report = &mut |state: &Progress| asked(progress.as_ref(), state);
    let found = py.detach(|| tune_bank_on(&objective.records(), objective.period_s, report));
    let found = found.map_err(value_error)?;
    let noise = found.noise;
    Ok((noise.density_dps_sqrt_hz, noise.rate_random_walk_dps_sqrt_s, found.value, found.evaluations))
}
