//! Elementary functions in `f32`: the constants of the format and the public names.

use super::format::{Format, bit_patterns};
use super::{angle, circular, exponential as exponentials, logarithm as logarithms};

impl Format for f32 {
    const SHIFT: Self = 12_582_912.0;
    const SMALLEST_NORMAL: Self = f32::MIN_POSITIVE;
    const LIFT: Self = 33_554_432.0;
    const LIFTED_BY: Self = 25.0;
    const SMALL_ANGLE: Self = 1e-4;

    const LOG2_E: Self = core::f32::consts::LOG2_E;
    const LN_2_HIGH: Self = 0.693145752;
    const LN_2_LOW: Self = 1.42860677e-6;
    const EXPONENTIAL_LOW: Self = -104.0;
    const DOUBLING_LIMIT: Self = 60.0;
    const EXPONENTIAL_HIGH: Self = 89.0;
    const NEGLIGIBLE: Self = 20.0;

    const EXPONENTIAL: &'static [Self] = &[0.5, 0.166666672, 0.0416665114, 0.0083331801, 0.00139305019, 0.000199696733];
    const DOUBLING: &'static [Self] =
        &[1.0, core::f32::consts::LN_2, 0.2402265, 0.05550411, 0.009618129, 0.0013333558, 0.0001540353, 1.5252734e-05];
    const LOGARITHM: &'static [Self] = &[0.666666687, 0.399995506, 0.28589651, 0.22576578];
    const SINE: &'static [Self] = &[-0.166666672, 0.0083333971, -0.000198612935, 2.92174195e-6];
    const COSINE: &'static [Self] = &[0.0416666679, -0.00138890487, 2.48527685e-5, -3.21310296e-7];
    const ANGLE: &'static [Self] = &[-0.333333284, 0.199984878, -0.142033741, 0.096205838];

    const INVERSE_QUARTER_TURN: Self = core::f32::consts::FRAC_2_PI;
    const QUARTER_TURN: &'static [Self] = &[1.5703125, 0.000483751297, 7.54953362e-8, 2.56328292e-12];
    const QUARTER_TURN_REST: Self = 6.12323426e-17;
    const LARGEST_EXACT_ANGLE: Self = 4096.0;
    const COARSE: Self = 1024.0;
    const LARGEST_ANGLE: Self = 8_388_608.0;

    const ARC_OF_HALF: (Self, Self) = (0.46364760398864746, 5.01215868808913e-9);
    const EIGHTH: (Self, Self) = (core::f32::consts::FRAC_PI_4, -2.1855694143368964e-8);
    const QUARTER: (Self, Self) = (core::f32::consts::FRAC_PI_2, -4.3711388286737929e-8);
    const HALF_TURN: (Self, Self) = (core::f32::consts::PI, -8.7422776573475858e-8);
    const HUGE: Self = 1e37;
    const SHRINK: Self = 1.0 / 1024.0;
    const MINUTE: Self = 1e-20;
    const GROW: Self = 1_099_511_627_776.0;

    bit_patterns!(f32, u32, 23, 0x3f80_0000, 0x3f35_04f3, 0x4b00_0000, 8_388_735.0);
}

/// Square root, correctly rounded; NaN below zero.
///
/// With the feature `std` this is the standard library's, which the compiler turns into the processor's instruction and
/// vectorises; without it the `libm` crate's, an instruction on x86_64 and aarch64 and an integer algorithm
/// elsewhere. IEEE 754 prescribes the same bits for all of them.
///
/// ```
/// assert_eq!(stillrate::elementary::single::root(9.0), 3.0);
/// ```
#[inline(always)]
#[must_use]
pub fn root(x: f32) -> f32 {
    #[cfg(feature = "std")]
    {
        f32::sqrt(x)
    }
    #[cfg(all(feature = "core-sqrt", not(feature = "std")))]
    {
        core::f32::math::sqrt(x)
    }
    #[cfg(not(any(feature = "core-sqrt", feature = "std")))]
    {
        libm::sqrtf(x)
    }
}

/// e^x.
///
/// ```
/// assert_eq!(stillrate::elementary::single::exponential(0.0), 1.0);
/// ```
#[inline(always)]
#[must_use]
pub fn exponential(x: f32) -> f32 {
    exponentials::exponential(x)
}

/// 2^x for x within +-60, limited to that beyond: for weights. Error below 2 units; NaN reads as the smallest weight.
///
/// ```
/// assert_eq!(stillrate::elementary::single::doubling(-3.0), 0.125);
/// ```
#[inline(always)]
#[must_use]
pub fn doubling(x: f32) -> f32 {
    exponentials::doubling(x)
}

/// e^x - 1, accurate near zero.
///
/// ```
/// assert_eq!(stillrate::elementary::single::exponential_less_one(1e-30), 1e-30);
/// ```
#[inline(always)]
#[must_use]
pub fn exponential_less_one(x: f32) -> f32 {
    exponentials::exponential_less_one(x)
}

/// ln x; -infinity at zero, NaN below.
///
/// ```
/// assert_eq!(stillrate::elementary::single::logarithm(2.0), core::f32::consts::LN_2);
/// ```
#[inline(always)]
#[must_use]
pub fn logarithm(x: f32) -> f32 {
    logarithms::logarithm(x)
}

/// (sin x, cos x) of an angle in radians.
///
/// ```
/// assert_eq!(stillrate::elementary::single::sine_cosine(0.0), (0.0, 1.0));
/// ```
#[inline(always)]
#[must_use]
pub fn sine_cosine(x: f32) -> (f32, f32) {
    circular::sine_cosine(x)
}

/// Angle of the point (x, y) in radians, -pi..=pi (atan2).
///
/// ```
/// assert_eq!(stillrate::elementary::single::angle_over(1.0, 1.0), core::f32::consts::FRAC_PI_4);
/// ```
#[inline(always)]
#[must_use]
pub fn angle_over(y: f32, x: f32) -> f32 {
    angle::angle_over(y, x)
}

/// tanh x.
///
/// ```
/// assert_eq!(stillrate::elementary::single::tangent_hyperbolic(40.0), 1.0);
/// ```
#[inline(always)]
#[must_use]
pub fn tangent_hyperbolic(x: f32) -> f32 {
    exponentials::tangent_hyperbolic(x)
}
