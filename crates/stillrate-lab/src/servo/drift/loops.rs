//! From the pieces of a servo to the path its gyro's noise takes to the angle.
//!
//! G_vc = num/den is the closed rate loop. Rate loop alone (eq. 3): H = -G_vc / s. Tracked loop (eq. 6): the angle error
//! is fed back through K_apr = kb/ka, H = -G_vc / (s + K_apr G_vc); its gain for a constant bias is -1/K_apr(0). A filter F stands in one of three places
//! ([`FilterPosition`]). With the open rate loop KG = G_vc / (1 - G_vc) = num / (den - num), each
//! place gives a command path C (rate demand to rate) and a noise path M (noise to rate), and H = -M / (s + K_apr C).

use stillrate::Real;

use super::polynomial::{add, divide, multiply};
use super::{DriftError, TransferFunction};

/// Where the filter stands.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::{DriftLoop, FilterPosition, TransferFunction, steady_state};
/// let lag = |a: f64| TransferFunction::new(&[a], &[1.0, a]).unwrap();
/// let variance = |position| {
///     let servo = DriftLoop::rate_only(lag(20.0)).tracked(&[2.0], &[1.0]).unwrap();
///     steady_state(&servo.filtered(lag(33.3), position).noise_path().unwrap()).unwrap()
/// };
/// // Without a filter 1/(2 k) = 0.25. Before the loop a filter takes a little away, within it its lag adds to the drift.
/// assert!(variance(FilterPosition::BeforeLoop) < 0.25);
/// assert!((variance(FilterPosition::ForwardPath) - 0.25 * 33.3 / (33.3 - 2.0)).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum FilterPosition {
    /// Before the loop, outside feedback: H is multiplied by F.
    #[default]
    BeforeLoop,
    /// In the rate feedback: noise KGF/(1+KGF), command KG/(1+KGF).
    RateFeedback,
    /// In the forward path of the rate loop: KGF/(1+KGF) in both paths.
    ForwardPath,
}

/// A servo whose gyro is noisy.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::{DriftLoop, FilterPosition, TransferFunction, steady_state};
/// let rate_loop = TransferFunction::new(&[20.0], &[1.0, 20.0]).unwrap();
/// let servo = DriftLoop::rate_only(rate_loop.clone()).tracked(&[2.0], &[1.0]).unwrap();
/// let h = servo.noise_path().unwrap();
/// assert!((steady_state(&h).unwrap() - 0.25).abs() < 1e-15); // 1/(2 k), whatever the rate loop's bandwidth
/// assert_eq!(servo.bias_gain(), -0.5); // a bias of 1 deg/s leaves -1/k deg
/// // A filter with a gain of 1 at rest changes nothing there, and neither does a dead time.
/// let late = servo.filtered(rate_loop, FilterPosition::BeforeLoop).delayed(0.01).unwrap();
/// assert!((late.power_gain().unwrap()(1e-6) - 0.25).abs() < 1e-9);
/// assert!(late.noise_path().is_err()); // not rational any more
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DriftLoop {
    rate_loop: TransferFunction,
    tracking: Option<TransferFunction>,
    filter: Option<(TransferFunction, FilterPosition)>,
    dead_time_s: f64,
}

impl DriftLoop {
    /// The closed rate loop G_vc alone.
    #[must_use]
    pub fn rate_only(rate_loop: TransferFunction) -> Self {
        Self { rate_loop, tracking: None, filter: None, dead_time_s: 0.0 }
    }

    /// With an angle loop K_apr = `kb`/`ka` around it (needs an angle sensor that does not come from the gyro).
    ///
    /// # Errors
    /// Bad polynomials.
    pub fn tracked(self, kb: &[f64], ka: &[f64]) -> Result<Self, DriftError> {
        Ok(Self { tracking: Some(TransferFunction::new(kb, ka)?), ..self })
    }

    /// With a filter in one of three places.
    #[must_use]
    pub fn filtered(self, filter: TransferFunction, position: FilterPosition) -> Self {
        Self { filter: Some((filter, position)), ..self }
    }

    /// With a dead time in the rate loop's output. Such a loop is not rational: use
    /// [`drift_in_band`](super::drift_in_band).
    ///
    /// # Errors
    /// A negative or non-finite time.
    pub fn delayed(self, dead_time_s: f64) -> Result<Self, DriftError> {
        Ok(Self { dead_time_s: stillrate::error::not_negative("dead_time_s", dead_time_s, "s")?, ..self })
    }

    /// Noise path M and command path C of the rate loop, with the filter in its place.
    fn paths(&self) -> Result<(TransferFunction, TransferFunction), DriftError> {
        let g = &self.rate_loop;
        let Some((f, position)) = &self.filter else {
            return Ok((g.clone(), g.clone()));
        };
        if *position == FilterPosition::BeforeLoop {
            return Ok((g.times(f), g.clone()));
        }
        let negative: Vec<f64> = g.numerator.iter().map(|c| -c).collect();
        let open_denominator = add(&g.denominator, &negative);
        let (fn_, fd) = (&f.numerator, &f.denominator);
        let numerator = multiply(&g.numerator, fn_);
        let closed = add(&multiply(&open_denominator, fd), &numerator);
        let noise = TransferFunction::new(&numerator, &closed)?;
        let command = match position {
            FilterPosition::RateFeedback => TransferFunction::new(&multiply(&g.numerator, fd), &closed)?,
            _ => noise.clone(),
        };
        Ok((noise, command))
    }

    /// H = -M / (s + K C): from gyro noise to angle.
    ///
    /// # Errors
    /// Bad polynomials, or a dead time (which no rational function has).
    pub fn noise_path(&self) -> Result<TransferFunction, DriftError> {
        if self.dead_time_s > 0.0 {
            return Err(DriftError::BadPolynomial(
                "a dead time is not rational: give a band, the variance is then found by quadrature",
            ));
        }
        let (noise, command) = self.paths()?;
        let negative: Vec<f64> = noise.numerator.iter().map(|c| -c).collect();
        let before = matches!(self.filter, Some((_, FilterPosition::BeforeLoop)));
        let Some(k) = &self.tracking else {
            return TransferFunction::new(&negative, &multiply(&noise.denominator, &[1.0, 0.0]));
        };
        // s + K C over the common denominator ka * C's denominator.
        let sum = add(
            &multiply(&multiply(&k.denominator, &command.denominator), &[1.0, 0.0]),
            &multiply(&k.numerator, &command.numerator),
        );
        let (top, bottom) = (multiply(&negative, &k.denominator), sum);
        // M and C share their denominator except for a filter before the loop, whose poles stay on M.
        let bottom = if before { multiply(&bottom, &self.filter_denominator()) } else { bottom };
        TransferFunction::new(&top, &bottom)
    }

    fn filter_denominator(&self) -> Vec<f64> {
        self.filter.as_ref().map_or_else(|| vec![1.0], |(f, _)| f.denominator.clone())
    }

    /// |H(j omega)|^2 for omega in rad/s, dead time included.
    ///
    /// # Errors
    /// Bad polynomials.
    pub fn power_gain(&self) -> Result<impl Fn(f64) -> f64 + use<>, DriftError> {
        let (noise, command) = self.paths()?;
        let (tracking, dead) = (self.tracking.clone(), self.dead_time_s);
        Ok(move |omega: f64| {
            let m = noise.power_gain(omega);
            let feedback = tracking.as_ref().map_or((0.0, 0.0), |k| {
                let (sine, cosine) = (-omega * dead).sine_cosine();
                product(product(k.response(omega), command.response(omega)), (cosine, sine))
            });
            let below = (feedback.0, feedback.1 + omega);
            m / (below.0 * below.0 + below.1 * below.1)
        })
    }

    /// Gain from a constant rate bias to the angle, -1/K_apr(0); infinite without tracking.
    #[must_use]
    pub fn bias_gain(&self) -> f64 {
        let Some(k) = &self.tracking else { return f64::NEG_INFINITY };
        let (re, _) = divide((1.0, 0.0), k.response(0.0));
        if re.is_finite() { -re } else { 0.0 }
    }
}

fn product(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}
