//! sin x and cos x together.
//!
//! x = n pi/2 + r with |r| <= pi/4: pi/2 is split into short parts (Cody and Waite) whose products with n are exact, the
//! differences carry their rounding errors along, so r comes with a remainder and is right even next to a multiple of pi/2.

use super::format::{Format, polynomial, two_sum};

/// (sin x, cos x); NaN for NaN and the infinities.
#[inline(always)]
pub(super) fn sine_cosine<T: Format>(x: T) -> (T, T) {
    let near = T::select(x.magnitude() <= T::LARGEST_EXACT_ANGLE, x, without_whole_turns(x));
    let shifted = near * T::INVERSE_QUARTER_TURN + T::SHIFT;
    let n = shifted - T::SHIFT;
    let mut r = near;
    let mut missing = T::ZERO;
    for &part in T::QUARTER_TURN {
        let (difference, error) = two_sum(r, -(n * part));
        r = difference;
        missing += error;
    }
    let (r, missing) = two_sum(r, missing - n * T::QUARTER_TURN_REST);
    let z = r * r;
    let half_square = z * T::HALF;
    let first = T::ONE - half_square;
    let sine = r + (r * z * polynomial(z, T::SINE) + missing * first);
    let cosine = first + (((T::ONE - first) - half_square) + (z * z * polynomial(z, T::COSINE) - r * missing));
    let (sine, cosine) = T::turned(shifted, sine, cosine);
    // The small ones stand for themselves; this also keeps -0.
    let sine = T::select(x.magnitude() < T::SMALL_ANGLE, x, sine);
    let nan = T::of(f64::NAN);
    (T::select(x.finite(), sine, nan), T::select(x.finite(), cosine, nan))
}

/// A large angle less the nearest multiple of [`Format::COARSE`] quarter turns: exact to about one unit of the angle.
#[inline(always)]
fn without_whole_turns<T: Format>(x: T) -> T {
    let usable = T::select(x.magnitude() < T::LARGEST_ANGLE, x, T::ZERO);
    let turns = (usable * (T::INVERSE_QUARTER_TURN / T::COARSE) + T::SHIFT) - T::SHIFT;
    let n = turns * T::COARSE;
    let mut rest = usable;
    for &part in T::QUARTER_TURN {
        rest -= n * part;
    }
    rest - n * T::QUARTER_TURN_REST
}
