//! Which of the coefficients a filter estimates: the gauge, the optional ones, and their order in a filter's state.

use super::coefficients::{
    COUNT, FORCE_ABOUT_OUTPUT, FORCE_ABOUT_PENDULOUS, FORCE_BIAS, FORCE_QUADRATIC, GYRO_ABOUT_OUTPUT, GYRO_ABOUT_SPIN,
    LATENCY, LATITUDE, TORQUER, Triads,
};
use crate::error::ConfigError;

/// The optional states beyond the 33 of the basic model.
///
/// # Example
/// ```
/// use stillrate::gimbal::{Gauge, Options, Selection};
/// let all = Options { torquer: true, quadratic: true, latency: true, latitude: true };
/// assert_eq!(Selection::<41>::new(Gauge::Accelerometer, all).unwrap().count(), 38);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a setting of its own")]
pub struct Options {
    /// Torquer scale errors (3).
    pub torquer: bool,
    /// Quadratic accelerometer coefficients (3).
    pub quadratic: bool,
    /// Latency of the accelerometers against the command (1).
    pub latency: bool,
    /// Error of the given latitude (1).
    pub latitude: bool,
}

/// Which three mounting angles are held at zero: a common rotation of the platform frame cannot be seen by any motion.
///
/// # Example
/// ```
/// use stillrate::gimbal::{Gauge, NAMES, Triads};
/// let held = Gauge::Accelerometer.fixed(&Triads::default()).unwrap();
/// assert_eq!(held.map(|index| NAMES[index]), ["thp_x", "tho_x", "tho_y"]);
/// assert_eq!(Gauge::None.fixed(&Triads::default()), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gauge {
    /// The accelerometer x input axis is the platform x axis and the accelerometer y input axis lies in the x-y plane.
    #[default]
    Accelerometer,
    /// The same with the gyro x and y input axes.
    Gyro,
    /// Nothing is held: twelve mounting angles of which three combinations stay at the prior.
    None,
}

impl Gauge {
    /// The coefficients this gauge holds at zero: both angles of instrument x, and of instrument y the angle that would
    /// lift its input axis out of the plane of the two nominal input axes.
    #[must_use]
    pub fn fixed(self, triads: &Triads) -> Option<[usize; 3]> {
        let third = |triad: &[[usize; 3]; 3]| 3 - triad[0][0] - triad[1][0];
        match self {
            Self::Accelerometer => {
                let about_output = triads.accelerometer[1][1] == third(&triads.accelerometer);
                let last = if about_output { FORCE_ABOUT_OUTPUT + 1 } else { FORCE_ABOUT_PENDULOUS + 1 };
                Some([FORCE_ABOUT_PENDULOUS, FORCE_ABOUT_OUTPUT, last])
            }
            Self::Gyro => {
                let about_spin = triads.gyro[1][1] == third(&triads.gyro);
                let last = if about_spin { GYRO_ABOUT_SPIN + 1 } else { GYRO_ABOUT_OUTPUT + 1 };
                Some([GYRO_ABOUT_OUTPUT, GYRO_ABOUT_SPIN, last])
            }
            Self::None => None,
        }
    }
}

/// Which coefficients a filter of capacity `N` estimates: attitude first, then what turns the platform, then what the
/// accelerometers add, so that the kernels work on contiguous ranges.
///
/// # Example
/// ```
/// use stillrate::gimbal::{Gauge, NAMES, Options, Selection, Triads};
/// let free = Selection::<32>::new(Gauge::Gyro, Options::default())?;
/// assert_eq!((free.count(), NAMES[free.indices()[3]]), (30, "kg0x")); // 33 less three held angles
/// assert!(Selection::<29>::new(Gauge::Gyro, Options::default()).is_err()); // no room
/// let left_handed = Triads { gyro: [[0, 2, 1], [1, 0, 2], [2, 1, 0]], ..Triads::default() };
/// assert_ne!(Selection::<32>::for_triads(Gauge::Gyro, Options::default(), &left_handed)?, free);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selection<const N: usize> {
    index: [usize; N],
    count: usize,
    turning: usize,
    position: [usize; COUNT],
}

/// Whether a coefficient acts on the motion of the platform (the others act on the outputs only).
const fn turns(index: usize) -> bool {
    index < FORCE_BIAS || (index >= TORQUER && index < FORCE_QUADRATIC) || index == LATITUDE
}

impl<const N: usize> Selection<N> {
    /// The coefficients that are free in a gauge of the default triads, and the chosen optional ones.
    ///
    /// # Errors
    /// [`ConfigError`] when they do not fit into the capacity `N`.
    pub fn new(gauge: Gauge, options: Options) -> Result<Self, ConfigError> {
        Self::for_triads(gauge, options, &Triads::default())
    }

    /// The coefficients that are free in a gauge of any triads, and the chosen optional ones.
    ///
    /// # Errors
    /// [`ConfigError`] when they do not fit into the capacity `N`, or the triads are no permutations.
    pub fn for_triads(gauge: Gauge, options: Options, triads: &Triads) -> Result<Self, ConfigError> {
        triads.check()?;
        let mut keep = [true; COUNT];
        for fixed in gauge.fixed(triads).into_iter().flatten() {
            keep[fixed] = false;
        }
        for axis in 0..3 {
            keep[TORQUER + axis] = options.torquer;
            keep[FORCE_QUADRATIC + axis] = options.quadratic;
        }
        keep[LATENCY] = options.latency;
        keep[LATITUDE] = options.latitude;
        Self::of(&keep)
    }

    /// The marked coefficients; the attitude is always among them.
    ///
    /// # Errors
    /// [`ConfigError`] when they do not fit into the capacity `N`.
    pub(super) fn of(keep: &[bool; COUNT]) -> Result<Self, ConfigError> {
        let mut selection = Self { index: [0; N], count: 0, turning: 0, position: [usize::MAX; COUNT] };
        for wanted in [true, false] {
            for i in 0..COUNT {
                if (i < 3 || keep[i]) && turns(i) == wanted {
                    let at = selection.count;
                    let Some(slot) = selection.index.get_mut(at) else {
                        return Err(ConfigError::new(
                            "coefficients",
                            (at + 1) as f64,
                            "",
                            "no more than the capacity of the filter",
                        ));
                    };
                    *slot = i;
                    selection.position[i] = at;
                    selection.count += 1;
                }
            }
            if wanted {
                selection.turning = selection.count;
            }
        }
        Ok(selection)
    }

    /// How many coefficients are estimated.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// How many of them act on the motion (attitude included); they come first.
    #[must_use]
    pub(super) const fn turning(&self) -> usize {
        self.turning
    }

    /// The estimated coefficients by their place in [`Coefficients`](super::Coefficients), in the order of the filter state.
    #[must_use]
    pub fn indices(&self) -> &[usize] {
        self.index.get(..self.count).unwrap_or(&[])
    }

    /// Place of a coefficient in the filter state, or beyond every state where it is not estimated.
    #[must_use]
    #[inline(always)]
    pub(super) fn position(&self, coefficient: usize) -> usize {
        self.position.get(coefficient).copied().unwrap_or(usize::MAX)
    }
}
