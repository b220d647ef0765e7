//! What an estimate says about the sample behind it.

/// What happened to a sample: a set of bits, zero when nothing did.
///
/// # Example
/// ```
/// use stillrate::Flags;
/// let value = f64::NAN;
/// let flags = Flags::MISSING.when(!value.is_finite()).with(Flags::NO_DATA_YET);
/// assert!(flags.has(Flags::MISSING) && !flags.has(Flags::DIVERGED));
/// assert_eq!(Flags::NONE.with(flags).0, 0b11); // the numbers that C and saved logs see
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(transparent)]
pub struct Flags(pub u32);

impl Flags {
    /// Nothing to report.
    pub const NONE: Self = Self(0);
    /// The sample was missing (NaN, infinite, masked): the filter coasted.
    pub const MISSING: Self = Self(1);
    /// No usable sample has been seen yet: the output is a finite placeholder.
    pub const NO_DATA_YET: Self = Self(1 << 1);
    /// The time step was zero (to [`SHORTEST_STEP`](crate::filter::SHORTEST_STEP) of the nominal one), negative or not finite: the sample was not used and no time passed.
    pub const BAD_TIME: Self = Self(1 << 2);
    /// The gap before this sample was so long that the filter started anew from it.
    pub const RESTARTED: Self = Self(1 << 3);
    /// The sample stands at the sensor's rail; it was used as a one-sided bound.
    pub const SATURATED: Self = Self(1 << 4);
    /// The sample was so far out that the outlier model took most of it.
    pub const OUTLIER: Self = Self(1 << 5);
    /// The filter lost its own state (non-finite) and started anew.
    pub const DIVERGED: Self = Self(1 << 6);
    /// The value was finite but beyond any physical rate for this configuration: treated as missing.
    pub const OUT_OF_RANGE: Self = Self(1 << 7);
    /// A change detector fired at this sample.
    pub const CHANGE: Self = Self(1 << 8);
    /// An error curve was asked outside the range it was calibrated on: its value at the edge was used.
    pub const EDGE_HELD: Self = Self(1 << 12);

    /// Both sets together.
    #[must_use]
    #[inline(always)]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
    /// This set where `condition` holds, else none.
    #[must_use]
    #[inline(always)]
    pub const fn when(self, condition: bool) -> Self {
        Self(if condition { self.0 } else { 0 })
    }
    /// Whether every bit of `other` is set.
    #[must_use]
    #[inline(always)]
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}
