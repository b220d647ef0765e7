//! A checked configuration as source code: every coefficient computed, every literal exact, and a self-test of 64 samples.

use std::fmt::Write;

use stillrate::{Filter, Outline, Plain, Real, Sample, Settings};

use super::identifier;
use crate::runner::{Precision, unknown_method};
use crate::settings_map::{SettingsError, SettingsMap, from_map};

/// Samples of the self-test.
const SAMPLES: usize = 64;

/// A configuration as source files.
///
/// # Example
/// ```
/// use stillrate_lab::export::{Exported, export};
/// use stillrate_lab::runner::Precision;
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(8.0))]);
/// let Exported { config_h, selftest_h, config_rs } = export("pt1", &settings, Precision::Single)?;
/// assert!(config_h.contains(".period_s = 0.125f,")); // for C
/// assert!(config_rs.contains("period_s: 0.125,")); // for Rust
/// assert!(selftest_h.contains("STILLRATE_SELFTEST[64]"));
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// `stillrate_config.h`
    pub config_h: String,
    /// `stillrate_selftest.h`
    pub selftest_h: String,
    /// `stillrate_config.rs`
    pub config_rs: String,
}

/// Exports a configuration by the name of its method.
///
/// # Errors
/// [`SettingsError`] as from [`crate::runner::build`].
///
/// # Example
/// ```
/// use stillrate_lab::export::export;
/// use stillrate_lab::runner::Precision;
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
/// let files = export("pt1", &settings, Precision::Double)?;
/// assert!(files.config_h.contains("static const stillrate_pt1_f64_config STILLRATE_CONFIG"));
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
pub fn export(method: &str, settings: &SettingsMap, precision: Precision) -> Result<Exported, SettingsError> {
    macro_rules! by_name {
        ($($name:ident),* $(,)?) => {
            match method {
                $(<stillrate::filters::$name as Settings>::METHOD => {
                    let settings: stillrate::filters::$name = from_map(settings)?;
                    match precision {
                        Precision::Single => written::<_, f32>(&settings),
                        Precision::Double => written::<_, f64>(&settings),
                    }
                })*
                other => Err(unknown_method(other)),
            }
        };
    }
    stillrate::methods!(by_name)
}

fn written<S: Settings, T: Real + Plain>(settings: &S) -> Result<Exported, SettingsError>
where
    S::Filter<T>: Plain,
{
    let filter = settings.build::<T>()?;
    let suffix = if T::BYTES == 4 { "f32" } else { "f64" };
    let name = format!("stillrate_{}_{suffix}", identifier(S::METHOD));
    let mut c = Source { language: Language::C, single: T::BYTES == 4, text: String::new(), depth: 0 };
    filter.outline(&mut c);
    let mut rust = Source { language: Language::Rust, ..c.clone() };
    (rust.text, rust.depth) = (String::new(), 0);
    filter.outline(&mut rust);
    let version = env!("CARGO_PKG_VERSION");
    // As many digits as either number type has for sure.
    let sample_rate_hz = (1.0 / filter.period().widen()) as f32;
    let about = format!("{} at {sample_rate_hz} Hz in {suffix}, exported by stillrate {version}.", S::METHOD);
    let config_h = format!(
        "/* {about} Generated; do not edit. */
#ifndef STILLRATE_CONFIG_H
#define STILLRATE_CONFIG_H

#include \"stillrate.h\"

static const {name}_config STILLRATE_CONFIG = {};

#endif
",
        c.text
    );
    let filter_path = rust.text.split_once(" {").map_or("", |(path, _)| path);
    let config_rs = format!(
        "// {about} Generated; do not edit.
/// Checked configuration.
pub const STILLRATE_CONFIG: {filter_path}<{suffix}> = {};
",
        rust.text
    );
    Ok(Exported { config_h, selftest_h: selftest(&filter, &name, &about), config_rs })
}

#[derive(Clone, Copy, PartialEq)]
enum Language {
    C,
    Rust,
}

/// Writes a value down as an initialiser.
#[derive(Clone)]
struct Source {
    language: Language,
    single: bool,
    text: String,
    depth: usize,
}

/// A literal that gives back exactly this number.
fn literal(value: f64, single: bool, language: Language) -> String {
    if !value.is_finite() {
        // Settings that may be infinite are stored as the largest number; this is for missing samples.
        return "NAN".into();
    }
    let digits = if single { format!("{:?}", value as f32) } else { format!("{value:?}") };
    if single && language == Language::C { format!("{digits}f") } else { digits }
}

/// Where the structs of a configuration are found.
fn path(name: &str) -> String {
    match name {
        "SingerCoefficients" => format!("stillrate::models::{name}"),
        "FrequencyMemory" => format!("stillrate::adaptive::manoeuvre_frequency::{name}"),
        _ => format!("stillrate::filters::{name}"),
    }
}

impl Source {
    fn line(&mut self) {
        self.text.push('\n');
        self.text.extend(std::iter::repeat_n("    ", self.depth));
    }
}

impl Outline for Source {
    fn number(&mut self, value: f64) {
        self.text += &literal(value, self.single, self.language);
        self.text.push_str(", ");
    }
    fn count(&mut self, value: u32) {
        let unsigned = if self.language == Language::C { "u" } else { "" };
        let _ = write!(self.text, "{value}{unsigned}, ");
    }
    fn array(&mut self, _length: usize) {
        self.text.push(if self.language == Language::C { '{' } else { '[' });
    }
    fn end_array(&mut self) {
        self.trim();
        self.text.push_str(if self.language == Language::C { "}, " } else { "], " });
    }
    fn open(&mut self, name: &'static str, _about: &[&'static str]) {
        if self.language == Language::Rust {
            self.text += &path(name);
            self.text.push(' ');
        }
        self.text.push('{');
        self.depth += 1;
    }
    fn field(&mut self, name: &'static str, _about: &[&'static str]) {
        self.trim_space();
        self.line();
        let _ = match self.language {
            Language::C => write!(self.text, ".{name} = "),
            Language::Rust => write!(self.text, "{name}: "),
        };
    }
    fn close(&mut self) {
        self.trim_space();
        self.depth -= 1;
        self.line();
        self.text.push('}');
        if self.depth > 0 {
            self.text.push_str(", ");
        }
    }
}

impl Source {
    fn trim_space(&mut self) {
        self.text.truncate(self.text.trim_end_matches(' ').len());
    }
    fn trim(&mut self) {
        self.text.truncate(self.text.trim_end_matches([' ', ',']).len());
    }
}

/// Motion, noise, missing samples, an irregular step and a repeated time stamp.
fn test_input(k: usize, period: f64) -> (f64, f64) {
    let mut bits = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    // Multiples of 2^-10: the same number in every precision.
    let noise = ((bits >> 40) % 1024) as f64 / 1024.0 - 0.5;
    let ramp = if k < 24 { 0.0 } else { (k - 24) as f64 * 0.75 };
    let value = if k == 9 || k == 40 { f64::NAN } else { ramp + noise };
    let dt = match k {
        20 => 1.5 * period,
        33 => 0.0,
        _ => period,
    };
    (value, dt)
}

fn selftest<T: Real, F: Filter<T>>(filter: &F, name: &str, about: &str) -> String {
    let real = if T::BYTES == 4 { "float" } else { "double" };
    let mut state = filter.start();
    let mut rows = String::new();
    for k in 0..SAMPLES {
        let (value, dt) = test_input(k, filter.period().widen());
        let sample = Sample { value: T::of(value), dt: T::of(dt) };
        let estimate = filter.step(&mut state, sample);
        let cells = [sample.value, sample.dt, estimate.rate, estimate.variance]
            .map(|number| literal(number.widen(), T::BYTES == 4, Language::C));
        let _ = writeln!(rows, "    {{{}, {}u}},", cells.join(", "), estimate.flags.0);
    }
    format!(
        "/* Self-test of {about} Generated; do not edit. */
#ifndef STILLRATE_SELFTEST_H
#define STILLRATE_SELFTEST_H

#include <math.h>
#include <string.h>

#include \"stillrate_config.h\"

/* One sample of the self-test and what the filter must make of it, bit for bit. */
typedef struct stillrate_selftest_sample {{
    {real} value;
    {real} dt_s;
    {real} rate;
    {real} variance;
    uint32_t flags;
}} stillrate_selftest_sample;

static const stillrate_selftest_sample STILLRATE_SELFTEST[{SAMPLES}] = {{
{rows}}};

/* 0 where every bit is right, else 1 + the index of the first sample that is not. Overwrites the state. */
static inline int stillrate_selftest({name}_state *state) {{
    int k;
    {name}_start(&STILLRATE_CONFIG, state);
    for (k = 0; k < {SAMPLES}; ++k) {{
        const stillrate_selftest_sample *sample = &STILLRATE_SELFTEST[k];
        const {real} rate = {name}_step(&STILLRATE_CONFIG, state, sample->value, sample->dt_s);
        if (memcmp(&rate, &sample->rate, sizeof rate) != 0
            || memcmp(&state->last.variance, &sample->variance, sizeof rate) != 0
            || state->last.flags != sample->flags) {{
            return k + 1;
        }}
    }}
    {name}_reset(&STILLRATE_CONFIG, state);
    return 0;
}}

#endif
"
    )
}
