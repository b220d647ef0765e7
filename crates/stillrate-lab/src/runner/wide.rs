//! Tiles and vector instructions: how a group of channels runs through [`Filter::tile`] at the widest width of the
//! machine. The choice is made once a tile and never changes a bit: every width executes the same operations.

use core::marker::PhantomData;

use stillrate::block;
use stillrate::{Filter, Real, Reals};

use crate::samples::{Precision, Sink, Source, Table, Timing};

/// Rows of a tile: large enough to hide the hand-over, small enough for the first-level cache.
const ROWS: usize = 128;

/// A number type with its vector width.
pub(super) trait Wide: Real {
    /// Channels that run side by side.
    const WIDTH: usize;
    /// The type as a [`Precision`].
    const PRECISION: Precision;
    /// The sink, if it is of this type.
    fn sink(sink: Sink<'_>) -> Option<&mut [Self]>;
    /// [`run_group`] at [`Wide::WIDTH`].
    fn run_widest<F: Filter<Self>>(filter: &F, states: &mut [F::State], group: &Group<'_, Self>);
}

macro_rules! wide {
    ($type:ident, $width:literal, $variant:ident) => {
        impl Wide for $type {
            const WIDTH: usize = $width;
            const PRECISION: Precision = Precision::$variant;
            fn sink(sink: Sink<'_>) -> Option<&mut [Self]> {
                match sink {
                    Sink::$variant(slice) => Some(slice),
                    _ => None,
                }
            }
            fn run_widest<F: Filter<Self>>(filter: &F, states: &mut [F::State], group: &Group<'_, Self>) {
                run_group::<Self, F, $width>(filter, states, group);
            }
        }
    };
}

wide!(f32, 16, Single);
wide!(f64, 8, Double);

/// A sample-major output that several threads fill, each its own columns.
pub(super) struct Columns<'a, T> {
    start: *mut T,
    len: usize,
    channels: usize,
    lifetime: PhantomData<&'a mut [T]>,
}

// SAFETY: the pointer is only written through, by `write`, whose callers keep to their own columns.
unsafe impl<T: Send> Sync for Columns<'_, T> {}

impl<'a, T: Copy> Columns<'a, T> {
    /// Borrows the output for as long as the columns live.
    pub(super) fn new(output: &'a mut [T], channels: usize) -> Self {
        Self { start: output.as_mut_ptr(), len: output.len(), channels, lifetime: PhantomData }
    }

    /// Writes one row of the columns from `first` on.
    ///
    /// # Safety
    /// No other thread may write the same columns.
    ///
    /// # Panics
    /// If the row or the columns lie outside the output.
    unsafe fn write(&self, row: usize, first: usize, values: &[T]) {
        let base = row * self.channels + first;
        assert!(first + values.len() <= self.channels && base + values.len() <= self.len);
        // SAFETY: inside the borrowed output, and nobody else writes there.
        unsafe { core::ptr::copy_nonoverlapping(values.as_ptr(), self.start.add(base), values.len()) };
    }
}

/// Neighbouring channels that run side by side: where their samples come from, when, and where the results go.
pub(super) struct Group<'a, T> {
    /// Number of the first channel. No channel is in two groups of one output.
    pub(super) first: usize,
    pub(super) source: Source<'a>,
    pub(super) timing: Timing<'a>,
    pub(super) output: &'a Columns<'a, T>,
}

/// Runs the `states.len() <= W` channels of a group over their table. Idle lanes repeat the first channel, so that they never need
/// more care than it.
pub(super) fn run_group<T: Real, F: Filter<T>, const W: usize>(
    filter: &F,
    states: &mut [F::State],
    &Group { first, source, timing, output }: &Group<'_, T>,
) {
    let used = states.len().min(W);
    let (total, _) = source.shape();
    let mut lanes = vec![[T::ZERO; W]; <F::State as Reals<T>>::COUNT];
    for c in 0..W {
        block::store(&states[if c < used { c } else { 0 }], &mut lanes, c);
    }
    let mut tile = [[T::of(f64::NAN); W]; ROWS];
    let mut start = 0;
    while start < total {
        let rows = ROWS.min(total - start);
        match source {
            Source::Single(table) => fill(&table, start, first, used, &mut tile[..rows]),
            Source::Double(table) => fill(&table, start, first, used, &mut tile[..rows]),
        }
        match timing {
            Timing::Regular => tile_widest(filter, &mut lanes, &mut tile[..rows], filter.period()),
            Timing::Steps(steps) => {
                for (k, row) in tile[..rows].iter_mut().enumerate() {
                    tile_widest(filter, &mut lanes, core::slice::from_mut(row), T::of(steps[start + k]));
                }
            }
        }
        for (k, row) in tile[..rows].iter().enumerate() {
            // SAFETY: every group of channels is handed to one call only, and `first + used <= channels`.
            unsafe { output.write(start + k, first, &row[..used]) };
        }
        start += rows;
    }
    for (c, state) in states.iter_mut().enumerate().take(used) {
        *state = block::load(&lanes, c);
    }
}

/// Copies rows from `start` on into the tile: `used` channels from `first` on, the first of them again in idle lanes.
fn fill<T: Real, U: Real, const W: usize>(
    table: &Table<'_, U>,
    start: usize,
    first: usize,
    used: usize,
    tile: &mut [[T; W]],
) {
    for (k, row) in tile.iter_mut().enumerate() {
        let base = (start + k) * table.row_stride + first * table.channel_stride;
        for (c, cell) in row[..used].iter_mut().enumerate() {
            *cell = T::of(table.items[base + c * table.channel_stride].widen());
        }
        let repeated = row[0];
        row[used..].fill(repeated);
    }
}

/// [`Filter::tile`] compiled for the instructions that this machine has.
fn tile_widest<T: Real, F: Filter<T>, const W: usize>(filter: &F, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
    #[cfg(target_arch = "x86_64")]
    if (W > 1 || !F::SIDE_BY_SIDE) && std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the feature was just detected.
        unsafe { tile_avx2(filter, lanes, tile, dt) };
        return;
    }
    filter.tile(lanes, tile, dt);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn tile_avx2<T: Real, F: Filter<T>, const W: usize>(filter: &F, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
    filter.tile(lanes, tile, dt);
}
