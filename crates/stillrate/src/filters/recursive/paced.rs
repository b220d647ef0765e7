//! Steps at the nominal rate without the arithmetic of irregular time.
//!
//! A forgetting factor over an odd time step needs an exponential; the compiler computes it for every sample, used or not, because selects are
//! cheaper than branches. A tile of nominal steps therefore runs a second instantiation of the same step that takes the nominal coefficient
//! outright: the bits are the same, because the general form takes it as well where dt is nominal.

use crate::block;
use crate::filter::{Estimate, Filter, Observer, Sample};
use crate::real::Real;

/// A filter whose step knows whether every time step is nominal.
pub(crate) trait Paced<T: Real>: Filter<T> {
    /// One sample; with `NOMINAL` its `dt` is the filter's period.
    fn follow<const NOMINAL: bool, O: Observer<T>>(
        &self,
        state: &mut Self::State,
        sample: Sample<T>,
        observer: &mut O,
    ) -> Estimate<T>;

    /// [`Filter::tile`] that chooses the instantiation once a tile.
    #[inline(always)]
    fn tile_paced<const W: usize>(&self, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
        if dt == self.period() {
            block::step_rows(&Nominal(*self), lanes, tile, dt);
        } else {
            block::step_rows(self, lanes, tile, dt);
        }
    }
}

/// A filter at its nominal rate.
#[derive(Clone, Copy, Debug)]
struct Nominal<F>(F);

impl<T: Real, F: Paced<T>> Filter<T> for Nominal<F> {
    type State = F::State;
    fn start(&self) -> F::State {
        self.0.start()
    }
    fn accepts(&self, state: &F::State) -> bool {
        self.0.accepts(state)
    }
    fn period(&self) -> T {
        self.0.period()
    }
    #[inline(always)]
    fn observe<O: Observer<T>>(&self, state: &mut F::State, sample: Sample<T>, observer: &mut O) -> Estimate<T> {
        self.0.follow::<true, O>(state, sample, observer)
    }
}
