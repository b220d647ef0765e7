//! Settings of the published MS-IMM-IKF: its modes and every choice that the paper leaves open.

use super::ms_imm_ikf_paper::{MsImmIkfPaper, PaperModel};
use super::singer_pair::{SingerPair, probability_pair, transition_matrix, visit_pair};
use crate::error::ConfigError;
use crate::noise::{GyroNoise, range};
use crate::ranges;
use crate::real::Real;
use crate::settings::{Settings, Visit, visit_noise};

/// Settings of [`MsImmIkfPaper`](super::MsImmIkfPaper). `mode` sets the defaults of the rest:
///
/// - `paper`: what comes nearest to the published static figures; alpha stays, its comparison with alpha3 classifies rest.
/// - `printed`: the equations to the letter. It diverges by itself, also at rest, and says so in its flags.
/// - `exact-jacobian`: alpha is estimated with the exact derivative; no fading.
/// - `log-alpha`: the same for the logarithm of alpha.
///
/// # Example
/// ```
/// use stillrate::filters::{FADING_GATES, MODES, MsImmIkfPaperSettings};
/// use stillrate::{GyroNoise, Settings};
/// let settings = MsImmIkfPaperSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015));
/// assert_eq!((MODES[settings.mode], FADING_GATES[settings.fading_gate]), ("paper", "second-model-while-moving"));
/// let unsound = MsImmIkfPaperSettings { jacobian: 1, ..settings }; // exact, and alpha still private
/// assert_eq!(unsound.build::<f64>().unwrap_err().field, "jacobian");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MsImmIkfPaperSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// The gyro's noise.
    pub noise: GyroNoise,
    /// Index into [`MODES`].
    pub mode: usize,
    /// The two models at the start.
    pub pair: SingerPair,
    /// Variances of the third state before the first sample, 1/s^2; default 1e-8, 1e-6 (log-alpha: pure numbers; 1, 1).
    pub initial_alpha_variance: [f64; 2],
    /// Densities of the third state's random walk, 1/s^2 per s (log-alpha: per s); default 0, 0 in paper mode.
    pub alpha_noise_density: [f64; 2],
    /// Whether alpha is mixed like any state: index into [`ALPHA_MIXING`].
    pub alpha_mixing: usize,
    /// Index into [`JACOBIANS`].
    pub jacobian: usize,
    /// Index into [`FADINGS`].
    pub fading: usize,
    /// Index into [`FADING_SOURCES`].
    pub fading_source: usize,
    /// Factor of the square in Delta; default sqrt(1/2) for the measurement, 1 for the innovation.
    pub fading_scale: f64,
    /// What lambda multiplies: index into [`FADING_SCOPES`].
    pub fading_scope: usize,
    /// When lambda acts: index into [`FADING_GATES`].
    pub fading_gate: usize,
    /// Forgetting factor of the windowed innovation square; default .95.
    pub fading_memory: f64,
    /// Softening factor of R in the windowed form; default 1.5.
    pub fading_softening: f64,
    /// Probability of staying while rest is declared; 0 keeps `pair.transition`; default .9985 in paper mode.
    pub static_stay_probability: f64,
    /// alpha3: rest is declared while sum mu alpha <= alpha3, 1/s; default .0055, the mean of both alphas' defaults.
    pub static_alpha_per_s: f64,
}

/// Words for `mode`.
pub const MODES: &[&str] = &["paper", "printed", "exact-jacobian", "log-alpha"];
/// Words for `alpha_mixing`.
pub const ALPHA_MIXING: &[&str] = &["private", "shared"];
/// Words for `jacobian`.
pub const JACOBIANS: &[&str] = &["printed", "exact"];
/// Words for `fading`.
pub const FADINGS: &[&str] = &["none", "absolute", "signed"];
/// Words for `fading_source`.
pub const FADING_SOURCES: &[&str] = &["measurement", "innovation", "windowed"];
/// Words for `fading_scope`.
pub const FADING_SCOPES: &[&str] = &["rate-acceleration", "all"];
/// Words for `fading_gate`.
pub const FADING_GATES: &[&str] = &["always", "while-moving", "second-model-while-moving"];

impl MsImmIkfPaperSettings {
    /// The choices that make up a mode.
    fn preset(&mut self) {
        let printed = self.mode == 1;
        let estimated = self.mode >= 2;
        self.alpha_mixing = usize::from(printed || estimated);
        self.jacobian = usize::from(estimated);
        self.fading = match self.mode {
            0 => 2,
            1 => 1,
            _ => 0,
        };
        self.fading_source = 0;
        self.fading_scale = core::f64::consts::FRAC_1_SQRT_2;
        self.fading_scope = usize::from(printed || estimated);
        self.fading_gate = if self.mode == 0 { 2 } else { 0 };
        self.static_stay_probability = if self.mode == 0 { 0.9985 } else { 0.0 };
        self.alpha_noise_density = match self.mode {
            0 => [0.0; 2],
            3 => [0.01; 2],
            _ => [1e-8, 1e-6],
        };
        self.initial_alpha_variance = if self.mode == 3 { [1.0; 2] } else { [1e-8, 1e-6] };
    }
}

impl Settings for MsImmIkfPaperSettings {
    const METHOD: &'static str = "ms-imm-ikf-paper";
    type Filter<T: Real> = MsImmIkfPaper<T>;

    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        let mut settings = Self {
            sample_rate_hz,
            noise,
            mode: 0,
            pair: SingerPair::defaults(noise.sample_variance(sample_rate_hz)),
            initial_alpha_variance: [1e-8, 1e-6],
            alpha_noise_density: [0.0; 2],
            alpha_mixing: 0,
            jacobian: 0,
            fading: 0,
            fading_source: 0,
            fading_scale: 1.0,
            fading_scope: 0,
            fading_gate: 0,
            fading_memory: 0.95,
            fading_softening: 1.5,
            static_stay_probability: 0.0,
            static_alpha_per_s: 0.0055,
        };
        settings.preset();
        settings
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visit_noise(visitor, &mut self.noise);
        let mode = self.mode;
        visitor.choice("mode", MODES, &mut self.mode);
        if self.mode != mode {
            self.preset();
        }
        self.pair.visit(visitor);
        visit_pair(visitor, "initial_alpha_variance", &mut self.initial_alpha_variance);
        visit_pair(visitor, "alpha_noise_density", &mut self.alpha_noise_density);
        visitor.choice("alpha_mixing", ALPHA_MIXING, &mut self.alpha_mixing);
        visitor.choice("jacobian", JACOBIANS, &mut self.jacobian);
        visitor.choice("fading", FADINGS, &mut self.fading);
        let source = self.fading_source;
        visitor.choice("fading_source", FADING_SOURCES, &mut self.fading_source);
        if self.fading_source != source {
            self.fading_scale = if self.fading_source == 0 { core::f64::consts::FRAC_1_SQRT_2 } else { 1.0 };
        }
        visitor.number("fading_scale", &mut self.fading_scale);
        visitor.choice("fading_scope", FADING_SCOPES, &mut self.fading_scope);
        visitor.choice("fading_gate", FADING_GATES, &mut self.fading_gate);
        visitor.number("fading_memory", &mut self.fading_memory);
        visitor.number("fading_softening", &mut self.fading_softening);
        visitor.number("static_stay_probability", &mut self.static_stay_probability);
        visitor.number("static_alpha_per_s", &mut self.static_alpha_per_s);
    }

    fn build<T: Real>(&self) -> Result<MsImmIkfPaper<T>, ConfigError> {
        ranges::check(self)?;
        let period = 1.0 / self.sample_rate_hz;
        if self.jacobian == 1 && self.alpha_mixing == 0 {
            // The private row keeps covariances with a rate that the mixing replaces: P can lose positive definiteness.
            let range = "exact only with alpha_mixing = shared (the covariance can lose definiteness otherwise)";
            return Err(ConfigError::new("jacobian", 1.0, "", range));
        }
        let stay = self.static_stay_probability;
        let pair = &self.pair;
        pair.check()?;
        let logarithmic = self.mode == 3;
        let mut model = [PaperModel::NONE; 2];
        for (i, model) in model.iter_mut().enumerate() {
            let (alpha, variance) = (pair.alpha_per_s[i], pair.measurement_variance[i]);
            let (rate, start) = (pair.initial_rate_variance[i], pair.initial_acceleration_variance[i]);
            let (third, walk) = (self.initial_alpha_variance[i], self.alpha_noise_density[i]);
            *model = PaperModel {
                parameter: T::of(if logarithmic { alpha.logarithm() } else { alpha }),
                acceleration_variance: T::of(pair.accel_max_dps2[i] * pair.accel_max_dps2[i] / 3.0),
                measurement_variance: T::of(variance),
                alpha_noise: T::of(walk),
                start_variance: [T::of(rate), T::of(start), T::of(third)],
            };
        }
        Ok(MsImmIkfPaper {
            period_s: T::of(period),
            model,
            transition: transition_matrix(&pair.transition)?,
            static_transition: if stay > 0.0 {
                transition_matrix(&[stay, 1.0 - stay, 1.0 - stay, stay])?
            } else {
                transition_matrix(&pair.transition)?
            },
            start_probability: probability_pair(&pair.initial_probability)?,
            static_alpha: T::of(self.static_alpha_per_s),
            fading_scale: T::of(self.fading_scale),
            fading_memory: T::of(self.fading_memory),
            fading_softening: T::of(self.fading_softening),
            limit: range(pair.largest_deviation()),
            shares_alpha: u32::from(self.alpha_mixing == 1),
            fades_alpha: u32::from(self.fading_scope == 1),
            exact_jacobian: u32::from(self.jacobian == 1),
            logarithmic: u32::from(logarithmic),
            form: self.fading as u32,
            source: self.fading_source as u32,
            gate: self.fading_gate as u32,
        })
    }
}
