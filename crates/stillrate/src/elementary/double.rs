//! Elementary functions in `f64`: the constants of the format and the public names.

use super::format::{Format, bit_patterns};
use super::{angle, circular, exponential as exponentials, logarithm as logarithms};

impl Format for f64 {
    const SHIFT: Self = 6_755_399_441_055_744.0;
    const SMALLEST_NORMAL: Self = f64::MIN_POSITIVE;
    const LIFT: Self = 18_014_398_509_481_984.0;
    const LIFTED_BY: Self = 54.0;
    const SMALL_ANGLE: Self = 1e-9;

    const LOG2_E: Self = core::f64::consts::LOG2_E;
    const LN_2_HIGH: Self = 0.69314718055989033;
    const LN_2_LOW: Self = 5.4979230187083712e-14;
    const EXPONENTIAL_LOW: Self = -746.0;
    const DOUBLING_LIMIT: Self = 600.0;
    const EXPONENTIAL_HIGH: Self = 710.0;
    const NEGLIGIBLE: Self = 44.0;

    const EXPONENTIAL: &'static [Self] = &[
        0.5,
        0.16666666666666666,
        0.041666666666666671,
        0.0083333333333344122,
        0.0013888888888882165,
        0.00019841269837159541,
        2.4801587329991013e-5,
        2.7557326080746158e-6,
        2.7557268953094533e-7,
        2.5046898773047786e-8,
        2.0916355998861447e-9,
        1.7544187127620845e-10,
    ];
    const DOUBLING: &'static [Self] = &[
        1.0,
        core::f64::consts::LN_2,
        0.24022650695910072,
        0.05550410866482158,
        0.009618129107628477,
        0.0013333558146428443,
        0.0001540353039338161,
        1.5252733804059841e-05,
        1.321548679014431e-06,
        1.01780860092397e-07,
        7.054911620801123e-09,
        4.4455382718708116e-10,
        2.5678435993488206e-11,
        1.3691488853904128e-12,
    ];
    const LOGARITHM: &'static [Self] = &[
        0.66666666666666696,
        0.39999999999899721,
        0.28571428625989764,
        0.22222211126190308,
        0.18182889942223021,
        0.15331691691436319,
        0.14616832997057724,
    ];
    const SINE: &'static [Self] = &[
        -0.16666666666666666,
        0.0083333333333313105,
        -0.00019841269837086805,
        2.7557316223987385e-6,
        -2.5051151497621314e-8,
        1.5919285713487644e-10,
    ];
    const COSINE: &'static [Self] = &[
        0.041666666666666664,
        -0.0013888888888887061,
        2.4801587298460618e-5,
        -2.7557317158584842e-7,
        2.0876127907563258e-9,
        -1.1381548878317389e-11,
    ];
    const ANGLE: &'static [Self] = &[
        -0.33333333333333326,
        0.1999999999998365,
        -0.14285714280669398,
        0.1111111052314062,
        -0.090908749060466892,
        0.07691189964321174,
        -0.066450764228963191,
        0.05635956115576677,
        -0.036922097349316972,
    ];

    const INVERSE_QUARTER_TURN: Self = core::f64::consts::FRAC_2_PI;
    const QUARTER_TURN: &'static [Self] = &[1.5707963267341256, 6.077100506303966e-11, 2.0222662487111665e-21];
    const QUARTER_TURN_REST: Self = 8.4784276603688996e-32;
    const LARGEST_EXACT_ANGLE: Self = 1_048_576.0;
    const COARSE: Self = 524_288.0;
    const LARGEST_ANGLE: Self = 4_503_599_627_370_496.0;

    const ARC_OF_HALF: (Self, Self) = (0.46364760900080609, 2.2698777452961687e-17);
    const EIGHTH: (Self, Self) = (core::f64::consts::FRAC_PI_4, 3.061616997868383e-17);
    const QUARTER: (Self, Self) = (core::f64::consts::FRAC_PI_2, 6.123233995736766e-17);
    const HALF_TURN: (Self, Self) = (core::f64::consts::PI, 1.2246467991473532e-16);
    const HUGE: Self = 1e300;
    const SHRINK: Self = 7.888609052210118e-31;
    const MINUTE: Self = 1e-250;
    const GROW: Self = 2.037035976334486e90;

    bit_patterns!(
        f64,
        u64,
        52,
        0x3ff0_0000_0000_0000,
        0x3fe6_a09e_667f_3bcd,
        0x4330_0000_0000_0000,
        4_503_599_627_371_519.0
    );
}

/// Square root, correctly rounded; NaN below zero.
///
/// With the feature `std` this is the standard library's, which the compiler turns into the processor's instruction and
/// vectorises; without it the `libm` crate's, an instruction on x86_64 and aarch64 and an integer algorithm
/// elsewhere. IEEE 754 prescribes the same bits for all of them.
///
/// ```
/// assert_eq!(stillrate::elementary::double::root(9.0), 3.0);
/// ```
#[inline(always)]
#[must_use]
pub fn root(x: f64) -> f64 {
    #[cfg(feature = "std")]
    {
        f64::sqrt(x)
    }
    #[cfg(all(feature = "core-sqrt", not(feature = "std")))]
    {
        core::f64::math::sqrt(x)
    }
    #[cfg(not(any(feature = "core-sqrt", feature = "std")))]
    {
        libm::sqrt(x)
    }
}

/// e^x.
///
/// ```
/// assert_eq!(stillrate::elementary::double::exponential(0.0), 1.0);
/// ```
#[inline(always)]
#[must_use]
pub fn exponential(x: f64) -> f64 {
    exponentials::exponential(x)
}

/// 2^x for x within +-600, limited to that beyond: for weights. Error below 2 units; NaN reads as the smallest weight.
///
/// ```
/// assert_eq!(stillrate::elementary::double::doubling(-3.0), 0.125);
/// ```
#[inline(always)]
#[must_use]
pub fn doubling(x: f64) -> f64 {
    exponentials::doubling(x)
}

/// e^x - 1, accurate near zero.
///
/// ```
/// assert_eq!(stillrate::elementary::double::exponential_less_one(1e-30), 1e-30);
/// ```
#[inline(always)]
#[must_use]
pub fn exponential_less_one(x: f64) -> f64 {
    exponentials::exponential_less_one(x)
}

/// ln x; -infinity at zero, NaN below.
///
/// ```
/// assert_eq!(stillrate::elementary::double::logarithm(2.0), core::f64::consts::LN_2);
/// ```
#[inline(always)]
#[must_use]
pub fn logarithm(x: f64) -> f64 {
    logarithms::logarithm(x)
}

/// (sin x, cos x) of an angle in radians.
///
/// ```
/// assert_eq!(stillrate::elementary::double::sine_cosine(0.0), (0.0, 1.0));
/// ```
#[inline(always)]
#[must_use]
pub fn sine_cosine(x: f64) -> (f64, f64) {
    circular::sine_cosine(x)
}

/// Angle of the point (x, y) in radians, -pi..=pi (atan2).
///
/// ```
/// assert_eq!(stillrate::elementary::double::angle_over(1.0, 1.0), core::f64::consts::FRAC_PI_4);
/// ```
#[inline(always)]
#[must_use]
pub fn angle_over(y: f64, x: f64) -> f64 {
    angle::angle_over(y, x)
}

/// tanh x.
///
/// ```
/// assert_eq!(stillrate::elementary::double::tangent_hyperbolic(40.0), 1.0);
/// ```
#[inline(always)]
#[must_use]
pub fn tangent_hyperbolic(x: f64) -> f64 {
    exponentials::tangent_hyperbolic(x)
}
