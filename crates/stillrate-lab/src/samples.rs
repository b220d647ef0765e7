//! Samples as callers hold them: tables with any strides in either precision, where results go, and time steps.

use stillrate::Real;

/// Number type that a filter computes in.
///
/// # Example
/// ```
/// use stillrate_lab::runner::{Precision, build};
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
/// let filtered = |precision| -> Result<f64, stillrate_lab::settings_map::SettingsError> {
///     let mut sample = [0.1];
///     build("pt1", &settings, 1, precision)?.update(&mut sample, None);
///     Ok(sample[0])
/// };
/// assert_eq!(filtered(Precision::Double)?, 0.1);
/// assert_eq!(filtered(Precision::Single)?, f64::from(0.1_f32)); // 1.5e-9 larger
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// `f32`
    Single,
    /// `f64`
    Double,
}

/// A read-only table of samples with any non-negative strides (in items).
///
/// # Example
/// ```
/// use stillrate_lab::runner::Table;
/// let rates = [0.1, -0.2, 0.3, 0.4, 0.5, 0.6]; // two samples of three axes
/// let table = Table::contiguous(&rates, 3).unwrap();
/// assert_eq!((table.rows, table.row_stride), (2, 3));
/// let second_axis = Table { items: &rates[1..5], channels: 1, ..table }; // in place, nothing copied
/// assert_eq!(second_axis.items[second_axis.row_stride], 0.5);
/// assert!(Table::contiguous(&rates, 4).is_none());
/// ```
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

/// Samples in either precision, in the unit of the filter's noise (deg/s); one that is not finite is missing. A filter in the other
/// precision converts them.
///
/// # Example
/// ```
/// use stillrate_lab::runner::{Sink, Source, Precision, Table, Timing, build};
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
/// let mut filter = build("pt1", &settings, 1, Precision::Double)?;
/// let (samples, mut rates) = ([0.5_f32, 0.5], [0.0; 2]);
/// let source = Source::Single(Table::contiguous(&samples, 1).unwrap());
/// assert!(filter.run(source, Timing::Regular, Sink::Double(&mut rates)));
/// assert_eq!(rates, [0.5, 0.5]);
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// `f32` samples.
    Single(Table<'a, f32>),
    /// `f64` samples.
    Double(Table<'a, f64>),
}

/// Where filtered samples go: contiguous, sample-major, in the filter's own precision.
///
/// # Example
/// ```
/// use stillrate_lab::runner::{Sink, Source, Precision, Table, Timing, build};
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
/// let mut filter = build("pt1", &settings, 1, Precision::Single)?;
/// let source = Source::Double(Table::contiguous(&[0.5, 0.5], 1).unwrap());
/// let (mut single, mut double) = ([0.0; 2], [0.0; 2]);
/// assert!(filter.run(source, Timing::Regular, Sink::Single(&mut single)));
/// assert_eq!(single, [0.5; 2]);
/// assert!(!filter.run(source, Timing::Regular, Sink::Double(&mut double))); // not the filter's precision
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
#[derive(Debug)]
pub enum Sink<'a> {
    /// For a filter in `f32`.
    Single(&'a mut [f32]),
    /// For a filter in `f64`.
    Double(&'a mut [f64]),
}

/// Time between samples.
///
/// # Example
/// ```
/// use stillrate_lab::runner::{Sink, Source, Precision, Table, Timing, build};
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let number = |name: &str, value| (name.to_string(), Value::Number(value));
/// let settings = SettingsMap::from([number("sample_rate_hz", 50.0), number("cutoff_hz", 8.0)]);
/// let source = Source::Double(Table::contiguous(&[0.0, 1.0], 1).unwrap());
/// let last = |timing| -> Result<f64, stillrate_lab::settings_map::SettingsError> {
///     let mut rates = [0.0; 2];
///     build("pt1", &settings, 1, Precision::Double)?.run(source, timing, Sink::Double(&mut rates));
///     Ok(rates[1])
/// };
/// assert_eq!(last(Timing::Regular)?, last(Timing::Steps(&[0.02, 0.02]))?);
/// assert!(last(Timing::Steps(&[0.02, 0.06]))? > last(Timing::Regular)?); // after a gap the filter trusts the new sample more
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub enum Timing<'a> {
    /// Every sample is one nominal period after the one before.
    Regular,
    /// The time step of each sample in seconds.
    Steps(&'a [f64]),
}

impl Source<'_> {
    /// Number of samples and of channels.
    pub(crate) fn shape(&self) -> (usize, usize) {
        match self {
            Self::Single(table) => (table.rows, table.channels),
            Self::Double(table) => (table.rows, table.channels),
        }
    }
    /// The first `rows` samples.
    pub(crate) fn first(self, rows: usize) -> Self {
        match self {
            Self::Single(table) => Self::Single(table.first(rows)),
            Self::Double(table) => Self::Double(table.first(rows)),
        }
    }
    /// One sample, widened.
    pub(crate) fn at(&self, row: usize, channel: usize) -> f64 {
        match self {
            Self::Single(table) => table.at(row, channel).widen(),
            Self::Double(table) => table.at(row, channel),
        }
    }
}

impl<'a, T: Copy> Table<'a, T> {
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

    fn first(self, rows: usize) -> Self {
        Self { rows: rows.min(self.rows), ..self }
    }

    fn at(&self, row: usize, channel: usize) -> T {
        self.items[row * self.row_stride + channel * self.channel_stride]
    }
}
