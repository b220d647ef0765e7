//! What the elementary functions need to know about a floating-point format: constants and a few bit patterns.

use crate::real::Real;

/// Constants and bit manipulations of one format; `P` below is its precision in bits (24 or 53).
pub(super) trait Format: Real {
    /// 1.5 * 2^(P-1): adding it rounds to an integer that then stands in the lowest bits.
    const SHIFT: Self;
    /// Smallest normal number.
    const SMALLEST_NORMAL: Self;
    /// 2^(P+1), which lifts every subnormal into the normal range.
    const LIFT: Self;
    /// P + 1.
    const LIFTED_BY: Self;
    /// An angle below it equals its sine and its tangent.
    const SMALL_ANGLE: Self;

    /// log2 e.
    const LOG2_E: Self;
    /// ln 2 to so few bits that its product with any binary exponent is exact.
    const LN_2_HIGH: Self;
    /// ln 2 less the above.
    const LN_2_LOW: Self;
    /// Below it e^x is zero.
    const EXPONENTIAL_LOW: Self;
    /// Magnitude to which the argument of 2^x is limited where it weighs probabilities.
    const DOUBLING_LIMIT: Self;
    /// Above it e^x is infinite.
    const EXPONENTIAL_HIGH: Self;
    /// From here downwards e^x - 1 is -1, and upwards of its magnitude tanh is 1.
    const NEGLIGIBLE: Self;

    /// (e^x - 1 - x) / x^2 for |x| <= ln(2)/2.
    const EXPONENTIAL: &'static [Self];
    /// 2^x for |x| <= 1/2.
    const DOUBLING: &'static [Self];
    /// (2 artanh s - 2 s) / s^3 in s^2, for s <= 3 - 2 sqrt 2.
    const LOGARITHM: &'static [Self];
    /// (sin(x)/x - 1) / x^2 in x^2, for |x| <= pi/4.
    const SINE: &'static [Self];
    /// (cos(x) - 1 + x^2/2) / x^4 in x^2, for |x| <= pi/4.
    const COSINE: &'static [Self];
    /// (arctan(x)/x - 1) / x^2 in x^2, for |x| <= 0.3.
    const ANGLE: &'static [Self];

    /// 2/pi.
    const INVERSE_QUARTER_TURN: Self;
    /// Leading parts of pi/2, each exact when multiplied by any count below [`Format::COARSE`] * 2.
    const QUARTER_TURN: &'static [Self];
    /// pi/2 less these parts.
    const QUARTER_TURN_REST: Self;
    /// Angles up to here are reduced with their full precision.
    const LARGEST_EXACT_ANGLE: Self;
    /// Quarter turns (a multiple of 4, a power of two) that larger angles are first reduced by.
    const COARSE: Self;
    /// From here on neighbouring numbers are a radian apart.
    const LARGEST_ANGLE: Self;

    /// arctan(1/2), pi/4, pi/2, pi: nearest number and remainder.
    const ARC_OF_HALF: (Self, Self);
    /// pi/4.
    const EIGHTH: (Self, Self);
    /// pi/2.
    const QUARTER: (Self, Self);
    /// pi.
    const HALF_TURN: (Self, Self);
    /// Above it [`Format::SHRINK`] is applied before a quotient.
    const HUGE: Self;
    /// A power of two that makes room for a sum of two huge numbers.
    const SHRINK: Self;
    /// Below it [`Format::GROW`] is applied before a quotient.
    const MINUTE: Self;
    /// A power of two that lifts both parts of a quotient out of the subnormal range.
    const GROW: Self;

    /// 2^k from k + [`Format::SHIFT`], for k within the normal exponents.
    fn power_of_two(shifted: Self) -> Self;
    /// m and k of a positive normal number m 2^k, sqrt(1/2) <= m < sqrt 2.
    fn mantissa_and_exponent(self) -> (Self, Self);
    /// The magnitude of `self` with the sign of `other`.
    fn with_sign_of(self, other: Self) -> Self;
    /// (s, c) turned by k quarter turns, from k + [`Format::SHIFT`].
    fn turned(shifted: Self, sine: Self, cosine: Self) -> (Self, Self);
}

/// Neither NaN; the infinities are numbers.
#[inline(always)]
#[allow(clippy::eq_op)]
pub(super) fn number<T: Format>(x: T) -> bool {
    x == x
}

/// Sum of the powers of `x`, by Horner's rule.
#[inline(always)]
pub(super) fn polynomial<T: Format>(x: T, coefficients: &'static [T]) -> T {
    let mut sum = T::ZERO;
    for &coefficient in coefficients.iter().rev() {
        sum = sum * x + coefficient;
    }
    sum
}

/// a + b and its rounding error, exactly (Knuth's two-sum).
#[inline(always)]
pub(super) fn two_sum<T: Format>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// a + b and its rounding error, exactly where a = 0 or |a| >= |b| (Dekker's fast two-sum).
#[inline(always)]
pub(super) fn ordered_sum<T: Format>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// Writes the bit manipulations of a format: number and integer type, bits below the exponent, bits of 1 and of
/// sqrt(1/2), bits of 2^(P-1) and its value with the exponent bias added.
macro_rules! bit_patterns {
    ($type:ident, $bits:ident, $mantissa:expr, $one:expr, $root_half:expr, $integer:expr, $biased:expr) => {
        #[inline(always)]
        fn power_of_two(shifted: $type) -> $type {
            $type::from_bits((shifted.to_bits() << $mantissa).wrapping_add($one))
        }
        #[inline(always)]
        fn mantissa_and_exponent(self) -> ($type, $type) {
            let lifted = self.to_bits().wrapping_add($one - $root_half);
            let mantissa = (lifted & ((1 << $mantissa) - 1)).wrapping_add($root_half);
            let exponent = $type::from_bits($integer | (lifted >> $mantissa)) - $biased;
            ($type::from_bits(mantissa), exponent)
        }
        #[inline(always)]
        fn with_sign_of(self, other: $type) -> $type {
            const SIGN: $bits = 1 << ($bits::BITS - 1);
            $type::from_bits((self.to_bits() & !SIGN) | (other.to_bits() & SIGN))
        }
        #[inline(always)]
        fn turned(shifted: $type, sine: $type, cosine: $type) -> ($type, $type) {
            let turns = shifted.to_bits();
            let swap = (0 as $bits).wrapping_sub(turns & 1);
            let (s, c) = (sine.to_bits(), cosine.to_bits());
            let flip_sine = (turns & 2) << ($bits::BITS - 2);
            let flip_cosine = (turns.wrapping_add(1) & 2) << ($bits::BITS - 2);
            let new_sine = ((s & !swap) | (c & swap)) ^ flip_sine;
            let new_cosine = ((c & !swap) | (s & swap)) ^ flip_cosine;
            ($type::from_bits(new_sine), $type::from_bits(new_cosine))
        }
    };
}
pub(super) use bit_patterns;
