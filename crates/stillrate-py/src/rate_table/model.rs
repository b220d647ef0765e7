//! The fitted model: made from a log, from points, from a network or from a file's text; evaluated over arrays.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stillrate::Flags;
use stillrate::correction::HIDDEN;
use stillrate_lab::rate_table::candidate::{Candidate, from_network};
use stillrate_lab::rate_table::fit::{self, Fit, Options};
use stillrate_lab::rate_table::model::ErrorModel;
use stillrate_lab::rate_table::network::{Scaling, Shape};
use stillrate_lab::rate_table::plateaus;
use stillrate_lab::rate_table::points::{Log, Point};

use super::network::RateTableNetwork;
use super::{slice, value_error};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<RateTableModel>()?;
    module.add_function(wrap_pyfunction!(rate_table_fit, module)?)?;
    module.add_function(wrap_pyfunction!(rate_table_fit_points, module)?)?;
    module.add_function(wrap_pyfunction!(rate_table_plateaus, module)?)
}

/// A curve over rates (and temperatures).
#[pyclass(frozen, module = "stillrate._native")]
struct RateTableModel {
    model: ErrorModel,
}

type Corrected<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<bool>>);

#[pymethods]
impl RateTableModel {
    /// Reads the text of a model file.
    #[staticmethod]
    fn from_text(text: &str) -> PyResult<Self> {
        Ok(Self { model: ErrorModel::from_text(text).map_err(value_error)? })
    }

    /// A trained network with its scaling, unguarded.
    #[staticmethod]
    fn from_network(
        network: &RateTableNetwork,
        input_scaling: Vec<(f64, f64)>,
        output_scaling: (f64, f64),
    ) -> PyResult<Self> {
        let Shape { inputs, hidden, .. } = network.0.shape();
        if input_scaling.len() != inputs || inputs > 2 {
            return Err(value_error(format!(
                "{} scalings for {inputs} inputs (must be as many, 1 or 2)",
                input_scaling.len()
            )));
        }
        let scaling = Scaling { inputs: input_scaling, output: output_scaling };
        if hidden > HIDDEN {
            return Err(value_error(format!("{hidden} hidden units (must be at most {HIDDEN})")));
        }
        let curve = from_network(&network.0, &scaling, 1).checked().map_err(value_error)?;
        let model = ErrorModel {
            curve,
            kind: "network".into(),
            held_out_dps: 0.0,
            uncorrected_dps: 0.0,
            rates: 0,
            sample_rate_hz: None,
            slope_limit: fit::STEEPEST_SLOPE,
        };
        Ok(Self { model })
    }

    /// Text of the file.
    fn to_text(&self) -> String {
        self.model.to_text()
    }

    /// The same model with the sample rate of its log noted.
    fn with_sample_rate(&self, sample_rate_hz: f64) -> Self {
        Self { model: ErrorModel { sample_rate_hz: Some(sample_rate_hz), ..self.model.clone() } }
    }

    /// Error and edge flag at true rates.
    fn error<'py>(
        &self,
        py: Python<'py>,
        rates: PyReadonlyArray1<'py, f64>,
        temperatures: Option<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Corrected<'py>> {
        self.map(py, &rates, temperatures.as_ref(), |rate, t| self.model.curve.error([rate, t, 0.0]))
    }

    /// Corrected rate and edge flag of measured rates.
    fn correct<'py>(
        &self,
        py: Python<'py>,
        rates: PyReadonlyArray1<'py, f64>,
        temperatures: Option<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Corrected<'py>> {
        self.map(py, &rates, temperatures.as_ref(), |rate, t| {
            let corrected = self.model.curve.correct(rate, [t, 0.0]);
            (corrected.rate, corrected.flags)
        })
    }

    /// Slope of the error at true rates.
    fn slope<'py>(
        &self,
        py: Python<'py>,
        rates: PyReadonlyArray1<'py, f64>,
        temperatures: Option<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Corrected<'py>> {
        self.map(py, &rates, temperatures.as_ref(), |rate, t| (self.model.curve.slope([rate, t, 0.0]), Flags::NONE))
    }

    /// RMS of measured less true rate before and after correction, and the share outside the calibrated range.
    fn score(
        &self,
        measured: PyReadonlyArray1<'_, f64>,
        truth: PyReadonlyArray1<'_, f64>,
        temperatures: Option<PyReadonlyArray1<'_, f64>>,
    ) -> PyResult<(f64, f64, f64)> {
        let temperatures = temperatures.as_ref().map(slice).transpose()?;
        self.model.score(slice(&measured)?, slice(&truth)?, temperatures).map_err(value_error)
    }

    /// Steepest slope in range.
    fn steepest(&self) -> f64 {
        fit::steepest(&self.model.curve)
    }

    /// Raises if the curve is not to be used.
    fn guard(&self, limit: f64) -> PyResult<()> {
        fit::guard(&self.model.curve, limit).map_err(value_error)
    }

    /// What is known about the model.
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        let curve = &self.model.curve;
        let inputs = curve.inputs as usize;
        dict.set_item("kind", &self.model.kind)?;
        dict.set_item("held_out_dps", self.model.held_out_dps)?;
        dict.set_item("uncorrected_dps", self.model.uncorrected_dps)?;
        dict.set_item("rates", self.model.rates)?;
        dict.set_item("sample_rate_hz", self.model.sample_rate_hz)?;
        dict.set_item("slope_limit", self.model.slope_limit)?;
        dict.set_item("needs_temperature", self.model.needs_temperature())?;
        dict.set_item("low", curve.low[..inputs].to_vec())?;
        dict.set_item("high", curve.high[..inputs].to_vec())?;
        Ok(dict)
    }
}

impl RateTableModel {
    fn map<'py>(
        &self,
        py: Python<'py>,
        rates: &PyReadonlyArray1<'py, f64>,
        temperatures: Option<&PyReadonlyArray1<'py, f64>>,
        value: impl Fn(f64, f64) -> (f64, Flags),
    ) -> PyResult<Corrected<'py>> {
        let rates = slice(rates)?;
        let temperatures = temperatures.map(slice).transpose()?;
        if self.model.needs_temperature() && temperatures.is_none() {
            return Err(value_error("this model was calibrated with temperature: give temperature_c"));
        }
        if let Some(t) = temperatures.filter(|t| t.len() != rates.len()) {
            return Err(value_error(format!("{} temperatures for {} rates (must be as many)", t.len(), rates.len())));
        }
        let (out, flags): (Vec<f64>, Vec<bool>) = rates
            .iter()
            .enumerate()
            .map(|(k, rate)| {
                let (out, flags) = value(*rate, temperatures.map_or(0.0, |t| t[k]));
                (out, flags.has(Flags::EDGE_HELD))
            })
            .unzip();
        Ok((PyArray1::from_vec(py, out), PyArray1::from_vec(py, flags)))
    }
}

fn options(candidates: Option<Vec<String>>, steepest_slope: f64, seed: u64) -> PyResult<Options> {
    let candidates = match candidates {
        None => Candidate::ALL.to_vec(),
        Some(names) => {
            let mut chosen = Vec::new();
            for name in names {
                let found: Vec<Candidate> = Candidate::ALL
                    .into_iter()
                    .filter(|c| c.name() == name || (name == "network" && matches!(c, Candidate::Network(_))))
                    .collect();
                if found.is_empty() {
                    let known = "'offset', 'line', 'quadratic', 'cubic' or 'network'";
                    return Err(value_error(format!("candidate {name:?} (must be {known})")));
                }
                chosen.extend(found);
            }
            chosen
        }
    };
    if !(steepest_slope.is_finite() && steepest_slope > 0.0) {
        return Err(value_error(format!("slope_limit = {steepest_slope} (must be finite and > 0)")));
    }
    Ok(Options { candidates, steepest_slope, seed })
}

/// Fits a log: segments given as (first, end), or found from the true rate.
#[pyfunction]
#[pyo3(signature = (measured, truth, temperature, segments, candidates, slope_limit, seed))]
fn rate_table_fit<'py>(
    py: Python<'py>,
    measured: PyReadonlyArray1<'py, f64>,
    truth: PyReadonlyArray1<'py, f64>,
    temperature: Option<PyReadonlyArray1<'py, f64>>,
    segments: Option<Vec<(usize, usize)>>,
    candidates: Option<Vec<String>>,
    slope_limit: f64,
    seed: u64,
) -> PyResult<Bound<'py, PyDict>> {
    let temperature = temperature.as_ref().map(slice).transpose()?;
    let log = Log { measured: slice(&measured)?, truth: slice(&truth)?, temperature };
    let options = options(candidates, slope_limit, seed)?;
    let fitted = py.detach(|| {
        let points = match &segments {
            Some(segments) => log.points_of(segments)?,
            None => log.points()?,
        };
        fit::fit(points, &options)
    });
    result(py, &fitted.map_err(value_error)?, slope_limit)
}

/// Fits averaged points.
#[pyfunction]
#[pyo3(signature = (rates, errors, standard_errors, temperatures, candidates, slope_limit, seed))]
fn rate_table_fit_points(
    py: Python<'_>,
    rates: Vec<f64>,
    errors: Vec<f64>,
    standard_errors: Vec<f64>,
    temperatures: Option<Vec<f64>>,
    candidates: Option<Vec<String>>,
    slope_limit: f64,
    seed: u64,
) -> PyResult<Bound<'_, PyDict>> {
    let made = Point::means(&rates, &errors, &standard_errors, temperatures.as_deref()).map_err(value_error)?;
    let options = options(candidates, slope_limit, seed)?;
    let fitted = py.detach(|| fit::fit(made, &options));
    result(py, &fitted.map_err(value_error)?, slope_limit)
}

/// Segments of a log near given table rates: (first, end, rate).
#[pyfunction]
fn rate_table_plateaus(
    measured: PyReadonlyArray1<'_, f64>,
    rates: Vec<f64>,
    sample_rate_hz: f64,
) -> PyResult<Vec<(usize, usize, f64)>> {
    let found = plateaus::find(slice(&measured)?, &rates, sample_rate_hz).map_err(value_error)?;
    Ok(found.iter().map(|p| (p.first, p.end, p.rate)).collect())
}

fn result<'py>(py: Python<'py>, fit: &Fit, slope_limit: f64) -> PyResult<Bound<'py, PyDict>> {
    let model = ErrorModel { slope_limit, ..ErrorModel::from(fit) };
    let dict = PyDict::new(py);
    let scores: Vec<_> =
        fit.scores.iter().map(|s| (s.candidate.name(), s.held_out, s.residual, s.slope, s.refused.clone())).collect();
    dict.set_item("scores", scores)?;
    let column = |value: &dyn Fn(&Point) -> f64| PyArray1::from_iter(py, fit.points.iter().map(value));
    dict.set_item("rate", column(&|p| p.rate))?;
    dict.set_item("temperature", column(&|p| p.temperature.unwrap_or(f64::NAN)))?;
    dict.set_item("error", column(&|p| p.error))?;
    dict.set_item("standard_error", column(&|p| p.standard_error))?;
    dict.set_item("samples", column(&|p| p.samples as f64))?;
    dict.set_item("residual", column(&|p| p.error - model.curve.error([p.rate, p.temperature.unwrap_or(0.0), 0.0]).0))?;
    dict.set_item("model", Bound::new(py, RateTableModel { model })?)?;
    Ok(dict)
}
