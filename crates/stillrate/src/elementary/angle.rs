//! The angle of a point, atan2.
//!
//! With t = smaller / larger of |x| and |y|: arctan t = arctan c + arctan((t - c) / (1 + c t)), c one of 0, 1/2 and 1, written as one
//! quotient of (smaller - c larger) over (larger + c smaller). c changes at t = 0.3 and 0.72, late enough for the numerator to be exact.
//! The constants pi/4, pi/2, pi are carried with their remainders to the last sum.

use super::format::{Format, number, ordered_sum, polynomial};

/// Angle of the point (x, y), -pi..=pi, with the conventions of IEEE 754 for zeros and infinities.
#[inline(always)]
pub(super) fn angle_over<T: Format>(y: T, x: T) -> T {
    let (across, along) = (y.magnitude(), x.magnitude());
    let steep = across > along;
    let (small, large) = within_reach(T::select(steep, along, across), T::select(steep, across, along));

    let beyond_first = small > T::of(0.3) * large;
    let beyond_second = small > T::of(0.72) * large;
    let c = T::select(beyond_second, T::ONE, T::select(beyond_first, T::HALF, T::ZERO));
    let pick = |first: T, second: T| T::select(beyond_second, second, T::select(beyond_first, first, T::ZERO));
    let t = (small - c * large) / (large + c * small);
    let z = t * t;
    let arc = t + t * z * polynomial(z, T::ANGLE);
    let (high, low) = ordered_sum(pick(T::ARC_OF_HALF.0, T::EIGHTH.0), arc);
    let low = low + pick(T::ARC_OF_HALF.1, T::EIGHTH.1);

    let (high, low) = reflected(steep, T::QUARTER, high, low);
    let left = T::ONE.with_sign_of(x) < T::ZERO;
    let (high, low) = reflected(left, T::HALF_TURN, high, low);
    T::select(number(x) && number(y), (high + low).with_sign_of(y), x + y)
}

/// whole - (high + low) where `condition` holds.
#[inline(always)]
fn reflected<T: Format>(condition: bool, whole: (T, T), high: T, low: T) -> (T, T) {
    let (difference, error) = ordered_sum(whole.0, -high);
    (T::select(condition, difference, high), T::select(condition, error + (whole.1 - low), low))
}

/// Scales both so that the sums and products that follow neither overflow nor vanish; settles 0/0 and the infinities.
#[inline(always)]
fn within_reach<T: Format>(small: T, large: T) -> (T, T) {
    let infinity = T::of(f64::INFINITY);
    let small = T::select(large == infinity, T::select(small == infinity, T::ONE, T::ZERO), small);
    let large = T::select(large == infinity || large == T::ZERO, T::ONE, large);
    let scale = T::select(large > T::HUGE, T::SHRINK, T::select(large < T::MINUTE, T::GROW, T::ONE));
    (small * scale, large * scale)
}
