//! Many channels at once: states stored channel-minor, the same step in a loop that the compiler vectorises.
//!
//! The state of `W` channels is a slice of [`Reals::COUNT`] rows of `W` numbers: row `i` holds number `i` of
//! every channel. One row of samples is filtered by gathering each channel's numbers, running the ordinary
//! [`Filter::step`] and scattering them back. The loop over channels is innermost and branch-free, so
//! LLVM turns it into vector code of whatever width the target offers; each channel still sees exactly the operations of the
//! scalar step, hence the same bits.

use crate::filter::{Filter, Sample};
use crate::real::Real;
use crate::reals::{Lane, Reals};

/// Reads the state of channel `c` out of channel-minor storage (missing rows read as zero).
///
/// # Example
/// ```
/// use stillrate::block::{load, store};
/// let mut lanes = [[0.0_f64; 4]; 2];
/// store(&[1.0, 2.0], &mut lanes, 3);
/// assert_eq!(load::<f64, [f64; 2], 4>(&lanes, 3), [1.0, 2.0]);
/// ```
#[inline(always)]
pub fn load<T: Real, S: Reals<T>, const W: usize>(lanes: &[[T; W]], c: usize) -> S {
    let mut row = 0;
    S::gather(&mut || {
        let number = match lanes.get(row) {
            Some(lane) if c < W => lane[c],
            _ => T::ZERO,
        };
        row += 1;
        number
    })
}

/// Writes the state of channel `c` into channel-minor storage (rows that do not exist are passed over).
///
/// # Example
/// ```
/// use stillrate::{Filter, block::store, filters::Pt1};
/// let filter = Pt1::<f64>::new(50.0, 8.0)?;
/// let mut state = filter.start();
/// state.level = 5.0;
/// let mut lanes = [[0.0; 4]; 2];
/// store(&state, &mut lanes, 1);
/// assert_eq!(lanes, [[0.0, 5.0, 0.0, 0.0], [0.0; 4]]); // a row a number, a column a channel
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[inline(always)]
pub fn store<T: Real, S: Reals<T>, const W: usize>(state: &S, lanes: &mut [[T; W]], c: usize) {
    let mut row = 0;
    state.scatter(&mut |number| {
        if let Some(slot) = lanes.get_mut(row).and_then(|lane| lane.get_mut(c)) {
            *slot = number;
        }
        row += 1;
    });
}

/// Reads the state of all `W` channels, side by side (missing rows read as zero).
#[inline(always)]
pub(crate) fn load_wide<T: Real, S: Reals<Lane<T, W>>, const W: usize>(lanes: &[[T; W]]) -> S {
    let mut row = 0;
    S::gather(&mut || {
        let lane = Lane(lanes.get(row).copied().unwrap_or([T::ZERO; W]));
        row += 1;
        lane
    })
}

/// Writes the state of all channels back (rows that do not exist are passed over).
#[inline(always)]
pub(crate) fn store_wide<T: Real, S: Reals<Lane<T, W>>, const W: usize>(state: &S, lanes: &mut [[T; W]]) {
    let mut row = 0;
    state.scatter(&mut |lane: Lane<T, W>| {
        if let Some(slot) = lanes.get_mut(row) {
            *slot = lane.0;
        }
        row += 1;
    });
}

/// Filters rows of `W` channels in place with [`Filter::step`]; the default of [`Filter::tile`].
///
/// # Example
/// ```
/// use stillrate::{Filter, Reals, Sample, block::{step_rows, store}, filters::Pt1};
/// let filter = Pt1::<f64>::new(50.0, 8.0)?;
/// let mut lanes = [[0.0; 4]; 2]; // two numbers a state, four channels
/// (0..4).for_each(|c| store(&filter.start(), &mut lanes, c));
/// let mut tile = [[1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 3.0, 5.0]];
/// step_rows(&filter, &mut lanes, &mut tile, 0.02);
/// assert_eq!(tile[0], [1.0, 2.0, 3.0, 4.0]);
/// assert_eq!(tile[1][..3], [1.0, 2.0, 3.0]);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[inline(always)]
pub fn step_rows<T: Real, F: Filter<T>, const W: usize>(filter: &F, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
    let count = <F::State as Reals<T>>::COUNT;
    if lanes.len() < count {
        return;
    }
    let lanes = &mut lanes[..count];
    if W == 1 {
        // One channel: the state stays in registers over the whole tile.
        let mut state: F::State = load(lanes, 0);
        for row in tile {
            row[0] = filter.step(&mut state, Sample { value: row[0], dt }).rate;
        }
        store(&state, lanes, 0);
        return;
    }
    for row in tile {
        for c in 0..W {
            let mut state: F::State = load(lanes, c);
            row[c] = filter.step(&mut state, Sample { value: row[c], dt }).rate;
            store(&state, lanes, c);
        }
    }
}
