//! Configuration -> state -> step: what every filter of the library is.
//!
//! A filter value *is* its checked configuration; it is built once by a fallible constructor and shared by all
//! channels. Its [`Filter::State`] is plain data made of numbers only ([`Reals`]). A step takes the configuration, the state and one
//! [`Sample`] and gives one [`Estimate`]; it cannot fail, allocate or panic, whatever the sample is.

use crate::real::Real;
use crate::reals::Reals;

/// One measurement and the time since the one before.
///
/// A non-finite `value` is a missing sample.
///
/// # Example
/// ```
/// use stillrate::Sample;
/// let missing = Sample { value: f64::NAN, dt: 0.02 };
/// assert!(missing.value.is_nan());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<T> {
    /// Measured rate (any unit; deg/s at the user's edge), NaN or infinite when missing.
    pub value: T,
    /// Time since the previous sample in seconds.
    pub dt: T,
}

/// What a step knows afterwards.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Estimate<T> {
    /// Filtered rate, in the unit of the input. Always finite.
    pub rate: T,
    /// Its time derivative, per second; 0 for filters that do not estimate it.
    pub acceleration: T,
    /// Variance of the rate as the filter believes it; 0 for filters that have no opinion.
    pub variance: T,
    /// What happened to this sample.
    pub flags: Flags,
}

/// What happened to a sample: a set of bits, zero when nothing did.
///
/// # Example
/// ```
/// use stillrate::Flags;
/// let flags = Flags::MISSING.with(Flags::NO_DATA_YET);
/// assert!(flags.has(Flags::MISSING) && !flags.has(Flags::DIVERGED));
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
    /// The time step was zero (to [`SHORTEST_STEP`] of the nominal one), negative or not finite: the sample was not used and no time passed.
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

/// What one model of a bank did at one sample; given to an [`Observer`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModelTrace<T> {
    /// Posterior probability of the model.
    pub probability: T,
    /// Innovation: measurement minus prediction. NaN when the sample was missing.
    pub innovation: T,
    /// Innovation variance.
    pub innovation_variance: T,
    /// Fading factor that was applied (1: none).
    pub fading: T,
    /// Reciprocal of the manoeuvre time constant, 1/s.
    pub alpha: T,
    /// The model's own posterior rate.
    pub rate: T,
}

/// Watches a step from inside. `()` watches nothing and costs nothing.
///
/// # Example
/// ```
/// use stillrate::{Filter, GyroNoise, ModelTrace, Observer, Sample, Settings, filters::SingerImmKfSettings};
/// struct Probabilities([f64; 2]);
/// impl Observer<f64> for Probabilities {
///     fn model(&mut self, index: usize, trace: ModelTrace<f64>) {
///         self.0[index] = trace.probability;
///     }
/// }
/// let filter = SingerImmKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015)).build()?;
/// let (mut state, mut seen) = (filter.start(), Probabilities([0.0; 2]));
/// filter.observe(&mut state, Sample { value: 0.12, dt: 0.02 }, &mut seen);
/// assert!((seen.0[0] + seen.0[1] - 1.0).abs() < 1e-15);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub trait Observer<T> {
    /// Called once a model and sample, in model order.
    #[inline(always)]
    fn model(&mut self, _index: usize, _trace: ModelTrace<T>) {}
    /// Called once a sample with the manoeuvre frequency in rad/s used at it.
    #[inline(always)]
    fn frequency(&mut self, _rad_s: T) {}
}

impl<T> Observer<T> for () {}

/// A filter: `self` is the checked configuration.
///
/// # Example
/// ```
/// use stillrate::{Filter, Sample, filters::Pt1};
/// let filter = Pt1::<f64>::new(50.0, 8.0).unwrap();
/// let mut state = filter.start();
/// let estimate = filter.step(&mut state, Sample { value: 1.0, dt: 0.02 });
/// assert_eq!(estimate.rate, 1.0); // the first sample starts the filter
/// ```
pub trait Filter<T: Real>: Copy + Send + Sync {
    /// Everything that changes from sample to sample: plain numbers.
    type State: Reals<T> + core::fmt::Debug + PartialEq + Send + Sync;

    /// The state before the first sample.
    fn start(&self) -> Self::State;

    /// One sample, watched from inside. Never fails, allocates or panics.
    fn observe<O: Observer<T>>(&self, state: &mut Self::State, sample: Sample<T>, observer: &mut O) -> Estimate<T>;

    /// One sample. Never fails, allocates or panics.
    #[inline(always)]
    fn step(&self, state: &mut Self::State, sample: Sample<T>) -> Estimate<T> {
        self.observe(state, sample, &mut ())
    }

    /// Whether a state is one that steps of this filter can leave behind: to be asked of a state that comes from a file or a caller.
    /// Whatever comes after a state that is accepted, every estimate is finite and no variance negative.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, filters::Pt1};
    /// let filter = Pt1::<f32>::new(1000.0, 20.0)?;
    /// let mut state = filter.start();
    /// assert!(filter.accepts(&state));
    /// state.level = f32::INFINITY;
    /// assert!(!filter.accepts(&state));
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    fn accepts(&self, state: &Self::State) -> bool {
        let mut finite = true;
        state.scatter(&mut |number: T| finite &= number.finite());
        finite
    }

    /// The configured sample period in seconds.
    fn period(&self) -> T;

    /// How many models run side by side (1 for a plain filter).
    #[inline(always)]
    fn models(&self) -> usize {
        1
    }

    /// Whether the channels of a tile are filtered faster side by side than one after the other.
    const SIDE_BY_SIDE: bool = true;

    /// Filters a tile of samples of `W` channels in place: `tile[k][c]` is sample `k` of channel `c`.
    /// `lanes` is the channel-minor state (see [`block`](crate::block)); `dt` is the time step of every row.
    /// The result has the same bits as [`Filter::step`] on each channel.
    #[inline(always)]
    fn tile<const W: usize>(&self, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
        crate::block::step_rows(self, lanes, tile, dt);
    }
}

/// A gap longer than this (in seconds) says nothing about the motion before it: filters start anew.
pub const LONGEST_GAP_S: f64 = 10.0;

/// A time step below this share of the nominal one is a repeated time stamp with rounding errors: no time passed.
pub const SHORTEST_STEP: f64 = 1e-6;

/// A sample after the checks that every filter shares.
#[derive(Clone, Copy, Debug)]
pub struct Checked<T> {
    /// The measured value, 0 where it is not `present`.
    pub value: T,
    /// Whether there is a usable value.
    pub present: bool,
    /// Whether time moved forward by a finite step.
    pub moves: bool,
    /// Time step, the nominal one where the given one is unusable.
    pub dt: T,
    /// Whether the gap before this sample exceeds [`LONGEST_GAP_S`].
    pub restart: bool,
    /// The flags these checks raise.
    pub flags: Flags,
}

impl<T: Real> Checked<T> {
    /// Whether (1) or not (0) something is known when this sample arrives: after so long a gap nothing is until there is a value.
    #[inline(always)]
    pub(crate) fn known(&self, started: T) -> T {
        T::select(self.restart && !self.present, T::ZERO, started)
    }
}

impl<T: Real> Sample<T> {
    /// Sorts out missing values, absurd values (`|value| > limit`) and unusable time steps.
    #[must_use]
    #[inline(always)]
    pub fn check(self, limit: T, nominal_dt: T) -> Checked<T> {
        let finite = self.value.finite();
        let inside = self.value.magnitude() <= limit;
        let moves = self.dt.finite() && self.dt > nominal_dt * T::of(SHORTEST_STEP);
        let restart = moves && self.dt > T::of(LONGEST_GAP_S).most(nominal_dt * T::of(3.0));
        let present = finite && inside && moves;
        Checked {
            value: T::select(present, self.value, T::ZERO),
            present,
            moves,
            dt: T::select(moves, self.dt, nominal_dt),
            restart,
            flags: Flags::MISSING
                .when(!finite)
                .with(Flags::OUT_OF_RANGE.when(finite && !inside))
                .with(Flags::BAD_TIME.when(!moves))
                .with(Flags::RESTARTED.when(restart)),
        }
    }
}
