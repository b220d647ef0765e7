//! `stillrate.h`: every struct in the order it is needed, every function of every method, sizes checked by the compiler.

use std::fmt::Write;

use stillrate::{Filter, Flags, GyroNoise, Outline, Plain, Real, Settings};

use super::{Held, identifier};

/// The bits of `flags` that a filter can set.
const FLAGS: [(&str, Flags, &str); 9] = [
    ("MISSING", Flags::MISSING, "not a number or infinite: the filter coasted"),
    ("NO_DATA_YET", Flags::NO_DATA_YET, "no usable sample yet: the output is a placeholder"),
    ("BAD_TIME", Flags::BAD_TIME, "time step zero, negative or not finite: no time passed"),
    ("RESTARTED", Flags::RESTARTED, "after so long a gap the filter started anew"),
    ("SATURATED", Flags::SATURATED, "at the sensor's rail"),
    ("OUTLIER", Flags::OUTLIER, "the outlier model took most of it"),
    ("DIVERGED", Flags::DIVERGED, "the filter lost its state and started anew"),
    ("OUT_OF_RANGE", Flags::OUT_OF_RANGE, "beyond any physical rate: treated as missing"),
    ("CHANGE", Flags::CHANGE, "a change detector fired"),
];

/// A struct on its way into the header.
struct Struct {
    name: String,
    about: String,
    members: Vec<Member>,
}

struct Member {
    name: &'static str,
    about: String,
    lengths: Vec<usize>,
    kind: Option<String>,
}

/// Collects the structs that a value consists of.
struct Collector<'a> {
    real: &'static str,
    suffix: &'static str,
    open: Vec<Struct>,
    written: &'a mut Vec<String>,
    text: &'a mut String,
    root: String,
}

/// `SingerImmKfState` as `singer_imm_kf_state`.
fn snake(name: &str) -> String {
    let mut out = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !out.is_empty() {
            out.push('_');
        }
        out.extend(letter.to_lowercase());
    }
    out
}

impl Collector<'_> {
    fn leaf(&mut self, kind: &str) {
        if let Some(member) = self.open.last_mut().and_then(|open| open.members.last_mut()) {
            member.kind.get_or_insert_with(|| kind.into());
        }
    }
}

/// First sentence of a description without the marks of Rust's documentation.
fn plain_text(about: &[&str]) -> String {
    let lines: Vec<&str> = about.iter().map(|line| line.trim()).take_while(|line| !line.is_empty()).collect();
    lines.join(" ").replace(['[', ']', '`'], "").replace("(super::", "(").replace("*/", "")
}

impl Outline for Collector<'_> {
    fn number(&mut self, _value: f64) {
        self.leaf(self.real);
    }
    fn count(&mut self, _value: u32) {
        self.leaf("uint32_t");
    }
    fn array(&mut self, length: usize) {
        if let Some(member) = self.open.last_mut().and_then(|open| open.members.last_mut())
            && member.kind.is_none()
        {
            member.lengths.push(length);
        }
    }
    fn end_array(&mut self) {}
    fn open(&mut self, name: &'static str, about: &[&'static str]) {
        let name = format!("stillrate_{}_{}", snake(name), self.suffix);
        self.open.push(Struct { name, about: plain_text(about), members: Vec::new() });
    }
    fn field(&mut self, name: &'static str, about: &[&'static str]) {
        if let Some(open) = self.open.last_mut() {
            open.members.push(Member { name, about: plain_text(about), lengths: Vec::new(), kind: None });
        }
    }
    fn close(&mut self) {
        let Some(done) = self.open.pop() else { return };
        if !self.written.contains(&done.name) {
            self.written.push(done.name.clone());
            let _ = writeln!(self.text, "\n/* {} */\ntypedef struct {} {{", done.about, done.name);
            for member in &done.members {
                let kind = member.kind.as_deref().unwrap_or("void");
                let _ = write!(self.text, "    {kind} {}", member.name);
                for length in &member.lengths {
                    let _ = write!(self.text, "[{length}]");
                }
                let _ = writeln!(self.text, "; /* {} */", member.about);
            }
            let _ = writeln!(self.text, "}} {};", done.name);
        }
        self.leaf(&done.name);
        self.root = done.name;
    }
}

/// Figures of a default configuration; the header depends on types alone.
fn example<S: Settings>() -> S {
    S::defaults(1000.0, GyroNoise::from_density_two_sided(0.01))
}

fn collect(
    value: &impl Plain,
    real: &'static str,
    suffix: &'static str,
    done: &mut Vec<String>,
    text: &mut String,
) -> String {
    let mut collector = Collector { real, suffix, open: Vec::new(), written: done, text, root: String::new() };
    value.outline(&mut collector);
    collector.root
}

fn method<S: Settings, T: Real + Plain>(suffix: &'static str, done: &mut Vec<String>, text: &mut String)
where
    S::Filter<T>: Plain,
    <S::Filter<T> as Filter<T>>::State: Plain,
{
    let real = if T::BYTES == 4 { "float" } else { "double" };
    let Ok(filter) = example::<S>().build::<T>() else { return };
    let _ = writeln!(text, "\n/* ---- {} in {suffix} ---- */", S::METHOD);
    let config = collect(&filter, real, suffix, done, text);
    let state = collect(&filter.start(), real, suffix, done, text);
    let name = format!("stillrate_{}_{suffix}", identifier(S::METHOD));
    let sizes = [
        ("config", size_of::<S::Filter<T>>(), align_of::<S::Filter<T>>()),
        ("state", size_of::<Held<<S::Filter<T> as Filter<T>>::State, T>>(), align_of::<T>()),
    ];
    let _ = write!(
        text,
        "
/* Checked configuration; made by `stillrate export-c`. */
typedef {config} {name}_config;
/* State: place it anywhere, start it before the first step. */
typedef struct {name}_state {{
    {state} filter; /* what the filter remembers */
    stillrate_estimate_{suffix} last; /* what the last step found */
}} {name}_state;

/* The state before the first sample. */
void {name}_start(const {name}_config *config, {name}_state *state);
/* Back to it. */
void {name}_reset(const {name}_config *config, {name}_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
{real} {name}_step(const {name}_config *config, {name}_state *state, {real} value, {real} dt_s);
/* What the last step found. */
void {name}_estimate(const {name}_state *state, stillrate_estimate_{suffix} *out);

"
    );
    for (what, size, align) in sizes {
        let _ = writeln!(text, "STILLRATE_LAYOUT({name}_{what}, {size}, {align});");
    }
}

/// The text of `stillrate.h`.
///
/// # Example
/// ```
/// let header = stillrate_lab::export::c_header();
/// assert!(header.contains("float stillrate_pt1_f32_step(const stillrate_pt1_f32_config *config,"));
/// ```
#[must_use]
pub fn c_header() -> String {
    let mut text = String::from(
        "/* stillrate: gyro denoising filters, the same bits as on the desk. Generated; do not edit.
 *
 * Everything is a plain struct: configurations are constants from `stillrate export-c`, states are placed by the caller. No
 * function allocates, fails or keeps anything to itself; different states may be used from different threads. A null pointer
 * does nothing and gives 0. MIT OR Apache-2.0. */
#ifndef STILLRATE_H
#define STILLRATE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern \"C\" {
#endif

/* What happened to a sample: bits of `flags`. */
",
    );
    for (name, flag, about) in FLAGS {
        let _ = writeln!(text, "#define STILLRATE_{name} {}u /* {about} */", flag.0);
    }
    text.push_str(
        "
/* Size and alignment in bytes, checked where this file is compiled. */
#define STILLRATE_LAYOUT(type, size, align)                                                                            \\
    typedef char type##_has_its_size[sizeof(type) == (size) ? 1 : -1];                                                 \\
    typedef struct { char first; type second; } type##_after_a_byte;                                                   \\
    typedef char type##_has_its_alignment[offsetof(type##_after_a_byte, second) == (align) ? 1 : -1]
",
    );
    let mut done = Vec::new();
    for (suffix, real) in [("f32", "float"), ("f64", "double")] {
        let _ = write!(
            text,
            "
/* What a step knows afterwards, in the unit of the input. */
typedef struct stillrate_estimate_{suffix} {{
    {real} rate; /* filtered rate, always finite */
    {real} acceleration; /* its time derivative, per second; 0 for filters that do not estimate it */
    {real} variance; /* variance of the rate as the filter believes it; 0 for filters that have no opinion */
    uint32_t flags; /* what happened to the sample */
}} stillrate_estimate_{suffix};
"
        );
    }
    macro_rules! all {
        ($($settings:ident),* $(,)?) => { $(
            method::<stillrate::filters::$settings, f32>("f32", &mut done, &mut text);
            method::<stillrate::filters::$settings, f64>("f64", &mut done, &mut text);
        )* };
    }
    stillrate::methods!(all);
    text.push_str("\n#ifdef __cplusplus\n}\n#endif\n#endif\n");
    text
}

/// The list of functions that the static library is made of (`crates/stillrate-c/abi/src/functions.rs`).
///
/// # Example
/// ```
/// use stillrate_lab::{export::c_functions, runner::method_names};
/// // A comment, then every method in both precisions.
/// assert_eq!(c_functions().lines().count(), 1 + 2 * method_names().len());
/// ```
#[must_use]
pub fn c_functions() -> String {
    let mut text = String::from("// Every method in both precisions. Generated with the header; do not edit.\n");
    macro_rules! all {
        ($($settings:ident),* $(,)?) => { $(
            for suffix in ["f32", "f64"] {
                let name = format!("stillrate_{}_{suffix}", identifier(<stillrate::filters::$settings as Settings>::METHOD));
                let _ = writeln!(
                    text,
                    "functions! {{ {} {suffix}; {name}_start {name}_step {name}_estimate {name}_reset }}",
                    stringify!($settings),
                );
            }
        )* };
    }
    stillrate::methods!(all);
    text
}
