//! ln x.
//!
//! x = m 2^k with sqrt(1/2) <= m < sqrt 2; with f = m - 1 and s = f / (2 + f), ln m = 2 artanh s = 2s + s^3 W(s^2), where
//! 2s = f - s f = f - f^2/2 + s f^2/2 keeps the two leading terms exact or nearly so.

use super::format::{Format, polynomial};

/// ln x; -infinity at 0, NaN below.
#[inline(always)]
pub(super) fn logarithm<T: Format>(x: T) -> T {
    let subnormal = x < T::SMALLEST_NORMAL;
    let (m, k) = T::select(subnormal, x * T::LIFT, x).mantissa_and_exponent();
    let k = k - T::select(subnormal, T::LIFTED_BY, T::ZERO);
    let f = m - T::ONE;
    let s = f / (T::TWO + f);
    let z = s * s;
    let half_square = T::HALF * f * f;
    let small = s * (half_square + z * polynomial(z, T::LOGARITHM)) + k * T::LN_2_LOW;
    let finite = k * T::LN_2_HIGH + (f - (half_square - small));
    let infinity = T::of(f64::INFINITY);
    let result = T::select(x < infinity, finite, x);
    let result = T::select(x == T::ZERO, -infinity, result);
    T::select(x < T::ZERO, T::of(f64::NAN), result)
}
