//! Fading factors: lambda >= 1 multiplies the predicted covariance when measurements exceed what the model expects.
//!
//! With C = (Delta - Q11 - R) / B11, B11 = (F P F')_11, lambda = max(1, C). The printed filter takes
//! Delta = sqrt(1/2) z^2 and |C|; the sound forms take the innovation, nu^2, or its windowed mean.
//!
//! Erratum: the printed Delta uses the measurement z instead of the innovation, and the absolute value fires on small z as
//! well. Both are kept as options because published figures depend on them.

use crate::real::Real;

/// Where Delta comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FadingSource {
    /// The measurement itself, as printed.
    Measurement,
    /// The innovation.
    Innovation,
    /// The innovation's mean square with a forgetting factor (strong tracking; Zhou and Frank 1996).
    Windowed,
}

/// Whether the sign of C counts.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FadingForm {
    /// No fading at all.
    None,
    /// |C|, as printed.
    Absolute,
    /// C.
    Signed,
}

/// When the fading factor acts.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FadingGate {
    /// At every sample.
    Always,
    /// Not while rest is declared.
    WhileMoving,
    /// Not while rest is declared, and only in the second model.
    SecondModelWhileMoving,
}

impl FadingGate {
    /// Whether model `i` fades.
    #[inline(always)]
    pub(crate) fn opens(self, at_rest: bool, i: usize) -> bool {
        match self {
            Self::Always => true,
            Self::WhileMoving => !at_rest,
            Self::SecondModelWhileMoving => !at_rest && i == 1,
        }
    }
}

/// The fading factor for Delta = `delta`, unfaded rate variance `b11`, process noise `q11` and (softened) measurement variance `r`.
#[inline(always)]
pub(crate) fn fading_factor<T: Real>(form: FadingForm, delta: T, b11: T, q11: T, r: T) -> T {
    let excess = delta - q11 - r;
    let ratio = match form {
        FadingForm::None => T::ONE,
        FadingForm::Absolute => excess.magnitude() / b11.magnitude(),
        FadingForm::Signed => excess / b11,
    };
    // max(1, NaN) must be 1: a degenerate ratio fades nothing.
    T::select(ratio > T::ONE, ratio, T::ONE)
}
