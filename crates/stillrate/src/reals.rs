//! States as plain lists of numbers: the one description from which saving, restoring, channel-minor storage
//! and C structs all follow.
//!
//! A state struct declared with [`reals!`](crate::reals!) holds only numbers of type `T`, arrays of them and
//! other such structs, in a fixed order. Counters and yes/no values are stored as numbers too (exact up to 2^24
//! even in `f32`), which keeps a state one homogeneous block of memory.

use crate::real::Real;

/// Plain data that is a fixed number of items of type `T` in a fixed order.
///
/// `T` is a number, or a [`Lane`] of numbers where many channels stand side by side.
///
/// # Example
/// ```
/// use stillrate::{Filter, Reals, filters::Pt1};
/// let state = Pt1::<f32>::new(50.0, 8.0).unwrap().start();
/// let mut numbers = Vec::new();
/// state.scatter(&mut |number: f32| numbers.push(number));
/// let mut next = numbers.iter().copied();
/// let again = Reals::gather(&mut || next.next().unwrap());
/// assert_eq!(state, again);
/// ```
pub trait Reals<T: Copy>: Copy {
    /// How many items there are.
    const COUNT: usize;
    /// Builds the value from its items, asked for in order.
    fn gather(next: &mut impl FnMut() -> T) -> Self;
    /// Hands out the items in the same order.
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

/// The same number of `W` channels, side by side.
///
/// # Example
/// ```
/// use stillrate::{Lane, Reals, filters::Pt1State};
/// let both = Pt1State { level: Lane([1.0, 2.0]), started: Lane([1.0, 0.0]) };
/// let mut levels = Vec::new();
/// both.scatter(&mut |lane: Lane<f64, 2>| levels.push(lane.0));
/// assert_eq!(levels, [[1.0, 2.0], [1.0, 0.0]]); // channel-minor: number by number, channels side by side
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct Lane<T, const W: usize>(pub [T; W]);

impl<T: Real, const W: usize> Reals<Lane<T, W>> for Lane<T, W> {
    const COUNT: usize = 1;
    #[inline(always)]
    fn gather(next: &mut impl FnMut() -> Lane<T, W>) -> Self {
        next()
    }
    #[inline(always)]
    fn scatter(&self, put: &mut impl FnMut(Lane<T, W>)) {
        put(*self);
    }
}

impl<T: Real> Reals<T> for Lane<T, 1> {
    const COUNT: usize = 1;
    #[inline(always)]
    fn gather(next: &mut impl FnMut() -> T) -> Self {
        Lane([next()])
    }
    #[inline(always)]
    fn scatter(&self, put: &mut impl FnMut(T)) {
        put(self.0[0]);
    }
}

impl<T: Copy, U: Reals<T>, const N: usize> Reals<T> for [U; N] {
    const COUNT: usize = N * U::COUNT;
    #[inline(always)]
    fn gather(next: &mut impl FnMut() -> T) -> Self {
        // No `from_fn`: its closure stays a call where the instruction set changes.
        let mut all = [U::gather(next); N];
        for item in all.iter_mut().skip(1) {
            *item = U::gather(next);
        }
        all
    }
    #[inline(always)]
    fn scatter(&self, put: &mut impl FnMut(T)) {
        for item in self {
            item.scatter(put);
        }
    }
}

/// Data of many channels side by side, from which the data of one channel can be taken and put back.
///
/// # Example
/// ```
/// use stillrate::{Lane, filters::Pt1State, reals::Lanes};
/// let mut both = Pt1State { level: Lane([1.0, 2.0]), started: Lane([1.0, 0.0]) };
/// assert_eq!(both.lane(1), Pt1State { level: 2.0, started: 0.0 });
/// both.set_lane(1, Pt1State { level: -3.0, started: 1.0 });
/// assert_eq!(both.level, Lane([1.0, -3.0]));
/// ```
pub trait Lanes {
    /// The data of one channel.
    type Narrow: Copy;
    /// Takes the data of channel `c`.
    fn lane(&self, c: usize) -> Self::Narrow;
    /// Puts the data of channel `c` back.
    fn set_lane(&mut self, c: usize, narrow: Self::Narrow);
}

impl<T: Real, const W: usize> Lanes for Lane<T, W> {
    type Narrow = T;
    #[inline(always)]
    fn lane(&self, c: usize) -> T {
        self.0[c]
    }
    #[inline(always)]
    fn set_lane(&mut self, c: usize, narrow: T) {
        self.0[c] = narrow;
    }
}

impl<U: Lanes, const N: usize> Lanes for [U; N] {
    type Narrow = [U::Narrow; N];
    #[inline(always)]
    fn lane(&self, c: usize) -> Self::Narrow {
        let mut all = [self[0].lane(c); N];
        for k in 1..N {
            all[k] = self[k].lane(c);
        }
        all
    }
    #[inline(always)]
    fn set_lane(&mut self, c: usize, narrow: Self::Narrow) {
        for (item, value) in self.iter_mut().zip(narrow) {
            item.set_lane(c, value);
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
    ($(#[doc = $about:literal])* $vis:vis struct $name:ident { $($(#[doc = $field_about:literal])* pub $field:ident : $type:ty),+ $(,)? }) => {
        $(#[doc = $about])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[repr(C)]
        $vis struct $name<T> { $($(#[doc = $field_about])* pub $field: $type),+ }
        $crate::outline! { $name [$($about),*] $($field [$($field_about),*])+ }
        impl<L: Copy, T: $crate::Reals<L>> $crate::Reals<L> for $name<T> {
            const COUNT: usize = 0 $(+ <$type as $crate::Reals<L>>::COUNT)+;
            #[inline(always)]
            fn gather(next: &mut impl FnMut() -> L) -> Self {
                Self { $($field: <$type as $crate::Reals<L>>::gather(next)),+ }
            }
            #[inline(always)]
            fn scatter(&self, put: &mut impl FnMut(L)) {
                $(<$type as $crate::Reals<L>>::scatter(&self.$field, put);)+
            }
        }
        impl<T: $crate::reals::Lanes> $crate::reals::Lanes for $name<T> {
            type Narrow = $name<T::Narrow>;
            #[inline(always)]
            fn lane(&self, c: usize) -> $name<T::Narrow> {
                $name { $($field: self.$field.lane(c)),+ }
            }
            #[inline(always)]
            fn set_lane(&mut self, c: usize, narrow: $name<T::Narrow>) {
                $(self.$field.set_lane(c, narrow.$field);)+
            }
        }
    };
}
