//! Configuration -> state -> step: what every filter of the library is.
//!
//! A filter value *is* its checked configuration; it is built once by a fallible constructor and shared by all
//! channels. Its [`Filter::State`] is plain data made of numbers only ([`Reals`]). A step takes the configuration, the state and one
//! [`Sample`] and gives one [`Estimate`]; it cannot fail, allocate or panic, whatever the sample is.

pub use crate::flags::Flags;
use crate::real::Real;
use crate::reals::Reals;

/// One measurement and the time since the one before.
///
/// A non-finite `value` is a missing sample.
///
/// # Example
/// ```
/// use stillrate::{Flags, Sample};
/// let missing = Sample { value: f64::NAN, dt: 0.02 };
/// assert_eq!(missing.check(1000.0, 0.02).flags, Flags::MISSING);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<T> {
    /// Measured rate (any unit; deg/s at the user's edge), NaN or infinite when missing.
    pub value: T,
    /// Time since the previous sample in seconds.
    pub dt: T,
}

/// What a step knows afterwards.
///
/// # Example
/// ```
/// use stillrate::{Estimate, Filter, Flags, GyroNoise, Sample, Settings, filters::RecursiveLeastSquaresSettings};
/// let noise = GyroNoise::from_standard_deviation_at_rate(0.1, 200.0);
/// let settings = RecursiveLeastSquaresSettings { order: 2.0, ..Settings::defaults(200.0, noise) };
/// let filter = settings.build::<f64>()?;
/// let (mut state, mut estimate) = (filter.start(), Estimate::default());
/// for k in 0..400 {
///     estimate = filter.step(&mut state, Sample { value: 0.05 * f64::from(k), dt: 0.005 });
/// }
/// assert!((estimate.acceleration - 10.0).abs() < 1e-9); // 0.05 deg/s in 5 ms, per second
/// assert!(estimate.variance < 0.1 * 0.1 && estimate.flags == Flags::NONE);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Estimate<T> {
    /// Filtered rate, in the unit of the input. Always finite.
    pub rate: T,
    /// Its time derivative, per second; 0 for filters that do not estimate it.
    pub acceleration: T,
    /// Variance of the rate as the filter believes it, in the input's unit squared; 0 for filters that have no opinion.
    pub variance: T,
    /// What happened to this sample.
    pub flags: Flags,
}

/// What one model of a bank did at one sample; given to an [`Observer`].
///
/// # Example
/// ```
/// use stillrate::{Filter, GyroNoise, ModelTrace, Observer, Sample, Settings, filters::SingerImmKfSettings};
/// struct Mean(f64);
/// impl Observer<f64> for Mean {
///     fn model(&mut self, _index: usize, trace: ModelTrace<f64>) {
///         self.0 += trace.probability * trace.rate;
///     }
/// }
/// let filter = SingerImmKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015)).build()?;
/// let mut state = filter.start();
/// for value in [0.12, 0.09, 0.15] {
///     let mut mean = Mean(0.0);
///     let estimate = filter.observe(&mut state, Sample { value, dt: 0.02 }, &mut mean);
///     assert!((estimate.rate - mean.0).abs() < 1e-15); // the fused rate is the mean over the models
/// }
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModelTrace<T> {
    /// Posterior probability of the model.
    pub probability: T,
    /// Innovation, in the unit of the input: measurement minus prediction. NaN when the sample was missing.
    pub innovation: T,
    /// Innovation variance, in that unit squared.
    pub innovation_variance: T,
    /// Fading factor that was applied (1: none).
    pub fading: T,
    /// Reciprocal of the manoeuvre time constant, 1/s.
    pub alpha: T,
    /// The model's own posterior rate, in the unit of the input.
    pub rate: T,
}

/// Watches a step from inside. `()` watches nothing and costs nothing.
///
/// # Example
/// ```
/// use stillrate::{Filter, GyroNoise, ModelTrace, Observer, Sample, Settings, filters::MsImmIkfSettings};
/// #[derive(Default)]
/// struct Watch {
///     probability: f64,
///     frequency_rad_s: f64,
/// }
/// impl Observer<f64> for Watch {
///     fn model(&mut self, _index: usize, trace: ModelTrace<f64>) {
///         self.probability += trace.probability;
///     }
///     fn frequency(&mut self, rad_s: f64) {
///         self.frequency_rad_s = rad_s;
///     }
/// }
/// let filter = MsImmIkfSettings::defaults(100.0, GyroNoise::from_density_two_sided(0.015)).build()?;
/// let (mut state, mut seen) = (filter.start(), Watch::default());
/// for k in 0..2000 {
///     let value = 20.0 * (0.18 * f64::from(k)).sin(); // 18 rad/s
///     seen = Watch::default();
///     filter.observe(&mut state, Sample { value, dt: 0.01 }, &mut seen);
/// }
/// assert!((seen.frequency_rad_s - 18.0).abs() < 0.5);
/// assert!((seen.probability - 1.0).abs() < 1e-12); // over all models
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
/// let filter = Pt1::<f64>::new(50.0, 8.0)?;
/// assert_eq!((filter.period(), filter.models()), (0.02, 1));
/// let mut state = filter.start();
/// let estimate = filter.step(&mut state, Sample { value: 1.0, dt: 0.02 });
/// assert_eq!(estimate.rate, 1.0); // the first sample starts the filter
/// let (mut watched, next) = (state, Sample { value: 2.0, dt: 0.02 });
/// assert_eq!(filter.observe(&mut watched, next, &mut ()), filter.step(&mut state, next));
/// # Ok::<(), stillrate::ConfigError>(())
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
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, Sample, block::store, filters::Pt1};
    /// let filter = Pt1::<f32>::new(1000.0, 20.0)?;
    /// let mut lanes = [[0.0; 4]; 2]; // two numbers a state, four channels
    /// (0..4).for_each(|c| store(&filter.start(), &mut lanes, c));
    /// let mut tile = [[1.0, 2.0, 3.0, 4.0], [0.0; 4]];
    /// filter.tile(&mut lanes, &mut tile, 0.001);
    /// let mut alone = filter.start();
    /// let last = [4.0, 0.0].map(|value| filter.step(&mut alone, Sample { value, dt: 0.001 }).rate)[1];
    /// assert_eq!(tile[1][3], last);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
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
///
/// # Example
/// ```
/// use stillrate::{Flags, Sample};
/// let late = Sample { value: 3.0, dt: 12.0 }.check(1000.0, 0.02);
/// assert!(late.present && late.restart && late.flags == Flags::RESTARTED);
/// let again = Sample { value: 3.0, dt: 0.0 }.check(1000.0, 0.02); // a repeated time stamp
/// assert!(!again.present && !again.moves && again.dt == 0.02);
/// assert_eq!(Sample { value: 1e9, dt: 0.02 }.check(1000.0, 0.02).flags, Flags::OUT_OF_RANGE);
/// ```
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
    /// The flags of a step that ends with `started` (1 or 0) and found a `sound` state or lost it.
    #[inline(always)]
    pub(crate) fn flags_after(&self, started: T, sound: bool) -> Flags {
        self.flags.with(Flags::NO_DATA_YET.when(started == T::ZERO)).with(Flags::DIVERGED.when(!sound))
    }

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
