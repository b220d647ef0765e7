//! Samples as callers hold them: tables with any strides in either precision, where results go, and time steps.

use stillrate::Real;

/// Number type that a filter computes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// `f32`
    Single,
    /// `f64`
    Double,
}

/// A read-only table of samples with any non-negative strides (in items).
#[derive(Clone, Copy, Debug)]
pub struct Table<'a, T> {
    /// The items; `rows` and `channels` never reach beyond them.
    pub items: &'a [T],
    /// Number of samples.
    pub rows: usize,
    /// Number of channels.
    pub channels: usize,
    /// Items from one sample to the next.
    pub row_stride: usize,
    /// Items from one channel to the next.
    pub channel_stride: usize,
}

/// Samples in either precision.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// `f32` samples.
    Single(Table<'a, f32>),
    /// `f64` samples.
    Double(Table<'a, f64>),
}

/// Where filtered samples go: contiguous, sample-major, in the filter's own precision.
#[derive(Debug)]
pub enum Sink<'a> {
    /// For a filter in `f32`.
    Single(&'a mut [f32]),
    /// For a filter in `f64`.
    Double(&'a mut [f64]),
}

/// Time between samples.
#[derive(Clone, Copy, Debug)]
pub enum Timing<'a> {
    /// Every sample is one nominal period after the one before.
    Regular,
    /// The time step of each sample in seconds.
    Steps(&'a [f64]),
}

impl Source<'_> {
    /// Number of samples and of channels.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        match self {
            Self::Single(table) => (table.rows, table.channels),
            Self::Double(table) => (table.rows, table.channels),
        }
    }
    /// The first `rows` samples.
    #[must_use]
    pub fn first(self, rows: usize) -> Self {
        match self {
            Self::Single(table) => Self::Single(table.first(rows)),
            Self::Double(table) => Self::Double(table.first(rows)),
        }
    }
    /// One sample, widened.
    #[must_use]
    pub fn at(&self, row: usize, channel: usize) -> f64 {
        match self {
            Self::Single(table) => table.at(row, channel).widen(),
            Self::Double(table) => table.at(row, channel),
        }
    }
}

impl<'a, T: Copy> Table<'a, T> {
    /// The table's first `rows` samples.
    #[must_use]
    pub fn first(self, rows: usize) -> Self {
        Self { rows: rows.min(self.rows), ..self }
    }
    /// One item.
    #[must_use]
    pub fn at(&self, row: usize, channel: usize) -> T {
        self.items[row * self.row_stride + channel * self.channel_stride]
    }
    /// A table over contiguous, sample-major items; `None` if they do not divide into `channels`.
    #[must_use]
    pub fn contiguous(items: &'a [T], channels: usize) -> Option<Self> {
        (channels > 0 && items.len().is_multiple_of(channels)).then(|| Self {
            items,
            rows: items.len() / channels,
            channels,
            row_stride: channels,
            channel_stride: 1,
        })
    }
}
