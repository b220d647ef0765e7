//! What the numbers of a state can be: asked of a state that comes from outside, never in a step.
//!
//! A step needs no such questions, because it leaves behind what it can go on from; each filter's [`accepts`](crate::Filter::accepts) says
//! with these what that is. Bounds on means keep their squares numbers, so that whatever follows is finite.

use crate::filter::{Filter, LONGEST_GAP_S, Sample};
use crate::gaussian::Gaussian2;
use crate::real::Real;

/// Correlations that rounding can leave in `f64`: where a measurement takes nearly all of a variance, few digits of the rest are known.
/// In `f32` that happens at every start from a wide prior, and a correlation says nothing.
const LARGEST_CORRELATION: f64 = 4.0;

/// Whether a number lies in `low..=high`.
pub(crate) fn within<T: Real>(x: T, low: T, high: T) -> bool {
    x >= low && x <= high
}

/// Whether a number is at most `most` in size.
pub(crate) fn at_most<T: Real>(x: T, most: T) -> bool {
    x.magnitude() <= most
}

/// Whether a number is a yes (1) or a no (0).
pub(crate) fn flag<T: Real>(x: T) -> bool {
    x == T::ZERO || x == T::ONE
}

/// The largest mean whose square is a number with room to spare.
pub(crate) fn largest_mean<T: Real>() -> T {
    T::LARGEST.root() * T::of(0.25)
}

/// Whether a number can be a mean.
pub(crate) fn mean<T: Real>(x: T) -> bool {
    at_most(x, largest_mean())
}

/// Whether a number can be a variance.
pub(crate) fn variance<T: Real>(x: T) -> bool {
    within(x, T::ZERO, T::LARGEST)
}

/// Whether a covariance can stand beside two variances.
pub(crate) fn covariance<T: Real>(cross: T, first: T, second: T) -> bool {
    let most = T::of(LARGEST_CORRELATION) * first.root() * second.root();
    at_most(cross, if T::BYTES == 8 { most } else { T::LARGEST })
}

/// Seconds that an acceleration of time constant 1/`alpha` is carried on for.
pub(crate) fn reach<T: Real>(alpha: T) -> T {
    (T::ONE / alpha).least(T::of(10.0))
}

/// Whether these can be rate and acceleration of a model that carries an acceleration on for at most `reach`.
pub(crate) fn gaussian2<T: Real>(x: &Gaussian2<T>, reach: T) -> bool {
    let [p00, p01, p11] = x.covariance;
    let carried = x.mean[0].magnitude() + reach * x.mean[1].magnitude();
    let spread = p00 + reach * reach * p11;
    mean(carried)
        && at_most(x.mean[1], T::LARGEST.root())
        && variance(p00)
        && variance(p11)
        && variance(spread)
        && covariance(p01, p00, p11)
}

/// Whether these can be means and a packed covariance of a filter that is renewed where it overflows, and whose mixing can leave cross terms
/// of any size: finite, and no variance (at `diagonal`) negative.
pub(crate) fn finite<T: Real>(means: &[T], covariance: &[T], diagonal: &[usize]) -> bool {
    means.iter().all(|&number| at_most(number, T::LARGEST))
        && covariance.iter().all(|&number| at_most(number, T::LARGEST))
        && diagonal.iter().all(|&at| covariance.get(at).is_some_and(|&number| variance(number)))
}

/// Whether a filter goes on from a state to finite estimates: over nothing, rest, both ends of its range in turn, and long gaps. For filters
/// that do not ask in a step whether they still hold their state.
pub(crate) fn goes_on<T: Real, F: Filter<T>>(filter: &F, state: &F::State, limit: T) -> bool {
    let (period, nothing) = (filter.period(), T::of(f64::NAN));
    let gap = T::of(0.9 * LONGEST_GAP_S).most(T::of(2.9) * period);
    [(nothing, period), (T::ZERO, period), (limit, period), (nothing, gap), (limit, gap)].into_iter().all(
        |(value, dt)| {
            let mut tried = *state;
            (0..16).all(|k| {
                let value = if k % 2 == 0 { value } else { -value };
                let estimate = filter.step(&mut tried, Sample { value, dt });
                let finite = estimate.rate.finite() && estimate.acceleration.finite();
                finite && within(estimate.variance, T::ZERO, T::LARGEST)
            })
        },
    )
}

/// Whether numbers can be probabilities of models of which one is right.
pub(crate) fn probabilities<T: Real>(numbers: impl Iterator<Item = T>) -> bool {
    let (mut sum, mut each) = (T::ZERO, true);
    for number in numbers {
        sum += number;
        each &= within(number, T::ZERO, T::ONE + T::of(1e-3));
    }
    each && at_most(sum - T::ONE, T::of(1e-3))
}
