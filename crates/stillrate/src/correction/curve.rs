//! The error of a gyro as a smooth function of its rate (and temperature), evaluated without allocation.
//!
//! With inputs x scaled to xn = (x - centre) * scale (about -1..1 over the calibrated range):
//! e = output_offset + output_scale * (sum_k terms_k * monomial_k(xn) + sum_h w2_h tanh(b1_h + sum_i W1_hi xn_i)).
//! The published 1-10-1 network is the case of no terms but the constant (its output bias b2); a calibrated straight line is the case of
//! no hidden units. The monomials are those of total degree 0..=3 in the order of [`term_powers`].

use crate::error::ConfigError;
use crate::filter::Flags;
use crate::real::Real;

/// Most inputs: the rate and two more.
pub const INPUTS: usize = 3;
/// Most hidden units.
pub const HIDDEN: usize = 16;
/// Monomials of total degree up to 3 in three inputs.
pub const TERMS: usize = 20;
/// Most fixed-point steps. Each is a contraction by the slope: 32 exhaust `f64` up to a slope of 0.3.
const MOST_STEPS: u32 = 32;

/// The powers of (rate, second, third input) in each polynomial term, by rising total degree.
///
/// # Example
/// ```
/// use stillrate::correction::term_powers;
/// assert_eq!(term_powers()[..4], [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]);
/// ```
#[must_use]
pub const fn term_powers() -> [[u8; INPUTS]; TERMS] {
    [
        [0, 0, 0],
        [1, 0, 0],
        [0, 1, 0],
        [0, 0, 1],
        [2, 0, 0],
        [1, 1, 0],
        [1, 0, 1],
        [0, 2, 0],
        [0, 1, 1],
        [0, 0, 2],
        [3, 0, 0],
        [2, 1, 0],
        [2, 0, 1],
        [1, 2, 0],
        [1, 1, 1],
        [1, 0, 2],
        [0, 3, 0],
        [0, 2, 1],
        [0, 1, 2],
        [0, 0, 3],
    ]
}

/// An error curve e(rate, others) with the range it was calibrated on, all in the unit of the rate. Fields are public so that C and files
/// can hold it; [`ErrorCurve::checked`] says whether they make sense.
///
/// # Example
/// ```
/// use stillrate::correction::ErrorCurve;
/// // An offset of 0.03 deg/s and a scale-factor error of 0.2 %, calibrated over -6..6 deg/s.
/// let curve = ErrorCurve::<f32>::line(0.03, 0.002, -6.0, 6.0)?;
/// let corrected = curve.correct(5.04, [0.0; 2]);
/// assert!((corrected.rate - 5.0).abs() < 1e-5);
/// // Outside the range the value at the edge is held, so the slope there is 0.
/// assert_eq!((curve.error([9.0, 0.0, 0.0]).0, curve.slope([9.0, 0.0, 0.0])), (curve.error([6.0, 0.0, 0.0]).0, 0.0));
/// assert!((curve.slope([1.0, 0.0, 0.0]) - 0.002).abs() < 1e-9);
/// assert_eq!(ErrorCurve { hidden: 17, ..curve }.checked().unwrap_err().field, "hidden");
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct ErrorCurve<T> {
    /// Inputs in use, 1..=3.
    pub inputs: u32,
    /// Hidden units in use, 0..=16.
    pub hidden: u32,
    /// Evaluations of the curve per correction: 1 uses the measured rate as the argument (the published form), more solve w = y - e(w).
    pub steps: u32,
    /// Whether any polynomial term above the first degree is in use (kept as a number for C).
    pub cubic: u32,
    /// Lower edge of the calibrated range of each input.
    pub low: [T; INPUTS],
    /// Upper edge of the calibrated range of each input.
    pub high: [T; INPUTS],
    /// Subtracted from each input.
    pub centre: [T; INPUTS],
    /// Multiplies each centred input.
    pub scale: [T; INPUTS],
    /// Polynomial coefficients, in the order of [`term_powers`].
    pub terms: [T; TERMS],
    /// W1: weights from the inputs to the hidden units.
    pub input_weights: [[T; INPUTS]; HIDDEN],
    /// b1: biases of the hidden units.
    pub hidden_bias: [T; HIDDEN],
    /// W2: weights from the hidden units to the output.
    pub output_weights: [T; HIDDEN],
    /// Added to the scaled output, in the unit of the rate.
    pub output_offset: T,
    /// Multiplies the output, in the unit of the rate.
    pub output_scale: T,
}

/// A corrected rate, in the unit of the curve.
///
/// # Example
/// ```
/// use stillrate::{Flags, correction::{Corrected, ErrorCurve}};
/// let curve = ErrorCurve::<f64>::line(0.03, 0.0, -6.0, 6.0)?;
/// let Corrected { rate, error, flags } = curve.correct(7.0, [0.0; 2]);
/// assert_eq!((rate + error, error, flags), (7.0, 0.03, Flags::EDGE_HELD));
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corrected<T> {
    /// The measured rate less the error; NaN where the measurement was missing.
    pub rate: T,
    /// What was subtracted.
    pub error: T,
    /// [`Flags::EDGE_HELD`] outside the calibrated range, [`Flags::MISSING`] for a missing measurement.
    pub flags: Flags,
}

impl<T: Real> ErrorCurve<T> {
    /// A curve that is zero everywhere in a given range of rates.
    fn zero(low: f64, high: f64) -> Self {
        let [t0, t1] = [T::ZERO, T::ONE];
        let half = 0.5 * (high - low);
        Self {
            inputs: 1,
            hidden: 0,
            steps: 3,
            cubic: 0,
            low: [T::of(low), t0, t0],
            high: [T::of(high), t0, t0],
            centre: [T::of(0.5 * (low + high)), t0, t0],
            scale: [T::of(1.0 / half), t1, t1],
            terms: [t0; TERMS],
            input_weights: [[t0; INPUTS]; HIDDEN],
            hidden_bias: [t0; HIDDEN],
            output_weights: [t0; HIDDEN],
            output_offset: t0,
            output_scale: t1,
        }
    }

    /// The straight line e = `offset` + `slope` w, calibrated over `low..=high` (all in the unit of the rate; slope pure).
    ///
    /// # Errors
    /// [`ConfigError`] if a number is not finite, the range is empty or the slope is not within -0.5..0.5.
    pub fn line(offset: f64, slope: f64, low: f64, high: f64) -> Result<Self, ConfigError> {
        if !(slope.is_finite() && slope.magnitude() < 0.5) {
            return Err(ConfigError::new("slope", slope, "", "between -0.5 and 0.5"));
        }
        let mut curve = Self::zero(low, high);
        curve.terms[0] = T::of(offset + slope * 0.5 * (low + high));
        curve.terms[1] = T::of(slope * 0.5 * (high - low));
        curve.checked()
    }

    /// Passes the curve on if its counts are within capacity, every number in use is finite and every range is not empty.
    ///
    /// # Errors
    /// [`ConfigError`] that names the first field that is wrong.
    pub fn checked(self) -> Result<Self, ConfigError> {
        let count = |field, value: u32, low: u32, high: u32, range| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(ConfigError::new(field, f64::from(value), "", range))
            }
        };
        count("inputs", self.inputs, 1, INPUTS as u32, "1, 2 or 3")?;
        count("hidden", self.hidden, 0, HIDDEN as u32, "0 to 16")?;
        count("steps", self.steps, 1, MOST_STEPS, "1 to 32")?;
        let finite = |field, values: &[T]| match values.iter().find(|v| !v.finite()) {
            Some(value) => Err(ConfigError::new(field, value.widen(), "", "finite")),
            None => Ok(()),
        };
        finite("low", &self.low)?;
        finite("high", &self.high)?;
        finite("centre", &self.centre)?;
        finite("scale", &self.scale)?;
        finite("terms", &self.terms)?;
        self.input_weights.iter().try_for_each(|row| finite("input_weights", row))?;
        finite("hidden_bias", &self.hidden_bias)?;
        finite("output_weights", &self.output_weights)?;
        finite("output_offset", &[self.output_offset])?;
        finite("output_scale", &[self.output_scale])?;
        for (low, high) in self.low.iter().zip(&self.high).take(self.inputs as usize) {
            if low >= high {
                return Err(ConfigError::new("high", high.widen(), "", "above the lower edge of the range"));
            }
        }
        Ok(self)
    }

    /// The error at given inputs (rate first; unused inputs are ignored), the edge value outside the calibrated range.
    #[must_use]
    pub fn error(&self, inputs: [T; INPUTS]) -> (T, Flags) {
        let (scaled, flags) = self.scaled(inputs);
        (self.output_offset + self.output_scale * (self.polynomial(scaled) + self.network(scaled).0), flags)
    }

    /// Slope of the error in the rate (a pure number) inside the calibrated range; 0 outside, where the edge is held.
    #[must_use]
    pub fn slope(&self, inputs: [T; INPUTS]) -> T {
        let (xn, _) = self.scaled(inputs);
        let [rate, ..] = inputs;
        let inside = rate >= self.low[0] && rate <= self.high[0];
        let step = self.output_scale * self.scale[0] * (self.polynomial_slope(xn) + self.network(xn).1);
        T::select(inside, step, T::ZERO)
    }

    /// Solves w = `measured` - e(w, others) by [`ErrorCurve::steps`] fixed-point steps.
    #[must_use]
    pub fn correct(&self, measured: T, others: [T; INPUTS - 1]) -> Corrected<T> {
        if !measured.finite() {
            return Corrected { rate: T::of(f64::NAN), error: T::ZERO, flags: Flags::MISSING };
        }
        let [second, third] = others;
        let mut out = Corrected { rate: measured, error: T::ZERO, flags: Flags::NONE };
        for _ in 0..self.steps.min(MOST_STEPS) {
            let (error, flags) = self.error([out.rate, second, third]);
            out = Corrected { rate: measured - error, error, flags };
        }
        out
    }

    /// Inputs held at the edges of the calibrated range and scaled; a missing input becomes the middle and is flagged too.
    fn scaled(&self, inputs: [T; INPUTS]) -> ([T; INPUTS], Flags) {
        let mut flags = Flags::NONE;
        let mut xn = [T::ZERO; INPUTS];
        for (i, slot) in xn.iter_mut().enumerate().take(self.inputs as usize) {
            let x = T::select(inputs[i].finite(), inputs[i], (self.low[i] + self.high[i]) * T::HALF);
            let held = x.limited(self.low[i], self.high[i]);
            flags = flags.with(Flags::EDGE_HELD.when(held != inputs[i]));
            *slot = (held - self.centre[i]) * self.scale[i];
        }
        (xn, flags)
    }

    fn polynomial(&self, xn: [T; INPUTS]) -> T {
        let [x, y, z] = xn;
        let t = &self.terms;
        let line = t[0] + t[1] * x + t[2] * y + t[3] * z;
        if self.cubic == 0 {
            return line;
        }
        let square = t[4] * x * x + t[5] * x * y + t[6] * x * z + t[7] * y * y + t[8] * y * z + t[9] * z * z;
        let in_x = (t[10] * x + t[11] * y + t[12] * z) * x * x + (t[13] * y * y + t[14] * y * z + t[15] * z * z) * x;
        let rest = t[16] * y * y * y + t[17] * y * y * z + t[18] * y * z * z + t[19] * z * z * z;
        line + square + in_x + rest
    }

    fn polynomial_slope(&self, xn: [T; INPUTS]) -> T {
        let [x, y, z] = xn;
        let t = &self.terms;
        if self.cubic == 0 {
            return t[1];
        }
        let square = T::TWO * t[4] * x + t[5] * y + t[6] * z;
        let cube = T::of(3.0) * t[10] * x * x + T::TWO * (t[11] * y + t[12] * z) * x;
        t[1] + square + cube + t[13] * y * y + t[14] * y * z + t[15] * z * z
    }

    /// Sum over the hidden units and its derivative in the first scaled input.
    fn network(&self, xn: [T; INPUTS]) -> (T, T) {
        let units = self.input_weights.iter().zip(&self.hidden_bias).zip(&self.output_weights);
        let mut sum = T::ZERO;
        let mut slope = T::ZERO;
        for ((weights, &bias), &out) in units.take(self.hidden as usize) {
            let mut a = T::ZERO;
            for (&weight, &x) in weights.iter().zip(&xn).take(self.inputs as usize) {
                a += weight * x;
            }
            let h = (a + bias).tangent_hyperbolic();
            sum += out * h;
            slope += out * (T::ONE - h * h) * weights[0];
        }
        (sum, slope)
    }
}
