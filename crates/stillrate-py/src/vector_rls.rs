//! Vector least squares of any order and precision, behind one class.

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Mutex;
use stillrate::filters::{VectorRls, VectorRlsSettings, VectorRlsState};
use stillrate::{ConfigError, Real};

use crate::convert::config_error;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<NativeVectorRls>()
}

/// Vector least squares of any order and precision.
trait AnyVectorRls: Send {
    fn step(&mut self, phi: &[f64], y: f64) -> (f64, f64, u32);
    fn weights(&self) -> Vec<f64>;
    fn covariance(&self) -> Vec<f64>;
    fn reset(&mut self);
}

struct Sized<T, const N: usize> {
    rls: VectorRls<T, N>,
    state: VectorRlsState<T, N>,
}

impl<T: Real, const N: usize> AnyVectorRls for Sized<T, N> {
    fn step(&mut self, phi: &[f64], y: f64) -> (f64, f64, u32) {
        let phi = core::array::from_fn(|k| T::of(phi.get(k).copied().unwrap_or(f64::NAN)));
        let seen = self.rls.step(&mut self.state, phi, T::of(y));
        (seen.prediction.widen(), seen.innovation.widen(), seen.flags.0)
    }
    fn weights(&self) -> Vec<f64> {
        self.state.weights.iter().map(|w| w.widen()).collect()
    }
    fn covariance(&self) -> Vec<f64> {
        self.state.covariance().iter().flatten().map(|p| p.widen()).collect()
    }
    fn reset(&mut self) {
        self.state = self.rls.start();
    }
}

fn sized<T: Real, const N: usize>(settings: VectorRlsSettings) -> Result<Box<dyn AnyVectorRls>, ConfigError> {
    let rls = VectorRls::<T, N>::new(settings)?;
    Ok(Box::new(Sized { rls, state: rls.start() }))
}

fn of_order<T: Real>(order: i64, settings: VectorRlsSettings) -> Result<Box<dyn AnyVectorRls>, ConfigError> {
    macro_rules! orders {
        ($($n:literal),*) => {
            match order {
                $($n => sized::<T, $n>(settings),)*
                _ => Err(ConfigError::new("order", order as f64, "", "a whole number from 1 to 16")),
            }
        };
    }
    orders!(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16)
}

#[pyclass(frozen, module = "stillrate._native")]
struct NativeVectorRls {
    inner: Mutex<Box<dyn AnyVectorRls>>,
    #[pyo3(get)]
    order: usize,
}

#[pymethods]
impl NativeVectorRls {
    #[new]
    fn new(
        py: Python<'_>,
        order: i64,
        forgetting_factor: f64,
        initial_covariance: f64,
        trace_max: f64,
        single: bool,
    ) -> PyResult<Self> {
        let settings = VectorRlsSettings { forgetting_factor, initial_covariance, trace_max };
        let built = if single { of_order::<f32>(order, settings) } else { of_order::<f64>(order, settings) };
        let inner = Mutex::new(built.map_err(|error| config_error(py, &error))?);
        Ok(Self { inner, order: order as usize })
    }

    /// One sample: prediction, innovation, flags.
    fn update(&self, phi: Vec<f64>, y: f64) -> PyResult<(f64, f64, u32)> {
        if phi.len() != self.order {
            return Err(PyValueError::new_err(format!("phi has {} entries (must be {})", phi.len(), self.order)));
        }
        Ok(self.lock().step(&phi, y))
    }

    /// Many samples: weights (n, order), prediction, innovation, flags, after each.
    #[allow(clippy::type_complexity)]
    fn run<'py>(
        &self,
        py: Python<'py>,
        phi: numpy::PyReadonlyArray2<'py, f64>,
        y: numpy::PyReadonlyArray1<'py, f64>,
    ) -> PyResult<(
        Bound<'py, PyArray2<f64>>,
        Bound<'py, PyArray1<f64>>,
        Bound<'py, PyArray1<f64>>,
        Bound<'py, PyArray1<u32>>,
    )> {
        let (phi, y) = (phi.as_array(), y.as_array());
        let (rows, columns) = phi.dim();
        if columns != self.order || y.len() != rows {
            let text = format!("phi is ({rows}, {columns}) and y ({},): must be (n, {}) and (n,)", y.len(), self.order);
            return Err(PyValueError::new_err(text));
        }
        let (phi, y): (Vec<f64>, Vec<f64>) = (phi.iter().copied().collect(), y.iter().copied().collect());
        let mut weights = Vec::with_capacity(phi.len());
        let (mut prediction, mut innovation, mut flags) = (Vec::new(), Vec::new(), Vec::new());
        py.detach(|| {
            let mut inner = self.lock();
            for (row, &value) in phi.chunks_exact(self.order).zip(&y) {
                let (p, e, f) = inner.step(row, value);
                prediction.push(p);
                innovation.push(e);
                flags.push(f);
                weights.extend(inner.weights());
            }
        });
        let weights = weights.into_pyarray(py).reshape([rows, columns])?;
        Ok((weights, prediction.into_pyarray(py), innovation.into_pyarray(py), flags.into_pyarray(py)))
    }

    /// Present weights.
    fn weights<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.lock().weights().into_pyarray(py)
    }

    /// Present covariance P.
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.lock().covariance().into_pyarray(py).reshape([self.order, self.order])
    }

    fn reset(&self) {
        self.lock().reset();
    }
}

impl NativeVectorRls {
    fn lock(&self) -> std::sync::MutexGuard<'_, Box<dyn AnyVectorRls>> {
        self.inner.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}
