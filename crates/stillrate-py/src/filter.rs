//! `stillrate.Filter`: one class for every method.

use std::sync::{Mutex, MutexGuard};

use numpy::{Element, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use stillrate_lab::runner::{self, LastEstimate, Precision, Runner, Sink, Source, Timing};

use crate::convert::{config_error, precision_from, samples_from, settings_from, settings_to};
use crate::samples::{like, number_from, steps_from, trace_to_python, with_row};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Filter>()
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
/// >>> flt.models, flt.channels, flt.dtype, flt.config.sample_rate_hz
/// (9, 1, 'float64', 50.0)
///
/// A filter goes on where it stood, also after it was saved, and back to its start only on request:
///
/// >>> restored, twin = sr.Filter.restore(flt.save()), flt.copy()
/// >>> flt.update(0.2) == restored.update(0.2) == twin.update(0.2)
/// True
/// >>> flt.reset()
/// >>> round(flt.update(0.2), 9), twin.estimate.rate < 0.2  # the first sample of all stands for itself
/// (0.2, True)
#[pyclass(frozen, module = "stillrate")]
struct Filter {
    runner: Mutex<Box<dyn Runner>>,
    config: Py<PyAny>,
    /// Number of signals side by side.
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
        let precision = dtype.as_ref().map_or(Ok(Precision::Double), precision_from)?;
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
    ///
    /// Examples
    /// --------
    /// >>> import stillrate as sr
    /// >>> noise = sr.GyroNoise(density_dps_sqrt_hz=0.0151)
    /// >>> flt = sr.Filter(sr.Pt1(sample_rate_hz=50.0, noise=noise), channels=2)
    /// >>> flt.update(0.1, -0.2), flt.update(float("nan"), -0.2)  # over a missing sample it coasts
    /// ((0.1, -0.2), (0.1, -0.2))
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
        with_row(value, others, |row| {
            if row.len() != self.channels {
                let message = format!("{} samples for {} channels (one float a channel)", row.len(), self.channels);
                return Err(PyValueError::new_err(message));
            }
            self.lock().update(row, dt_s);
            Ok(PyTuple::new(py, &*row)?.into_any())
        })
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
        let input = samples_from(samples)?;
        let shape = input.shape();
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
        let source = input.source()?;
        if trace {
            let found = py.detach(|| self.lock().trace(source, timing));
            return trace_to_python(py, &found, shape, self.dtype);
        }
        let result = if self.dtype == "float32" {
            self.run_into(py, source, timing, shape, out, |slice| Sink::Single(slice))?
        } else {
            self.run_into(py, source, timing, shape, out, |slice| Sink::Double(slice))?
        };
        if out.is_none() { like(samples, result) } else { Ok(result) }
    }

    /// The last estimate, an `Estimate`; with several channels a tuple of them.
    #[getter]
    fn estimate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let class = py.import("stillrate.results")?.getattr("Estimate")?;
        let one = |last: LastEstimate| {
            let probability = PyTuple::new(py, last.probability)?;
            class.call1((last.rate, last.acceleration, last.variance, probability, last.frequency_hz, last.flags))
        };
        if self.channels == 1 {
            return one(self.lock().estimate(0));
        }
        // All of one sample, whatever another thread does meanwhile.
        let last: Vec<LastEstimate> = {
            let runner = self.lock();
            (0..self.channels).map(|channel| runner.estimate(channel)).collect()
        };
        Ok(PyTuple::new(py, last.into_iter().map(one).collect::<PyResult<Vec<_>>>()?)?.into_any())
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
    /// Filters into `out`, or into a new array, of the filter's own number type.
    fn run_into<'py, T: Element>(
        &self,
        py: Python<'py>,
        source: Source<'_>,
        timing: Timing<'_>,
        shape: &[usize],
        out: Option<&Bound<'py, PyAny>>,
        sink: for<'a> fn(&'a mut [T]) -> Sink<'a>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let output = match out {
            Some(out) => out
                .cast::<PyArrayDyn<T>>()
                .map_err(|_| PyTypeError::new_err(format!("out must be an array of {}", self.dtype)))?
                .clone(),
            None => PyArrayDyn::<T>::zeros(py, shape, false),
        };
        if output.shape() != shape {
            return Err(PyValueError::new_err("out must have the shape of the samples"));
        }
        {
            let mut writable = output
                .try_readwrite()
                .map_err(|_| PyValueError::new_err("out is not writable, or is the input itself"))?;
            let slice = writable.as_slice_mut().map_err(|_| PyValueError::new_err("out must be contiguous"))?;
            py.detach(|| self.lock().run(source, timing, sink(slice)));
        }
        Ok(output.into_any())
    }
}
