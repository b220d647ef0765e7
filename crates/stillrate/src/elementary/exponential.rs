//! e^x, e^x - 1 and tanh x.
//!
//! x = k ln 2 + r with |r| <= ln(2)/2 (Cody and Waite's two-part ln 2), e^r = 1 + r + r^2 P(r), then a scaling by 2^k.

use super::format::{Format, number, ordered_sum, polynomial, two_sum};

/// k + SHIFT, k, r and what is missing to e^r - 1 - r.
#[inline(always)]
fn reduced<T: Format>(x: T) -> (T, T, T, T) {
    let shifted = x * T::LOG2_E + T::SHIFT;
    let k = shifted - T::SHIFT;
    let high = x - k * T::LN_2_HIGH;
    let low = k * T::LN_2_LOW;
    let r = high - low;
    let missing = (high - r) - low;
    (shifted, k, r, r * r * polynomial(r, T::EXPONENTIAL) + missing)
}

/// e^x; 0 and infinity outside the range. A subnormal result is rounded twice (up to 1 unit), a normal one less than 0.8.
#[inline(always)]
pub(super) fn exponential<T: Format>(x: T) -> T {
    let (_, k, r, tail) = reduced(x.limited(T::EXPONENTIAL_LOW, T::EXPONENTIAL_HIGH));
    // Two factors, because 2^k alone may lie outside the normal numbers.
    let half = k * T::HALF + T::SHIFT;
    let rest = (k - (half - T::SHIFT)) + T::SHIFT;
    let result = (T::ONE + (r + tail)) * T::power_of_two(half) * T::power_of_two(rest);
    T::select(number(x), result, x)
}

/// 2^x for weights: limited to where the result and its products stay normal numbers; NaN reads as the smallest weight.
///
/// The base spares the reduction by ln 2, and Estrin's scheme shortens the polynomial's chain.
#[inline(always)]
pub(super) fn doubling<T: Format>(x: T) -> T {
    let x = x.most(-T::DOUBLING_LIMIT).least(T::DOUBLING_LIMIT);
    let shifted = x + T::SHIFT;
    let r = x - (shifted - T::SHIFT);
    let square = r * r;
    let fourth = square * square;
    let four = |c: &[T]| match *c {
        [a, b, c, d, ..] => (a + b * r) + (c + d * r) * square,
        [a, b, ..] => a + b * r,
        _ => T::ZERO,
    };
    let eight = |c: &[T]| match c.split_at_checked(4) {
        Some((low, high)) if !high.is_empty() => four(low) + four(high) * fourth,
        _ => four(c),
    };
    let sum = match T::DOUBLING.split_at_checked(8) {
        Some((low, high)) if !high.is_empty() => eight(low) + eight(high) * (fourth * fourth),
        _ => eight(T::DOUBLING),
    };
    sum * T::power_of_two(shifted)
}

/// e^x - 1 as a sum of two numbers, the first the rounded value and the second what it lacks; for x >= -[`Format::NEGLIGIBLE`].
#[inline(always)]
fn less_one_in_two<T: Format>(x: T) -> (T, T) {
    let (shifted, _, r, tail) = reduced(x);
    // Half of everything, so that 2^k stays a number up to the largest result.
    let scale = T::power_of_two(shifted - T::ONE);
    let (high, low) = ordered_sum(scale - T::HALF, scale * r);
    let (high, low) = ordered_sum(high, low + scale * tail);
    (T::TWO * high, T::TWO * low)
}

/// e^x - 1; -1 and infinity far out.
#[inline(always)]
pub(super) fn exponential_less_one<T: Format>(x: T) -> T {
    let (high, _) = less_one_in_two(x.limited(-T::NEGLIGIBLE, T::EXPONENTIAL_HIGH));
    // Halving loses bits of the smallest numbers, for which e^x - 1 = x; this also keeps -0 and NaN.
    let itself = !number(x) || x.magnitude() < T::EPSILON * T::EPSILON;
    T::select(itself, x, high)
}

/// tanh |x| = e / (e + 2) with e = exp(2|x|) - 1; the roundings of e and of e + 2 are put back.
#[inline(always)]
pub(super) fn tangent_hyperbolic<T: Format>(x: T) -> T {
    let (high, low) = less_one_in_two((x.magnitude() * T::TWO).limited(T::ZERO, T::NEGLIGIBLE));
    let below = high + T::TWO;
    let lost = two_sum(high, T::TWO).1;
    let quotient = high / below;
    // 2 / below = 1 - quotient spares a division.
    let correction = (low - quotient * (lost + low)) * ((T::ONE - quotient) * T::HALF);
    let itself = !number(x) || x.magnitude() < T::EPSILON * T::EPSILON;
    T::select(itself, x, (quotient + correction).with_sign_of(x))
}
