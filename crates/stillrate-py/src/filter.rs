//! `stillrate.Filter`: one class for every method, and the functions that check settings.

use std::sync::{Mutex, MutexGuard};

use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use stillrate::models::SingerCoefficients;
use stillrate_lab::runner::{self, Precision, Runner, Sink, Source, Timing};

use crate::convert::{Samples, config_error, samples_from, settings_from, settings_to, table_of};
use crate::samples::{like, number_from, steps_from, trace_to_python};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Filter>()?;
    module.add_function(wrap_pyfunction!(resolve, module)?)?;
    module.add_function(wrap_pyfunction!(setting_range, module)?)?;
    module.add_function(wrap_pyfunction!(singer_coefficients, module)?)?;
    module.add_function(wrap_pyfunction!(method_names, module)?)
}

/// Names of all methods.
#[pyfunction]
fn method_names() -> Vec<&'static str> {
    runner::method_names()
}

/// r, s, q11, q12, q22 of a Singer model for unit driving noise.
#[pyfunction]
fn singer_coefficients(alpha_per_s: f64, dt_s: f64, single: bool) -> (f64, f64, f64, f64, f64) {
    if single {
        let c = SingerCoefficients::new(alpha_per_s as f32, dt_s as f32);
        (c.r.into(), c.s.into(), c.q11.into(), c.q12.into(), c.q22.into())
    } else {
        let c = SingerCoefficients::new(alpha_per_s, dt_s);
        (c.r, c.s, c.q11, c.q12, c.q22)
    }
}

/// Checks settings and returns them complete.
#[pyfunction]
fn resolve<'py>(py: Python<'py>, method: &str, settings: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyDict>> {
    let map = settings_from(settings)?;
    let runner = runner::build(method, &map, 1, Precision::Double).map_err(|error| config_error(py, &error))?;
    settings_to(py, &runner.settings())
}

/// What a setting may be: smallest and largest value, the range in words, and its unit; None for words and unknown settings.
#[pyfunction]
fn setting_range(method: &str, name: &str) -> Option<(f64, f64, &'static str, &'static str)> {
    stillrate::ranges::range_of(method, name).map(|range| (range.low, range.high, range.words, range.unit))
}

/// A filter with its channels: one class for every method.
///
/// Parameters
/// ----------
/// config : Config
///     What to run, such as ``MsImmIkf(...)``; checked when it was built, so that nothing fails here.
/// channels : int, optional
///     How many signals side by side, each with a state of its own; default 1.
/// dtype : {"float64", "float32"}, optional
///     Number type of the computation and of the output; samples of either type are taken.
///
/// Examples
/// --------
/// >>> import stillrate as sr
/// >>> noise = sr.GyroNoise(density_dps_sqrt_hz=0.0151)
/// >>> flt = sr.Filter(sr.MsImmIkf(sample_rate_hz=50.0, noise=noise))
/// >>> flt.run([0.1, 0.0, float("nan"), 0.1]).shape
/// (4,)
#[pyclass(frozen, module = "stillrate")]
struct Filter {
    runner: Mutex<Box<dyn Runner>>,
    config: Py<PyAny>,
    /// How many signals run side by side.
    #[pyo3(get)]
    channels: usize,
    /// Number type of the computation and of the output, "float64" or "float32".
    #[pyo3(get)]
    dtype: &'static str,
}

impl Filter {
    fn lock(&self) -> MutexGuard<'_, Box<dyn Runner>> {
        // A step cannot panic, so a poisoned lock would still hold a valid state.
        self.runner.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    fn wrap(py: Python<'_>, runner: Box<dyn Runner>, config: Option<Py<PyAny>>) -> PyResult<Self> {
        let config = if let Some(config) = config {
            config
        } else {
            let settings = settings_to(py, &runner.settings())?;
            let rebuild = py.import("stillrate.config")?.getattr("config_from_settings")?;
            rebuild.call1((runner.method(), settings))?.unbind()
        };
        let dtype = match runner.precision() {
            Precision::Single => "float32",
            Precision::Double => "float64",
        };
        Ok(Self { channels: runner.channels(), dtype, runner: Mutex::new(runner), config })
    }
}

#[pymethods]
impl Filter {
    #[new]
    #[pyo3(signature = (config, channels=1, dtype=None))]
    fn new(py: Python<'_>, config: Py<PyAny>, channels: usize, dtype: Option<Bound<'_, PyAny>>) -> PyResult<Self> {
        let bound = config.bind(py);
        let Ok(settings) = bound.call_method0("settings") else {
            return Err(PyTypeError::new_err("config must be a stillrate configuration, such as MsImmIkf(...)"));
        };
        let method: String = bound.getattr("method")?.extract()?;
        let map = settings_from(settings.cast()?)?;
        let precision = match dtype {
            None => Precision::Double,
            Some(dtype) => match py
                .import("numpy")?
                .getattr("dtype")?
                .call1((dtype,))?
                .getattr("name")?
                .extract::<String>()?
                .as_str()
            {
                "float32" => Precision::Single,
                "float64" => Precision::Double,
                other => return Err(PyValueError::new_err(format!("dtype = {other} (must be float32 or float64)"))),
            },
        };
        let runner = runner::build(&method, &map, channels, precision).map_err(|error| config_error(py, &error))?;
        Self::wrap(py, runner, Some(config))
    }

    /// The configuration this filter was built from.
    #[getter]
    fn config(&self, py: Python<'_>) -> Py<PyAny> {
        self.config.clone_ref(py)
    }

    /// Number of models that run side by side (1 for a plain filter).
    #[getter]
    fn models(&self) -> usize {
        self.lock().models()
    }

    /// Take one sample of each channel and return the filtered one; a step never fails.
    ///
    /// Parameters
    /// ----------
    /// value, *others : float
    ///     One number a channel, or one array of them; NaN or infinite is a missing sample: the filter coasts.
    /// dt_s : float, optional
    ///     Time since the last sample in s; default one nominal period.
    ///
    /// Returns
    /// -------
    /// float or tuple of float
    ///     The filtered rate; with several channels, one each.
    #[pyo3(signature = (value, *others, dt_s=None))]
    fn update<'py>(
        &self,
        py: Python<'py>,
        value: &Bound<'py, PyAny>,
        others: &Bound<'py, PyTuple>,
        dt_s: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if self.channels == 1 && others.is_empty() {
            let mut sample = [number_from(value)?];
            self.lock().update(&mut sample, dt_s);
            return Ok(sample[0].into_pyobject(py)?.into_any());
        }
        // A row of ordinary size needs no heap.
        let mut short = [0.0; 16];
        let mut long = Vec::new();
        let row = if others.is_empty() {
            let row = value.try_iter().map_err(|_| self.count_error(1))?;
            for item in row {
                long.push(number_from(&item?)?);
            }
            long.as_mut_slice()
        } else {
            let count = 1 + others.len();
            let row = if count <= short.len() {
                &mut short[..count]
            } else {
                long.resize(count, 0.0);
                long.as_mut_slice()
            };
            row[0] = number_from(value)?;
            for (slot, other) in row[1..].iter_mut().zip(others) {
                *slot = number_from(&other)?;
            }
            row
        };
        if row.len() != self.channels {
            return Err(self.count_error(row.len()));
        }
        self.lock().update(row, dt_s);
        Ok(PyTuple::new(py, &*row)?.into_any())
    }

    /// Filter an array; the state goes on from the call before, so a record may come in pieces.
    ///
    /// Parameters
    /// ----------
    /// samples : array_like, shape (n,) or (n, channels)
    ///     Samples in deg/s (or any unit that the noise has too); NaN, infinite or masked ones are missing.
    /// dt_s : float or array_like, shape (n,), optional
    ///     Time since the sample before in s; default one nominal period.
    /// trace : bool, optional
    ///     Return a `Trace` with all that is known about every sample.
    /// out : ndarray, optional
    ///     Array for the result.
    ///
    /// Returns
    /// -------
    /// ndarray or Trace
    ///     As many samples as came in, of the same shape, all finite.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a shape does not fit.
    #[pyo3(signature = (samples, dt_s=None, trace=false, out=None))]
    fn run<'py>(
        &self,
        py: Python<'py>,
        samples: &Bound<'py, PyAny>,
        dt_s: Option<&Bound<'py, PyAny>>,
        trace: bool,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let given = samples;
        let samples = samples_from(given)?;
        let shape = match &samples {
            Samples::Single(array) => array.shape().to_vec(),
            Samples::Double(array) => array.shape().to_vec(),
        };
        let (rows, channels) = (shape[0], shape.get(1).copied().unwrap_or(1));
        if channels != self.channels {
            let message = format!(
                "samples have {channels} channels, the filter has {} (shape must be (n,) or (n, channels))",
                self.channels
            );
            return Err(PyValueError::new_err(message));
        }
        let steps: Option<Vec<f64>> = dt_s.map(|dt| steps_from(dt, rows)).transpose()?;
        let timing = steps.as_deref().map_or(Timing::Regular, Timing::Steps);
        let (single, double);
        let source = match &samples {
            Samples::Single(array) => {
                single = array.as_array();
                Source::Single(
                    table_of(&single)
                        .ok_or_else(|| PyValueError::new_err("samples must have one or two dimensions"))?,
                )
            }
            Samples::Double(array) => {
                double = array.as_array();
                Source::Double(
                    table_of(&double)
                        .ok_or_else(|| PyValueError::new_err("samples must have one or two dimensions"))?,
                )
            }
        };
        if trace {
            let found = py.detach(|| self.lock().trace(source, timing));
            return trace_to_python(py, &found, &shape, self.dtype);
        }
        macro_rules! filtered {
            ($type:ident, $variant:ident) => {{
                let fresh = out.is_none();
                let output = match out {
                    Some(out) => out
                        .cast::<PyArrayDyn<$type>>()
                        .map_err(|_| PyTypeError::new_err(concat!("out must be an array of ", stringify!($type))))?
                        .clone(),
                    None => PyArrayDyn::<$type>::zeros(py, shape.clone(), false),
                };
                if output.shape() != shape {
                    return Err(PyValueError::new_err("out must have the shape of the samples"));
                }
                {
                    let mut writable = output
                        .try_readwrite()
                        .map_err(|_| PyValueError::new_err("out is not writable, or is the input itself"))?;
                    let slice = writable.as_slice_mut().map_err(|_| PyValueError::new_err("out must be contiguous"))?;
                    py.detach(|| self.lock().run(source, timing, Sink::$variant(slice)));
                }
                if fresh { like(given, output.into_any()) } else { Ok(output.into_any()) }
            }};
        }
        if self.dtype == "float32" { filtered!(f32, Single) } else { filtered!(f64, Double) }
    }

    /// The last estimate, an `Estimate`; with several channels a tuple of them.
    #[getter]
    fn estimate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let class = py.import("stillrate.results")?.getattr("Estimate")?;
        let one = |channel| -> PyResult<Bound<'py, PyAny>> {
            let last = self.lock().estimate(channel);
            let probability = PyTuple::new(py, last.probability)?;
            class.call1((last.rate, last.acceleration, last.variance, probability, last.frequency_hz, last.flags))
        };
        if self.channels == 1 {
            return one(0);
        }
        Ok(PyTuple::new(py, (0..self.channels).map(one).collect::<PyResult<Vec<_>>>()?)?.into_any())
    }

    /// Return to the state before the first sample.
    fn reset(&self) {
        self.lock().reset();
    }

    /// Return configuration and state as versioned, checksummed bytes.
    fn save<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.lock().save())
    }

    /// Build a filter that continues where the saved one stood; bytes that do not fit are refused.
    #[staticmethod]
    fn restore(py: Python<'_>, blob: &[u8]) -> PyResult<Self> {
        let runner = runner::restore(blob).map_err(|error| config_error(py, &error))?;
        Self::wrap(py, runner, None)
    }

    /// Return a filter of the same configuration and state that goes its own way.
    fn copy(&self, py: Python<'_>) -> PyResult<Self> {
        let twin = self.lock().duplicate();
        Self::wrap(py, twin, Some(self.config.clone_ref(py)))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        // A plain function, so that a pickle names nothing but it.
        Ok((py.import("stillrate.saving")?.getattr("restore")?, (self.save(py),)))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let config = self.config.bind(py).repr()?;
        Ok(format!("Filter({}, channels={}, dtype='{}')", config.to_str()?, self.channels, self.dtype))
    }
}

impl Filter {
    fn count_error(&self, given: usize) -> PyErr {
        PyValueError::new_err(format!("{given} samples for {} channels (one float a channel)", self.channels))
    }
}
