//! A filter that stands in the loop, one sample at a time.
//!
//! Loops run at 50 to 1000 Hz and spend their time in the plant, so one indirect call a tick costs nothing; the step
//! behind it is the library's own [`Filter::step`]. Rates are deg/s at a filter's edge, as everywhere in the
//! library.

use stillrate::{Filter, Sample};

use crate::runner::Runner;

/// A rate filter with its state.
///
/// # Example
/// ```
/// use stillrate_lab::servo::loop_filter::LoopFilter;
/// /// Half of what came before and half of what comes.
/// struct Halves(Option<f64>);
/// impl LoopFilter for Halves {
///     fn reset(&mut self) {
///         self.0 = None;
///     }
///     fn step(&mut self, rate_dps: f64) -> f64 {
///         let mean = 0.5 * (rate_dps + self.0.unwrap_or(rate_dps));
///         self.0 = Some(rate_dps);
///         mean
///     }
/// }
/// let mut filter = Halves(None);
/// assert_eq!([filter.step(1.0), filter.step(3.0)], [1.0, 2.0]);
/// filter.reset(); // every run of a platform begins so
/// assert_eq!(filter.step(5.0), 5.0);
/// ```
pub trait LoopFilter: Send {
    /// Back to the state before the first sample.
    fn reset(&mut self);
    /// One sample, deg/s in and out, one control period after the last.
    fn step(&mut self, rate_dps: f64) -> f64;
}

/// No filter.
///
/// # Example
/// ```
/// use stillrate_lab::servo::loop_filter::{LoopFilter, Unfiltered};
/// assert_eq!(Unfiltered.step(0.107), 0.107);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Unfiltered;

impl LoopFilter for Unfiltered {
    fn reset(&mut self) {}
    fn step(&mut self, rate_dps: f64) -> f64 {
        rate_dps
    }
}

/// A filter value with its state.
///
/// # Example
/// ```
/// use stillrate::filters::Pt1;
/// use stillrate_lab::servo::loop_filter::{InLoop, LoopFilter};
/// let mut filter = InLoop::new(Pt1::new(50.0, 5.3).unwrap());
/// assert_eq!(filter.step(1.0), 1.0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct InLoop<F: Filter<f64>> {
    filter: F,
    state: F::State,
}

impl<F: Filter<f64>> InLoop<F> {
    /// The filter at its start.
    pub fn new(filter: F) -> Self {
        Self { state: filter.start(), filter }
    }
}

impl<F: Filter<f64>> LoopFilter for InLoop<F> {
    fn reset(&mut self) {
        self.state = self.filter.start();
    }
    fn step(&mut self, rate_dps: f64) -> f64 {
        self.filter.step(&mut self.state, Sample { value: rate_dps, dt: self.filter.period() }).rate
    }
}

impl LoopFilter for Box<dyn Runner> {
    fn reset(&mut self) {
        (**self).reset();
    }
    fn step(&mut self, rate_dps: f64) -> f64 {
        let mut value = [rate_dps];
        self.update(&mut value, None);
        value[0]
    }
}
