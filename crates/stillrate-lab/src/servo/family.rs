//! Filters as families: a chain of methods with some settings left open for the tuner.

use stillrate::GyroNoise;

use super::chain::{Link, by_name};
use super::loop_filter::LoopFilter;
use super::search::Range;
use crate::settings_map::{SettingsError, SettingsMap, Value};

/// One open setting.
///
/// # Example
/// ```
/// use stillrate_lab::servo::{family::{Family, Tunable}, search::Range};
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let range = Range { low: 30.0, high: 10_000.0, logarithmic: true };
/// let second = Tunable { link: 0, field: "accel_max_dps2.1".into(), range }; // one item of a list
/// let settings = SettingsMap::from([("accel_max_dps2".into(), Value::List(vec![1.5, 300.0]))]);
/// let family = Family { name: "mine".into(), chain: vec![("singer-imm-kf".into(), settings)], open: vec![second], linear: false };
/// assert_eq!(family.filled(&[500.0])[0].1["accel_max_dps2"], Value::List(vec![1.5, 500.0]));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Tunable {
    /// Which link of the chain.
    pub link: usize,
    /// Name of its setting; `name.i` is item `i` of a list.
    pub field: String,
    /// Where to search.
    pub range: Range,
}

/// A chain of methods (first to last), fixed settings and open ones. An empty chain is no filter.
///
/// # Example
/// ```
/// use stillrate::GyroNoise;
/// use stillrate_lab::servo::family::{Family, standard};
/// let noise = GyroNoise::from_density_two_sided(0.0152);
/// let pt1 = standard(50.0, noise).into_iter().find(|f| f.name == "pt1").unwrap();
/// let mut filter = pt1.build(&[5.3]).unwrap();
/// assert_eq!(filter.step(1.0), 1.0);
/// // What is built can be looked at: here by its discrete gain at 50 Hz, x / (1 + x) with x = 2 pi 5.3 / 50.
/// assert!((filter.step(2.0) - 1.3998).abs() < 1e-4);
/// assert_eq!(pt1.filled(&[5.3])[0].0, "pt1");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Name in tables.
    pub name: String,
    /// Methods with their fixed settings.
    pub chain: Vec<Link>,
    /// Open settings, in the order of the tuner's parameters.
    pub open: Vec<Tunable>,
    /// Whether it is linear and time-invariant.
    pub linear: bool,
}

impl Family {
    /// The filter with its open settings filled in.
    ///
    /// # Errors
    /// [`SettingsError`] of the first link that cannot be built.
    pub fn build(&self, parameters: &[f64]) -> Result<Box<dyn LoopFilter>, SettingsError> {
        by_name(&self.filled(parameters))
    }

    /// The chain with its open settings filled in.
    #[must_use]
    pub fn filled(&self, parameters: &[f64]) -> Vec<Link> {
        let mut chain = self.chain.clone();
        for (open, value) in self.open.iter().zip(parameters) {
            if let Some((_, settings)) = chain.get_mut(open.link) {
                set(settings, &open.field, *value);
            }
        }
        chain
    }
}

/// Sets a number, or item `i` of a list that is there for the field `name.i`.
fn set(settings: &mut SettingsMap, field: &str, value: f64) {
    if let Some((name, index)) = field.rsplit_once('.')
        && let Ok(index) = index.parse::<usize>()
        && let Some(Value::List(list)) = settings.get_mut(name)
        && let Some(item) = list.get_mut(index)
    {
        *item = value;
    } else {
        settings.insert(field.into(), Value::Number(value));
    }
}

/// Settings every method takes.
fn common(sample_rate_hz: f64, noise: GyroNoise) -> SettingsMap {
    SettingsMap::from([
        ("sample_rate_hz".into(), Value::Number(sample_rate_hz)),
        ("noise.density_dps_sqrt_hz".into(), Value::Number(noise.density_dps_sqrt_hz)),
        ("noise.rate_random_walk_dps_sqrt_s".into(), Value::Number(noise.rate_random_walk_dps_sqrt_s)),
    ])
}

fn logarithmic(low: f64, high: f64) -> Range {
    Range { low, high, logarithmic: true }
}

fn open(link: usize, field: &str, range: Range) -> Tunable {
    Tunable { link, field: field.into(), range }
}

/// The families that the study compares, of those methods the library has: none, PT1, second-order low-pass, the random-walk Kalman filter
/// fixed at the paper's ratio (a PT1 of 5.3 Hz), one-euro, Singer-IMM, and the default bank followed by a PT1. `sample_rate_hz` is the control
/// rate, `noise` what the filters are told of the gyro.
///
/// # Example
/// ```
/// use stillrate::GyroNoise;
/// use stillrate_lab::servo::family::standard;
/// let families = standard(50.0, GyroNoise::from_density_two_sided(0.0152));
/// assert!(families[0].chain.is_empty()); // the loop without a filter is what the others are compared with
/// // No cut-off is tried that a discrete low-pass cannot have.
/// assert!(families.iter().flat_map(|f| &f.open).filter(|open| open.field == "cutoff_hz").all(|open| open.range.high < 25.0));
/// ```
#[must_use]
pub fn standard(sample_rate_hz: f64, noise: GyroNoise) -> Vec<Family> {
    let link = |method: &str, fixed: &[(&str, f64)]| {
        let mut settings = common(sample_rate_hz, noise);
        settings.extend(fixed.iter().map(|(name, value)| ((*name).to_string(), Value::Number(*value))));
        (method.to_string(), settings)
    };
    // A discrete low-pass cannot cut above half the rate.
    let cutoff = logarithmic(0.2, 0.45 * sample_rate_hz);
    let family = |name: &str, linear: bool, chain: Vec<Link>, open: Vec<Tunable>| Family {
        name: name.into(),
        chain,
        open,
        linear,
    };
    // Transition probabilities of the specification's closed-loop study; the accelerations are tuned.
    let mut singer = link("singer-imm-kf", &[]);
    singer.1.insert("transition".into(), Value::List(vec![0.99, 0.01, 0.05, 0.95]));
    singer.1.insert("accel_max_dps2".into(), Value::List(vec![1.5, 300.0]));
    let known = crate::runner::method_names();
    vec![
        family("none", true, vec![], vec![]),
        family("pt1", true, vec![link("pt1", &[])], vec![open(0, "cutoff_hz", cutoff)]),
        family("biquad", true, vec![link("biquad", &[])], vec![open(0, "cutoff_hz", cutoff)]),
        family("kalman-5.3hz", true, vec![link("pt1", &[("cutoff_hz", 5.3)])], vec![]),
        family(
            "one-euro",
            false,
            vec![link("one-euro", &[])],
            vec![open(0, "minimum_cutoff_hz", logarithmic(0.005, 10.0)), open(0, "beta", logarithmic(1e-3, 10.0))],
        ),
        family(
            "singer-imm-kf",
            false,
            vec![singer],
            vec![
                open(0, "accel_max_dps2.0", logarithmic(0.1, 100.0)),
                open(0, "accel_max_dps2.1", logarithmic(30.0, 10_000.0)),
            ],
        ),
        family(
            "ms-imm-ikf+pt1",
            false,
            vec![link("ms-imm-ikf", &[]), link("pt1", &[])],
            vec![open(1, "cutoff_hz", cutoff)],
        ),
    ]
    .into_iter()
    .filter(|f| f.chain.iter().all(|(method, _)| known.contains(&method.as_str())))
    .collect()
}
