//! Any filter followed by a rate-table error curve: the error is taken at the filtered rate, where it is not blurred by noise.

use crate::correction::curve::{ErrorCurve, INPUTS};
use crate::filter::{Estimate, Filter, Flags, Observer, Sample};
use crate::real::Real;
use crate::reals::Reals;

/// A filter whose output is corrected by an [`ErrorCurve`].
///
/// # Example
/// ```
/// use stillrate::{Filter, Sample, correction::{Compensated, ErrorCurve}, filters::Pt1};
/// let filter = Compensated { filter: Pt1::new(50.0, 8.0)?, curve: ErrorCurve::line(0.03, 0.0, -6.0, 6.0)? };
/// let mut state = filter.start();
/// let estimate = filter.step(&mut state, Sample { value: 1.03_f64, dt: 0.02 });
/// assert!((estimate.rate - 1.0).abs() < 1e-12);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Compensated<F, T> {
    /// What runs first.
    pub filter: F,
    /// What is subtracted from its rate.
    pub curve: ErrorCurve<T>,
}

/// State of [`Compensated`]: that of the filter, and the inputs that come along more slowly than the rate.
///
/// # Example
/// A curve that also depends on the temperature, and a sensor that warms up:
/// ```
/// use stillrate::{Filter, Sample, correction::{Compensated, ErrorCurve}, filters::Pt1};
/// let mut curve = ErrorCurve::line(0.0, 0.0, -6.0, 6.0)?;
/// curve.inputs = 2;
/// (curve.low[1], curve.high[1], curve.centre[1], curve.scale[1]) = (-10.0, 50.0, 20.0, 1.0 / 30.0);
/// curve.terms[2] = 0.3; // 0.3 deg/s over half the range
/// let filter = Compensated { filter: Pt1::new(50.0, 8.0)?, curve: curve.checked()? };
/// let mut state = filter.start();
/// assert_eq!(state.others[0], 20.0); // until it is told, the middle of the range
/// state.others[0] = 50.0;
/// let estimate = filter.step(&mut state, Sample { value: 1.3_f64, dt: 0.02 });
/// assert!((estimate.rate - 1.0).abs() < 1e-15);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct CompensatedState<S, T> {
    /// State of the filter.
    pub filter: S,
    /// The curve's second and third input (temperature, say): set them whenever they are measured.
    pub others: [T; INPUTS - 1],
}

impl<T: Real, S: Reals<T>> Reals<T> for CompensatedState<S, T> {
    const COUNT: usize = S::COUNT + INPUTS - 1;
    #[inline(always)]
    fn gather(next: &mut impl FnMut() -> T) -> Self {
        Self { filter: S::gather(next), others: <[T; INPUTS - 1] as Reals<T>>::gather(next) }
    }
    #[inline(always)]
    fn scatter(&self, put: &mut impl FnMut(T)) {
        self.filter.scatter(put);
        self.others.scatter(put);
    }
}

impl<T: Real, F: Filter<T>> Filter<T> for Compensated<F, T> {
    type State = CompensatedState<F::State, T>;

    /// Starts with the further inputs in the middle of their calibrated range.
    fn start(&self) -> Self::State {
        let middle = |i: usize| (self.curve.low[i] + self.curve.high[i]) * T::HALF;
        CompensatedState { filter: self.filter.start(), others: [middle(1), middle(2)] }
    }

    fn accepts(&self, state: &Self::State) -> bool {
        self.filter.accepts(&state.filter) && state.others.iter().all(|other| other.finite())
    }

    fn period(&self) -> T {
        self.filter.period()
    }

    fn models(&self) -> usize {
        self.filter.models()
    }

    #[inline(always)]
    fn observe<O: Observer<T>>(&self, state: &mut Self::State, sample: Sample<T>, observer: &mut O) -> Estimate<T> {
        let estimate = self.filter.observe(&mut state.filter, sample, observer);
        if estimate.flags.has(Flags::NO_DATA_YET) {
            return estimate;
        }
        let corrected = self.curve.correct(estimate.rate, state.others);
        Estimate { rate: corrected.rate, flags: estimate.flags.with(corrected.flags), ..estimate }
    }
}
