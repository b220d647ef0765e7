//! Settings: what a user writes down, before it is checked and turned into a filter.
//!
//! Every method has one settings struct in `f64` with a documented default for all but the sample rate and the
//! noise. [`Settings::visit`] names each field once; dictionaries, TOML, saved states and error messages all follow from
//! that one list. [`methods!`](crate::methods!) lists every method of the library: adding one is one file and one line.

use crate::error::ConfigError;
use crate::filter::Filter;
use crate::noise::GyroNoise;
use crate::real::Real;

/// Receives the fields of a [`Settings`] value one by one, to read or to change them.
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::BiquadSettings, settings::Visit};
/// #[derive(Default)]
/// struct Names(Vec<&'static str>);
/// impl Visit for Names {
///     fn number(&mut self, name: &'static str, _: &mut f64) {
///         self.0.push(name);
///     }
///     fn list(&mut self, name: &'static str, _: &mut [f64], _: &mut usize) {
///         self.0.push(name);
///     }
///     fn choice(&mut self, name: &'static str, _: &'static [&'static str], _: &mut usize) {
///         self.0.push(name);
///     }
/// }
/// let mut names = Names::default();
/// BiquadSettings::defaults(1000.0, GyroNoise::from_density_two_sided(0.01)).visit(&mut names);
/// assert_eq!(names.0, ["sample_rate_hz", "cutoff_hz", "quality"]);
/// ```
pub trait Visit {
    /// A number.
    fn number(&mut self, name: &'static str, value: &mut f64);
    /// A list of at most `values.len()` numbers, of which the first `count` are in use.
    fn list(&mut self, name: &'static str, values: &mut [f64], count: &mut usize);
    /// One of several words; `chosen` is an index into `words`.
    fn choice(&mut self, name: &'static str, words: &'static [&'static str], chosen: &mut usize);
}

/// The settings of one method.
///
/// # Example
/// ```
/// use stillrate::{Filter, GyroNoise, Settings, filters::Pt1Settings, settings::Visit};
/// /// Changes a setting by its name.
/// struct Set(&'static str, f64);
/// impl Visit for Set {
///     fn number(&mut self, name: &'static str, value: &mut f64) {
///         *value = if name == self.0 { self.1 } else { *value };
///     }
///     fn list(&mut self, _: &'static str, _: &mut [f64], _: &mut usize) {}
///     fn choice(&mut self, _: &'static str, _: &'static [&'static str], _: &mut usize) {}
/// }
/// let mut settings = Pt1Settings::defaults(1000.0, GyroNoise::from_density_two_sided(0.01));
/// settings.visit(&mut Set("cutoff_hz", 50.0));
/// assert_eq!(settings.cutoff_hz, 50.0);
/// let filter = settings.build::<f32>()?;
/// assert_eq!(filter.period(), 0.001);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub trait Settings: Clone + core::fmt::Debug + Send + Sync + 'static {
    /// Name of the method, as in `method = "..."`.
    const METHOD: &'static str;
    /// The filter these settings describe.
    type Filter<T: Real>: Filter<T>;
    /// Sensible settings for a sample rate in Hz and a gyro's noise.
    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self;
    /// Hands every field to the visitor, in a fixed order.
    fn visit<V: Visit>(&mut self, visitor: &mut V);
    /// Checks everything and computes the coefficients.
    ///
    /// # Errors
    /// [`ConfigError`] that names the first setting that cannot be used.
    fn build<T: Real>(&self) -> Result<Self::Filter<T>, ConfigError>;
}

/// Hands the two figures of a [`GyroNoise`] to a visitor.
pub(crate) fn visit_noise<V: Visit>(visitor: &mut V, noise: &mut GyroNoise) {
    visitor.number("noise.density_dps_sqrt_hz", &mut noise.density_dps_sqrt_hz);
    visitor.number("noise.rate_random_walk_dps_sqrt_s", &mut noise.rate_random_walk_dps_sqrt_s);
}

/// Calls a macro with the settings types of all methods: `callback! { A, B, ... }`.
///
/// # Example
/// ```
/// macro_rules! names {
///     ($($settings:ident),* $(,)?) => { [$(<stillrate::filters::$settings as stillrate::Settings>::METHOD),*] };
/// }
/// assert!(stillrate::methods!(names).contains(&"pt1"));
/// ```
#[macro_export]
macro_rules! methods {
    ($callback:ident) => {
        $callback! {
            ArKfSettings,
            BiquadSettings,
            CusumForgettingSettings,
            FirLowPassSettings,
            LinearPredictionSettings,
            MsImmIkfPaperSettings,
            MsImmIkfSettings,
            OneEuroSettings,
            Pt1Settings,
            RandomWalkKfSettings,
            RecursiveLeastSquaresSettings,
            SageHusaKfSettings,
            SingerImmKfSettings,
            SingerKfSettings,
            VariableForgettingSettings,
        }
    };
}
