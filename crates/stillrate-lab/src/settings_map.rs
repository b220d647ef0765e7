//! Settings by name: what dictionaries, TOML files and saved states hold, before a method makes sense of it.

use std::collections::BTreeMap;
use std::fmt;

use stillrate::settings::Visit;
use stillrate::{ConfigError, GyroNoise, Real, Settings};

/// One value of a settings file.
///
/// # Example
/// ```
/// use stillrate::filters::MsImmIkfSettings;
/// use stillrate_lab::settings_map::{SettingsMap, Value, from_map};
/// let map = SettingsMap::from([
///     ("sample_rate_hz".to_string(), Value::Number(1000.0)),
///     ("oscillators".to_string(), Value::List(vec![1.0, 3.0])),
/// ]);
/// assert_eq!(from_map::<MsImmIkfSettings>(&map).unwrap().oscillator_count, 2);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A list of numbers.
    List(Vec<f64>),
    /// A word.
    Word(String),
}

/// Settings by name, in alphabetical order.
pub type SettingsMap = BTreeMap<String, Value>;

/// Why settings cannot be used; shown, it is one sentence.
///
/// # Example
/// ```
/// use stillrate_lab::runner::{Precision, build};
/// use stillrate_lab::settings_map::{SettingsError, SettingsMap, Value};
/// let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(-50.0))]);
/// let error = build("pt1", &settings, 1, Precision::Double).err().unwrap();
/// assert!(matches!(&error, SettingsError::Value(value) if value.field == "sample_rate_hz"));
/// assert!(error.to_string().starts_with("sample_rate_hz = -50"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum SettingsError {
    /// A value is out of range.
    Value(ConfigError),
    /// A field is missing, unknown or of the wrong kind, or the method is unknown; the text says which.
    Text(String),
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value(error) => error.fmt(f),
            Self::Text(text) => f.write_str(text),
        }
    }
}

impl std::error::Error for SettingsError {}

impl From<ConfigError> for SettingsError {
    fn from(error: ConfigError) -> Self {
        Self::Value(error)
    }
}

/// Builds the settings of one method: the defaults for its sample rate and noise, changed by what `map` names.
///
/// # Errors
/// [`SettingsError`] if `sample_rate_hz` is missing, a name is unknown or a value has the wrong kind.
///
/// # Example
/// ```
/// use stillrate::filters::Pt1Settings;
/// use stillrate_lab::settings_map::{SettingsMap, Value, from_map};
/// let mut map = SettingsMap::new();
/// map.insert("sample_rate_hz".into(), Value::Number(100.0));
/// map.insert("cutof_hz".into(), Value::Number(8.0));
/// let error = from_map::<Pt1Settings>(&map).unwrap_err();
/// assert_eq!(error.to_string(), "pt1 has no setting 'cutof_hz': did you mean 'cutoff_hz'?");
/// ```
pub fn from_map<S: Settings>(map: &SettingsMap) -> Result<S, SettingsError> {
    let number = |name: &str| match map.get(name) {
        Some(Value::Number(value)) => Some(*value),
        _ => None,
    };
    let Some(sample_rate_hz) = number("sample_rate_hz") else {
        return Err(SettingsError::Text("sample_rate_hz is missing (a number in Hz)".into()));
    };
    let mut noise = GyroNoise::from_density_two_sided(number("noise.density_dps_sqrt_hz").unwrap_or(DEFAULT_DENSITY));
    if let Some(walk) = number("noise.rate_random_walk_dps_sqrt_s") {
        noise = noise.with_rate_random_walk(walk);
    }
    // The defaults of some methods follow from rate and noise: these must make sense first.
    let rates = stillrate::ranges::range_of(S::METHOD, "sample_rate_hz").unwrap_or(&stillrate::ranges::SAMPLE_RATE);
    rates.check("sample_rate_hz", sample_rate_hz)?;
    let mut settings = S::defaults(sample_rate_hz, noise.checked()?);
    let mut reader = Reader { map, known: Vec::new(), error: None };
    settings.visit(&mut reader);
    if let Some(error) = reader.error {
        return Err(SettingsError::Text(error));
    }
    for name in map.keys() {
        let common = name == "method" || name.starts_with("noise.");
        if !common && !reader.known.contains(&name.as_str()) {
            let hint = hint(name, &reader.known);
            return Err(SettingsError::Text(format!("{} has no setting '{name}'{hint}", S::METHOD)));
        }
    }
    if let (Some(tau_s), Some(factor)) = (number("tau_s"), number("forgetting_factor")) {
        agree(tau_s, factor, sample_rate_hz)?;
    }
    Ok(settings)
}

/// Refuses a memory that is given twice and differently, also where one of the two happens to be the default: settings
/// see values only and cannot tell a default from the same number asked for.
fn agree(tau_s: f64, forgetting_factor: f64, sample_rate_hz: f64) -> Result<(), ConfigError> {
    let of_tau = (-1.0 / (tau_s * sample_rate_hz)).exponential();
    // What remains after rounding either to nine digits; a value that makes no sense is refused when the filter is built.
    if tau_s > 0.0 && (of_tau - forgetting_factor).abs() > 1e-9 {
        let range = "exp(-1 / (tau_s * sample_rate_hz)): give one of the two, or both in agreement";
        return Err(ConfigError::new("forgetting_factor", forgetting_factor, "", range));
    }
    Ok(())
}

/// Density in deg/s/sqrt(Hz) of a common MEMS gyro, where a method that hardly needs it is built without.
const DEFAULT_DENSITY: f64 = 0.01;

/// Writes every setting of a method down by name; [`from_map`] reads it back unchanged.
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::Pt1Settings};
/// use stillrate_lab::settings_map::{Value, from_map, to_map};
/// let settings = Pt1Settings::defaults(1000.0, GyroNoise::from_density_two_sided(0.01));
/// let map = to_map(&settings);
/// assert_eq!(map["cutoff_hz"], Value::Number(20.0));
/// assert_eq!(from_map::<Pt1Settings>(&map).unwrap(), settings);
/// ```
#[must_use]
pub fn to_map<S: Settings>(settings: &S) -> SettingsMap {
    let mut writer = Writer(SettingsMap::new());
    settings.clone().visit(&mut writer);
    writer.0
}

/// The known name closest to a misspelt one, if any is close.
fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    known
        .iter()
        .map(|candidate| (edit_distance(name, candidate), *candidate))
        .filter(|(distance, candidate)| *distance <= 2 + candidate.len() / 4)
        .min()
        .map(|(_, candidate)| candidate)
}

/// The nearest name as the end of an error message, if there is one.
pub(crate) fn hint(name: &str, known: &[&str]) -> String {
    nearest(name, known).map_or(String::new(), |near| format!(": did you mean '{near}'?"))
}

fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

struct Reader<'a> {
    map: &'a SettingsMap,
    known: Vec<&'static str>,
    error: Option<String>,
}

impl Reader<'_> {
    fn refuse(&mut self, text: String) {
        self.error.get_or_insert(text);
    }
}

impl Visit for Reader<'_> {
    fn number(&mut self, name: &'static str, value: &mut f64) {
        self.known.push(name);
        match self.map.get(name) {
            None => {}
            Some(Value::Number(given)) => *value = *given,
            Some(other) => self.refuse(format!("{name} must be a number, not {other:?}")),
        }
    }

    fn list(&mut self, name: &'static str, values: &mut [f64], count: &mut usize) {
        self.known.push(name);
        match self.map.get(name) {
            None => {}
            Some(Value::List(given)) if given.len() <= values.len() => {
                values[..given.len()].copy_from_slice(given);
                *count = given.len();
            }
            Some(Value::List(given)) => {
                self.refuse(format!("{name} has {} entries (must be at most {})", given.len(), values.len()));
            }
            Some(Value::Number(given)) if !values.is_empty() => {
                values[0] = *given;
                *count = 1;
            }
            Some(other) => self.refuse(format!("{name} must be a list of numbers, not {other:?}")),
        }
    }

    fn choice(&mut self, name: &'static str, words: &'static [&'static str], chosen: &mut usize) {
        self.known.push(name);
        match self.map.get(name) {
            None => {}
            Some(Value::Word(given)) => {
                if let Some(index) = words.iter().position(|word| word == given) {
                    *chosen = index;
                } else {
                    let hint = hint(given, words);
                    self.refuse(format!("{name} = '{given}' (must be one of {}){hint}", words.join(", ")));
                }
            }
            Some(other) => self.refuse(format!("{name} must be one of {}, not {other:?}", words.join(", "))),
        }
    }
}

struct Writer(SettingsMap);

impl Visit for Writer {
    fn number(&mut self, name: &'static str, value: &mut f64) {
        self.0.insert(name.into(), Value::Number(*value));
    }
    fn list(&mut self, name: &'static str, values: &mut [f64], count: &mut usize) {
        self.0.insert(name.into(), Value::List(values[..(*count).min(values.len())].to_vec()));
    }
    fn choice(&mut self, name: &'static str, words: &'static [&'static str], chosen: &mut usize) {
        self.0.insert(name.into(), Value::Word(words.get(*chosen).copied().unwrap_or_default().into()));
    }
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn a_misspelt_name_is_told_from_another_word() {
        assert_eq!(nearest("cutof_hz", &["cutoff_hz", "quality"]), Some("cutoff_hz"));
        assert_eq!(nearest("cheese", &["cutoff_hz", "quality"]), None);
    }
}
