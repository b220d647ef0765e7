//! Stretches of gyro samples between two instants, which need not be sample times when the clocks differ by a lag.

use nalgebra::Vector3;

use super::Unknowns;
use crate::attitude::preintegration::Preintegration;
use crate::error::ConfigError;
use crate::real::Real;

/// Durations of the gyro samples.
///
/// # Example
/// ```
/// use stillrate::attitude::Rotation;
/// use stillrate::attitude::reference_bias::{BiasSettings, Fix, Record, Steps, Unknowns, solve};
/// let rates = [[0.0, 0.0, 1e-3]; 4];
/// let fixes = [0, 4].map(|index| Fix { index, attitude: Rotation::identity() });
/// let bias = |steps| {
///     let found = solve(Record { rates: &rates, steps }, &fixes, &BiasSettings::default(), Unknowns::default(), |_| ());
///     found.map(|found: stillrate::attitude::reference_bias::BiasEstimate<f64>| found.unknowns.bias.z)
/// };
/// assert!((bias(Steps::Uniform(0.01))? - bias(Steps::Each(&[0.01, 0.02, 0.005, 0.01]))?).abs() < 1e-18);
/// assert!(bias(Steps::Each(&[0.01, 0.0, 0.01, 0.01])).is_err()); // time must move on
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub enum Steps<'a, T> {
    /// All the same, s.
    Uniform(T),
    /// One each, s.
    Each(&'a [T]),
}

/// Body rates, each constant over its sample: mean rates over the sample, as delta angles give them.
///
/// # Example
/// ```
/// use stillrate::attitude::reference_bias::{Record, Steps};
/// // Delta angles of 10 ms become rates by the division that made them.
/// let rates = [[1e-5, 0.0, -2e-5_f64]; 3].map(|angle| angle.map(|rad| rad / 0.01));
/// let record = Record { rates: &rates, steps: Steps::Uniform(0.01) };
/// assert_eq!(record.rates[2], [1e-3, 0.0, -2e-3]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Record<'a, T> {
    /// Rates, rad/s.
    pub rates: &'a [[T; 3]],
    /// Durations.
    pub steps: Steps<'a, T>,
}

/// A moment inside a record: `into` seconds after the start of sample `index`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moment<T> {
    index: usize,
    into: T,
}

/// What the gyro says about the time between two moments.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span<T> {
    pub(super) turn: Preintegration<T>,
    /// Corrected rates at the two ends.
    pub(super) first_rate: Vector3<T>,
    pub(super) last_rate: Vector3<T>,
}

impl<T: Real> Record<'_, T> {
    /// Checks that all rates are finite and time moves forward.
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        if let Steps::Each(steps) = self.steps
            && steps.len() != self.rates.len()
        {
            return Err(ConfigError::new("dt_s length", steps.len() as f64, "", "one entry a rate sample"));
        }
        for (k, rate) in self.rates.iter().enumerate() {
            for component in rate {
                if !component.finite() {
                    return Err(ConfigError::new("rate_rad_s", component.widen(), "rad/s", "finite in every sample"));
                }
            }
            let dt = self.dt(k);
            if !dt.finite() || dt <= T::ZERO {
                return Err(ConfigError::new("dt_s", dt.widen(), "s", "finite and > 0 in every sample"));
            }
        }
        Ok(())
    }

    fn dt(&self, k: usize) -> T {
        match self.steps {
            Steps::Uniform(dt) => dt,
            Steps::Each(steps) => steps.get(k).copied().unwrap_or(T::ZERO),
        }
    }

    /// The moment `lag` seconds after the start of sample `index` (before, if negative); `None` outside the record.
    pub(super) fn moment(&self, index: usize, lag: T) -> Option<Moment<T>> {
        let mut index = index;
        let mut left = lag;
        while left < T::ZERO {
            index = index.checked_sub(1)?;
            left += self.dt(index);
        }
        while left > T::ZERO && left >= self.dt(index) {
            left -= self.dt(index);
            index += 1;
            if index >= self.rates.len() && left > T::ZERO {
                return None;
            }
        }
        (index < self.rates.len() || left == T::ZERO).then_some(Moment { index, into: left })
    }

    /// The measured rate with bias and scale factor taken out.
    fn corrected(&self, k: usize, unknowns: &Unknowns<T>) -> Vector3<T> {
        let rate = Vector3::from(self.rates.get(k).copied().unwrap_or([T::ZERO; 3])) - unknowns.bias;
        let one = T::ONE;
        Vector3::new(
            rate.x / (one + unknowns.scale.x),
            rate.y / (one + unknowns.scale.y),
            rate.z / (one + unknowns.scale.z),
        )
    }

    /// Integrates from one moment to a later one.
    pub(super) fn span(&self, from: Moment<T>, to: Moment<T>, unknowns: &Unknowns<T>, with_scale: bool) -> Span<T> {
        let mut turn = Preintegration::new();
        let mut add = |k: usize, dt: T| {
            let rate = self.corrected(k, unknowns);
            if with_scale { turn.advance_with_scale(rate, dt) } else { turn.advance(rate, dt) }
        };
        if from.index == to.index {
            add(from.index, to.into - from.into);
        } else {
            add(from.index, self.dt(from.index) - from.into);
            for k in from.index + 1..to.index {
                add(k, self.dt(k));
            }
            if to.into > T::ZERO {
                add(to.index, to.into);
            }
        }
        let last = if to.into > T::ZERO { to.index } else { to.index.saturating_sub(1) };
        Span { turn, first_rate: self.corrected(from.index, unknowns), last_rate: self.corrected(last, unknowns) }
    }
}
