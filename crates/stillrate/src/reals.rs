//! States as plain lists of numbers: the one description from which saving, restoring, channel-minor storage
//! and C structs all follow.
//!
//! A state struct declared with [`reals!`](crate::reals!) holds only numbers of type `T`, arrays of them and
//! other such structs, in a fixed order. Counters and yes/no values are stored as numbers too (exact up to 2^24
//! even in `f32`), which keeps a state one homogeneous block of memory.

use crate::real::Real;

/// Plain data that is a fixed number of reals in a fixed order.
pub trait Reals<T: Real>: Copy {
    /// How many numbers there are.
    const COUNT: usize;
    /// Builds the value from its numbers, asked for in order.
    fn gather(next: &mut impl FnMut() -> T) -> Self;
    /// Hands out the numbers in the same order.
    fn scatter(&self, put: &mut impl FnMut(T));
}

impl<T: Real> Reals<T> for T {
    const COUNT: usize = 1;
    #[inline(always)]
    fn gather(next: &mut impl FnMut() -> T) -> Self {
        next()
    }
    #[inline(always)]
    fn scatter(&self, put: &mut impl FnMut(T)) {
        put(*self);
    }
}

impl<T: Real, U: Reals<T>, const N: usize> Reals<T> for [U; N] {
    const COUNT: usize = N * U::COUNT;
    #[inline(always)]
    fn gather(next: &mut impl FnMut() -> T) -> Self {
        core::array::from_fn(|_| U::gather(next))
    }
    #[inline(always)]
    fn scatter(&self, put: &mut impl FnMut(T)) {
        for item in self {
            item.scatter(put);
        }
    }
}

/// Declares a state struct generic over its number type and implements [`Reals`] for it.
///
/// # Example
/// ```
/// use stillrate::{Reals, reals};
/// reals! {
///     /// A level and its gain.
///     pub struct Level {
///         /// The level.
///         pub level: T,
///         /// Two gains.
///         pub gain: [T; 2],
///     }
/// }
/// assert_eq!(<Level<f32> as Reals<f32>>::COUNT, 3);
/// ```
#[macro_export]
macro_rules! reals {
    ($(#[$meta:meta])* $vis:vis struct $name:ident { $($(#[$fmeta:meta])* pub $field:ident : $type:ty),+ $(,)? }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[repr(C)]
        $vis struct $name<T> { $($(#[$fmeta])* pub $field: $type),+ }
        impl<T: $crate::Real> $crate::Reals<T> for $name<T> {
            const COUNT: usize = 0 $(+ <$type as $crate::Reals<T>>::COUNT)+;
            #[inline(always)]
            fn gather(next: &mut impl FnMut() -> T) -> Self {
                Self { $($field: <$type as $crate::Reals<T>>::gather(next)),+ }
            }
            #[inline(always)]
            fn scatter(&self, put: &mut impl FnMut(T)) {
                $($crate::Reals::<T>::scatter(&self.$field, put);)+
            }
        }
    };
}
