//! The responses of filters that let through the same share of white noise: what they differ in is lag.

use stillrate::filters::{BiquadSettings, FirLowPassSettings, Pt1};
use stillrate::{ConfigError, Settings};

use super::bench::{least_squares, noise};
use super::response::{Response, feed, response};
use super::scenarios::SAMPLE_RATE_HZ;

/// Filters with matched noise reduction, by name.
///
/// # Errors
/// None in practice: the filters are ours.
///
/// # Example
/// ```
/// for (name, found) in stillrate_lab::recursive::matched::responses()? {
///     assert!((found.noise_ratio - 0.158).abs() < 0.002, "{name}");
/// }
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub fn responses() -> Result<Vec<(&'static str, Response)>, ConfigError> {
    let fs = SAMPLE_RATE_HZ;
    let fir = |window: usize, length: f64, cutoff_hz: f64| {
        FirLowPassSettings { window, length, cutoff_hz, ..FirLowPassSettings::defaults(fs, noise()) }.build::<f64>()
    };
    let pt1 = |gain: f64| Pt1::<f64>::new(fs, gain / (1.0 - gain) * fs / core::f64::consts::TAU);
    let (mut first, mut second) = (feed(pt1(0.09505)?), feed(pt1(0.09505)?));
    let butterworth = BiquadSettings {
        cutoff_hz: 0.01127 * fs,
        quality: core::f64::consts::FRAC_1_SQRT_2,
        ..BiquadSettings::defaults(fs, noise())
    };
    Ok(vec![
        ("RLS = KF = EMA steady", response(feed(least_squares(1.0, 0.9512).build::<f64>()?))),
        ("boxcar 40", response(feed(fir(0, 40.0, 0.0)?))),
        ("Hann window 61", response(feed(fir(1, 61.0, 0.0)?))),
        ("Hamming 56", response(feed(fir(2, 56.0, 0.0)?))),
        ("Blackman 71", response(feed(fir(3, 71.0, 0.0)?))),
        ("firwin Hamming 81, .0159", response(feed(fir(2, 81.0, 0.0159 * fs)?))),
        ("PT2 (a = .09505 twice)", response(|value| second(first(value)))),
        ("Butterworth-2, .01127", response(feed(butterworth.build::<f64>()?))),
        ("order-2 RLS .980031", response(feed(least_squares(2.0, 0.980_031).build::<f64>()?))),
    ])
}
