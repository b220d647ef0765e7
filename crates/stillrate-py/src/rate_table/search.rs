//! Optimisers over Python callables.

use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use stillrate_lab::random::{Generator, SplitMix64};
use stillrate_lab::tune::brent::Brent;
use stillrate_lab::tune::minimise::{Method, minimise};
use stillrate_lab::tune::objective::{Minimum, Objective, Progress};
use stillrate_lab::tune::qpso::{Attractor, Bound as BoxBound, Qpso};

use super::value_error;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(uniforms, module)?)?;
    module.add_function(wrap_pyfunction!(minimise_callable, module)?)?;
    module.add_function(wrap_pyfunction!(qpso_trace, module)?)
}

/// The first numbers of the SplitMix64 generator, uniform in 0..1.
#[pyfunction]
fn uniforms(py: Python<'_>, seed: u64, count: usize) -> Bound<'_, PyArray1<f64>> {
    let mut generator = SplitMix64::new(seed);
    PyArray1::from_iter(py, (0..count).map(|_| generator.uniform()))
}

/// An objective in Python: an array (points, dimensions) in, as many values out.
struct Callable<'a, 'py> {
    function: &'a Bound<'py, PyAny>,
    failure: Option<PyErr>,
}

impl Objective for Callable<'_, '_> {
    fn values(&mut self, points: &[f64], dimensions: usize) -> Vec<f64> {
        let py = self.function.py();
        let call = || -> PyResult<Vec<f64>> {
            let rows = PyArray1::from_slice(py, points).reshape([points.len() / dimensions, dimensions])?;
            let values = self.function.call1((rows,))?;
            py.import("numpy")?.call_method1("ravel", (values,))?.extract()
        };
        call().unwrap_or_else(|error| {
            self.failure = Some(error);
            Vec::new()
        })
    }
}

/// Reads "brent" or "qpso" with its options.
pub(super) fn method_from(name: &str, options: &Bound<'_, PyDict>) -> PyResult<Method> {
    let mut brent = Brent::default();
    let mut qpso = Qpso::default();
    for (key, value) in options {
        let key: String = key.extract()?;
        match (name, key.as_str()) {
            ("brent", "grid") => brent.grid = value.extract()?,
            ("brent", "tolerance") => brent.tolerance = value.extract()?,
            (_, "iterations") => (brent.iterations, qpso.iterations) = (value.extract()?, value.extract()?),
            ("qpso", "particles") => qpso.particles = value.extract()?,
            ("qpso", "last_contraction") => qpso.last_contraction = value.extract()?,
            ("qpso", "first_contraction") => qpso.first_contraction = value.extract()?,
            ("qpso", "own_weight") => qpso.own_weight = value.extract()?,
            ("qpso", "swarm_weight") => qpso.swarm_weight = value.extract()?,
            ("qpso", "target") => qpso.target = value.extract()?,
            ("qpso", "seed") => qpso.seed = value.extract()?,
            ("qpso", "attractor") => {
                qpso.attractor = match value.extract::<String>()?.as_str() {
                    "ratio" => Attractor::Ratio,
                    "uniform" => Attractor::Uniform,
                    other => return Err(value_error(format!("attractor = {other:?} (must be 'ratio' or 'uniform')"))),
                }
            }
            ("qpso", "bound") => {
                qpso.bound = match value.extract::<String>()?.as_str() {
                    "clip" => BoxBound::Clip,
                    "reflect" => BoxBound::Reflect,
                    other => return Err(value_error(format!("bound = {other:?} (must be 'clip' or 'reflect')"))),
                }
            }
            _ => return Err(value_error(format!("method {name:?} has no option {key:?}"))),
        }
    }
    match name {
        "brent" => Ok(Method::Brent(brent)),
        "qpso" => Ok(Method::Qpso(qpso)),
        other => Err(value_error(format!("method = {other:?} (must be 'brent', 'qpso' or 'de')"))),
    }
}

/// Whether to go on, as the Python callback says (no answer is yes).
pub(super) fn ask(progress: Option<&Bound<'_, PyAny>>, state: &Progress) -> bool {
    let Some(progress) = progress else { return true };
    match progress.call1((state.iteration, state.evaluations, state.value)) {
        Ok(answer) => answer.is_none() || answer.is_truthy().unwrap_or(true),
        Err(_) => false,
    }
}

/// Finds a minimum of a Python callable: (point, value, evaluations).
#[pyfunction]
fn minimise_callable(
    objective: &Bound<'_, PyAny>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    method: &str,
    options: &Bound<'_, PyDict>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Vec<f64>, f64, usize)> {
    let method = method_from(method, options)?;
    let mut callable = Callable { function: objective, failure: None };
    let found = minimise(&mut callable, &lower, &upper, &method, &mut |state| ask(progress, state));
    match (callable.failure, found) {
        (Some(failure), _) => Err(failure),
        (None, Ok(Minimum { point, value, evaluations })) => Ok((point, value, evaluations)),
        (None, Err(error)) => Err(value_error(error)),
    }
}

/// Every iteration of a swarm driven by given uniform numbers.
#[pyfunction]
fn qpso_trace<'py>(
    py: Python<'py>,
    objective: &Bound<'py, PyAny>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    options: &Bound<'py, PyDict>,
    uniforms: Vec<f64>,
) -> PyResult<Bound<'py, PyList>> {
    let Method::Qpso(qpso) = method_from("qpso", options)? else { return Err(value_error("not a swarm")) };
    let needed = qpso.particles * lower.len() * (1 + 4 * qpso.iterations);
    if uniforms.len() < needed {
        return Err(value_error(format!("{} uniform numbers (must be at least {needed})", uniforms.len())));
    }
    let mut callable = Callable { function: objective, failure: None };
    let mut swarms = Vec::new();
    let mut numbers = uniforms.into_iter();
    let mut uniform = || numbers.next().unwrap_or(0.5);
    let ran = qpso.run(&mut callable, &lower, &upper, &mut uniform, &mut |swarm| {
        swarms.push(swarm.clone());
        true
    });
    if let Some(failure) = callable.failure {
        return Err(failure);
    }
    ran.map_err(value_error)?;
    let list = PyList::empty(py);
    for swarm in swarms {
        let dict = PyDict::new(py);
        dict.set_item("iteration", swarm.iteration)?;
        dict.set_item("contraction", swarm.contraction)?;
        dict.set_item("mean_best", swarm.mean_best)?;
        dict.set_item("position", swarm.position)?;
        dict.set_item("value", swarm.value)?;
        dict.set_item("best", swarm.best)?;
        dict.set_item("swarm_best", swarm.swarm_best)?;
        dict.set_item("swarm_value", swarm.swarm_value)?;
        list.append(dict)?;
    }
    Ok(list)
}
