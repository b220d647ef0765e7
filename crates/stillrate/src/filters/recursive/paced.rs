//! Steps at the nominal rate without the arithmetic of irregular time.
//!
//! A forgetting factor over an odd time step needs an exponential; the compiler computes it for every sample, used or not, because selects are
//! cheaper than branches. A tile of nominal steps therefore runs a second instantiation of the same step that takes the nominal coefficient
//! outright: the bits are the same, because the general form takes it as well where dt is nominal.

use crate::block;
use crate::filter::{Estimate, Filter, Observer, Sample};
use crate::real::Real;
use crate::reals::Reals;

/// A filter whose step knows whether every time step is nominal; whoever is this is a [`Filter`].
pub trait Paced: Copy + Send + Sync {
    /// What its numbers are. (Not a parameter: with one, no second filter could be a [`Filter`] by other means.)
    type Number: Real;
    /// [`Filter::State`].
    type State: Reals<Self::Number> + core::fmt::Debug + PartialEq + Send + Sync;

    /// [`Filter::start`].
    fn begin(&self) -> Self::State;

    /// [`Filter::period`].
    fn nominal_s(&self) -> Self::Number;

    /// One sample; with `NOMINAL` its `dt` is the filter's period.
    fn follow<const NOMINAL: bool, O: Observer<Self::Number>>(
        &self,
        state: &mut Self::State,
        sample: Sample<Self::Number>,
        observer: &mut O,
    ) -> Estimate<Self::Number>;

    /// [`Filter::tile`]; by itself, it chooses the instantiation once a tile.
    #[inline(always)]
    fn follow_tile<const W: usize>(
        &self,
        lanes: &mut [[Self::Number; W]],
        tile: &mut [[Self::Number; W]],
        dt: Self::Number,
    ) {
        step_paced(self, lanes, tile, dt);
    }
}

/// A tile by the instantiation that its time step allows.
#[inline(always)]
pub(crate) fn step_paced<T: Real, F: Paced<Number = T>, const W: usize>(
    filter: &F,
    lanes: &mut [[T; W]],
    tile: &mut [[T; W]],
    dt: T,
) {
    if dt == filter.nominal_s() {
        block::step_rows(&Nominal(*filter), lanes, tile, dt);
    } else {
        block::step_rows(filter, lanes, tile, dt);
    }
}

impl<F: Paced> Filter<F::Number> for F {
    type State = <F as Paced>::State;

    fn start(&self) -> <F as Paced>::State {
        self.begin()
    }

    fn period(&self) -> F::Number {
        self.nominal_s()
    }

    #[inline(always)]
    fn observe<O: Observer<F::Number>>(
        &self,
        state: &mut <F as Paced>::State,
        sample: Sample<F::Number>,
        observer: &mut O,
    ) -> Estimate<F::Number> {
        self.follow::<false, O>(state, sample, observer)
    }

    #[inline(always)]
    fn tile<const W: usize>(&self, lanes: &mut [[F::Number; W]], tile: &mut [[F::Number; W]], dt: F::Number) {
        self.follow_tile(lanes, tile, dt);
    }
}

/// A filter at its nominal rate.
#[derive(Clone, Copy, Debug)]
struct Nominal<F>(F);

impl<F: Paced> Filter<F::Number> for Nominal<F> {
    type State = <F as Paced>::State;
    fn start(&self) -> <F as Paced>::State {
        self.0.begin()
    }
    fn period(&self) -> F::Number {
        self.0.nominal_s()
    }
    #[inline(always)]
    fn observe<O: Observer<F::Number>>(
        &self,
        state: &mut <F as Paced>::State,
        sample: Sample<F::Number>,
        observer: &mut O,
    ) -> Estimate<F::Number> {
        self.0.follow::<true, O>(state, sample, observer)
    }
}
