//! The number a filter is written in: `f32` or `f64`, with selects instead of branches.
//!
//! Every filter, model and matrix kernel of the library is written once, against [`Real`]. The trait offers only
//! operations whose result is fixed by IEEE 754 (add, subtract, multiply, divide, square root, compare) or by
//! our own [`elementary`] functions, so that a log gives the same bits on a desk, in a
//! browser and in firmware. There is deliberately no fused multiply-add.

use core::fmt::{Debug, Display};
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::elementary;

/// A floating-point number that the filters compute in.
///
/// # Example
/// ```
/// use stillrate::Real;
/// fn hypotenuse<T: Real>(a: T, b: T) -> T {
///     (a * a + b * b).root()
/// }
/// assert_eq!(hypotenuse(3.0_f32, 4.0), 5.0);
/// assert_eq!(hypotenuse(3.0_f64, 4.0), 5.0);
/// ```
///
/// What cannot be computed has a fixed answer, so that a step needs no branch:
/// ```
/// use stillrate::Real;
/// fn cleaned<T: Real>(x: T) -> T {
///     T::select(x.finite(), x, T::ZERO).limited(T::of(-2.0), T::TWO).flushed()
/// }
/// assert_eq!([f64::NAN, -7.0, 1e-300].map(cleaned), [0.0, -2.0, 0.0]);
/// assert_eq!((f64::NAN.least(1.0), f64::NAN.most(1.0), (-1.0_f64).magnitude()), (1.0, 1.0, 1.0));
/// assert_eq!(f32::of(0.1).widen(), 0.10000000149011612);
/// assert_eq!(f32::from_little_endian(1.5_f32.to_little_endian()), 1.5);
/// ```
///
/// The functions take and give what their names say, in radians and to the base e but for one:
/// ```
/// use stillrate::Real;
/// let (sine, cosine) = 0.3_f64.sine_cosine();
/// assert!((sine.angle_over(cosine) - 0.3).abs() < 1e-15);
/// assert!((2.0_f64.exponential().logarithm() - 2.0).abs() < 1e-15);
/// assert_eq!(1e-20_f64.exponential_less_one(), 1e-20); // e^x less 1 would be 0
/// assert_eq!((3.0_f32.doubling(), 30.0_f32.tangent_hyperbolic()), (8.0, 1.0));
/// ```
pub trait Real:
    Copy
    + Default
    + Debug
    + Display
    + PartialEq
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
    + nalgebra::Scalar
    + num_traits::Zero
    + num_traits::One
{
    /// 0
    const ZERO: Self;
    /// 1
    const ONE: Self;
    /// 2
    const TWO: Self;
    /// 1/2
    const HALF: Self;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;
    /// Magnitudes below this are flushed to zero: far above the denormals, far below any signal.
    const TINY: Self;
    /// Largest finite number.
    const LARGEST: Self;
    /// 4 for `f32`, 8 for `f64`.
    const BYTES: usize;

    /// Rounds a constant or a setting to this type.
    fn of(value: f64) -> Self;
    /// Widens to `f64` (exact).
    fn widen(self) -> f64;
    /// `yes` where `condition` holds, else `no`; both are already computed, so no branch is needed.
    #[inline(always)]
    fn select(condition: bool, yes: Self, no: Self) -> Self {
        if condition { yes } else { no }
    }
    /// Neither NaN nor infinite.
    #[inline(always)]
    #[allow(clippy::eq_op)]
    fn finite(self) -> bool {
        // NaN and the infinities are the only numbers whose difference with themselves is not zero.
        self - self == Self::ZERO
    }
    /// Magnitude.
    #[must_use]
    fn magnitude(self) -> Self;
    /// The smaller one; the second where the first is NaN.
    #[inline(always)]
    #[must_use]
    fn least(self, other: Self) -> Self {
        Self::select(self < other, self, other)
    }
    /// The larger one; the second where the first is NaN.
    #[inline(always)]
    #[must_use]
    fn most(self, other: Self) -> Self {
        Self::select(self > other, self, other)
    }
    /// Limits to `low..=high`; NaN becomes `low`.
    #[inline(always)]
    #[must_use]
    fn limited(self, low: Self, high: Self) -> Self {
        self.most(low).least(high)
    }
    /// Zero where the magnitude is below [`Real::TINY`], so that nothing decays into slow denormals.
    #[inline(always)]
    #[must_use]
    fn flushed(self) -> Self {
        Self::select(self.magnitude() < Self::TINY, Self::ZERO, self)
    }
    /// Square root, correctly rounded; NaN below zero.
    #[must_use]
    fn root(self) -> Self;
    /// e^x.
    #[must_use]
    fn exponential(self) -> Self;
    /// 2^x, fast and limited to what weights need; see [`elementary`].
    #[must_use]
    fn doubling(self) -> Self;
    /// e^x - 1, accurate near zero.
    #[must_use]
    fn exponential_less_one(self) -> Self;
    /// Natural logarithm.
    #[must_use]
    fn logarithm(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sine_cosine(self) -> (Self, Self);
    /// Angle of the point (x = `other`, y = `self`) in radians, in -pi..=pi.
    #[must_use]
    fn angle_over(self, other: Self) -> Self;
    /// Hyperbolic tangent.
    #[must_use]
    fn tangent_hyperbolic(self) -> Self;
    /// Writes the number as little-endian bytes; the first [`Real::BYTES`] of the array count.
    fn to_little_endian(self) -> [u8; 8];
    /// Reads what [`Real::to_little_endian`] wrote.
    fn from_little_endian(bytes: [u8; 8]) -> Self;
}

macro_rules! real {
    ($type:ident, $module:ident, $tiny:expr, $bytes:expr, $bits:ident, $sign:expr) => {
        impl Real for $type {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const TWO: Self = 2.0;
            const HALF: Self = 0.5;
            const EPSILON: Self = $type::EPSILON;
            const TINY: Self = $tiny;
            const LARGEST: Self = $type::MAX;
            const BYTES: usize = $bytes;

            #[inline(always)]
            fn of(value: f64) -> Self {
                value as $type
            }
            #[inline(always)]
            fn widen(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn magnitude(self) -> Self {
                $type::from_bits(self.to_bits() & !$sign)
            }
            #[inline(always)]
            fn root(self) -> Self {
                elementary::$module::root(self)
            }
            #[inline(always)]
            fn exponential(self) -> Self {
                elementary::$module::exponential(self)
            }
            #[inline(always)]
            fn doubling(self) -> Self {
                elementary::$module::doubling(self)
            }
            #[inline(always)]
            fn exponential_less_one(self) -> Self {
                elementary::$module::exponential_less_one(self)
            }
            #[inline(always)]
            fn logarithm(self) -> Self {
                elementary::$module::logarithm(self)
            }
            #[inline(always)]
            fn sine_cosine(self) -> (Self, Self) {
                elementary::$module::sine_cosine(self)
            }
            #[inline(always)]
            fn angle_over(self, other: Self) -> Self {
                elementary::$module::angle_over(self, other)
            }
            #[inline(always)]
            fn tangent_hyperbolic(self) -> Self {
                elementary::$module::tangent_hyperbolic(self)
            }
            #[inline(always)]
            fn to_little_endian(self) -> [u8; 8] {
                let mut bytes = [0; 8];
                let (used, _) = bytes.split_at_mut($bytes);
                used.copy_from_slice(&self.to_le_bytes());
                bytes
            }
            #[inline(always)]
            fn from_little_endian(bytes: [u8; 8]) -> Self {
                let mut used = [0; $bytes];
                used.copy_from_slice(bytes.split_at($bytes).0);
                $type::from_le_bytes(used)
            }
        }
    };
}

real!(f32, single, 1e-30, 4, u32, (1_u32 << 31));
real!(f64, double, 1e-250, 8, u64, (1_u64 << 63));
