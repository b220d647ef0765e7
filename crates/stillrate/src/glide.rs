//! A short form of a step for stretches in which no sample needs care.
//!
//! The full step of a first- or second-order filter spends most of its time deciding: is the sample there, has the filter begun, has a
//! number become so small that it must be flushed. All of this stands between one output and the next, and such a filter can be no faster than that
//! chain. Here a stretch of samples runs through the bare recursion; the questions are asked beside it, and where one of them is
//! answered with yes, the stretch is taken back and done again by the full step. The bits are those of the full step.

use crate::block;
use crate::filter::Filter;
use crate::real::Real;
use crate::reals::{Lane, Lanes, Reals};

/// Samples that are tried at once.
const STRETCH: usize = 32;

/// A filter with a short form of its step.
pub(crate) trait Glide<T: Real>: Filter<T> {
    /// The state of several channels side by side.
    type Wide<const W: usize>: Reals<Lane<T, W>> + Lanes<Narrow = Self::State>;

    /// Whether the short form may set off: the filter runs, and what it takes for settled is.
    fn runs(&self, state: &Self::State) -> bool;

    /// Largest magnitude that the full step would use.
    fn limit(&self) -> T;

    /// The full step at the nominal period, for a usable value, without its guards. Returns the output.
    fn glide(&self, state: &mut Self::State, value: T) -> T;

    /// Below [`Real::TINY`] where a guard of the full step would have acted on what came out; see [`margin`].
    fn margin(&self, state: &Self::State) -> T;

    /// A tile by the full step. (No closure in its place: that stays a call where the instruction set changes.)
    #[inline(always)]
    fn full<const W: usize>(&self, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
        block::step_rows(self, lanes, tile, dt);
    }
}

/// Below [`Real::TINY`] if [`Real::flushed`] would change the number.
#[inline(always)]
pub(crate) fn margin<T: Real>(x: T) -> T {
    T::select(x == T::ZERO, T::ONE, x.magnitude())
}

/// [`Filter::tile`] by the short form where it holds, else by [`Glide::full`].
#[inline(always)]
pub(crate) fn tile<T: Real, F: Glide<T>, const W: usize>(filter: &F, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
    if dt != filter.period() || lanes.len() < <F::State as Reals<T>>::COUNT {
        return filter.full(lanes, tile, dt);
    }
    for stretch in tile.chunks_mut(STRETCH) {
        if !try_stretch(filter, lanes, stretch) {
            filter.full(lanes, stretch, dt);
        }
    }
}

/// Runs the short form over a stretch; false, and nothing has happened, where it does not hold for every channel.
#[inline(always)]
fn try_stretch<T: Real, F: Glide<T>, const W: usize>(filter: &F, lanes: &mut [[T; W]], stretch: &mut [[T; W]]) -> bool {
    let mut state: F::Wide<W> = block::load_wide(lanes);
    for c in 0..W {
        if !filter.runs(&state.lane(c)) {
            return false;
        }
    }
    // Numbers, not yes and no: these the compiler keeps in vector registers.
    let (limit, mut usable, mut least) = (filter.limit(), [T::ONE; W], [T::ONE; W]);
    let mut outputs = [[T::ZERO; W]; STRETCH];
    for (row, output) in stretch.iter().zip(&mut outputs) {
        for c in 0..W {
            usable[c] = T::select(row[c].magnitude() <= limit, usable[c], T::ZERO);
            let mut one = state.lane(c);
            output[c] = filter.glide(&mut one, row[c]);
            least[c] = filter.margin(&one).least(least[c]);
            state.set_lane(c, one);
        }
    }
    for c in 0..W {
        if usable[c] == T::ZERO || least[c] < T::TINY {
            return false;
        }
    }
    for (row, output) in stretch.iter_mut().zip(&outputs) {
        *row = *output;
    }
    block::store_wide(&state, lanes);
    true
}
