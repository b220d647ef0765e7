//! A fitted error model as a file: JSON that a person can read, with a version and a checksum, refused when anything does not fit.
//!
//! The checksum is that of the canonical text (sorted keys, shortest exact numbers), so reformatting a file does not
//! break it and changing a digit does.

use serde_json::{Map, Value, json};
use stillrate::correction::{ErrorCurve, HIDDEN, INPUTS, TERMS};

use crate::rate_table::fit::{Fit, STEEPEST_SLOPE, guard};
use crate::saved::crc32;

/// What the file says it is.
const FORMAT: &str = "stillrate rate-table error model";
/// The only version so far.
const VERSION: u64 = 1;
/// Largest file that is read, bytes; a full model has about 4000.
const LARGEST_FILE: usize = 65_536;
/// Unit of all rates.
const UNIT: &str = "deg/s";
/// Names of the inputs in the file.
const INPUT_NAMES: [&str; 2] = ["rate_dps", "temperature_c"];

/// A curve with the facts that a user of it must know.
///
/// # Example
/// ```
/// use stillrate::correction::ErrorCurve;
/// use stillrate_lab::rate_table::model::ErrorModel;
/// let model = ErrorModel {
///     curve: ErrorCurve::line(0.03, 0.002, -6.0, 6.0).unwrap(),
///     kind: "line".into(), held_out_dps: 0.004, uncorrected_dps: 0.03, rates: 6, sample_rate_hz: None, slope_limit: 0.1,
/// };
/// assert_eq!(ErrorModel::from_text(&model.to_text()).unwrap(), model);
/// assert!(ErrorModel::from_text(&model.to_text().replace("0.004", "0.003")).is_err());
/// assert!(!model.needs_temperature());
/// let (raw, left, outside) = model.score(&[1.032, 9.0], &[1.0, f64::NAN], None).unwrap();
/// assert!((raw - 0.032).abs() < 1e-12 && left < 1e-4 && outside == 0.0); // a sample without truth is left out
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorModel {
    /// The run-time curve; its range is what it was calibrated on.
    pub curve: ErrorCurve<f64>,
    /// Which candidate it is.
    pub kind: String,
    /// Root mean square error of its predictions at rates left out of the fit.
    pub held_out_dps: f64,
    /// Root mean square of the errors before correction, at the same points.
    pub uncorrected_dps: f64,
    /// Number of distinct rates behind it.
    pub rates: usize,
    /// Sample rate of the calibration log, if known.
    pub sample_rate_hz: Option<f64>,
    /// Steepest slope that was allowed when it was made.
    pub slope_limit: f64,
}

impl From<&Fit> for ErrorModel {
    fn from(fit: &Fit) -> Self {
        Self {
            curve: fit.curve,
            kind: fit.chosen.name(),
            held_out_dps: fit.held_out,
            uncorrected_dps: fit.uncorrected,
            rates: fit.rates,
            sample_rate_hz: None,
            slope_limit: STEEPEST_SLOPE,
        }
    }
}

impl ErrorModel {
    /// Whether temperature is an input.
    #[must_use]
    pub const fn needs_temperature(&self) -> bool {
        self.curve.inputs > 1
    }

    /// Root mean square of measured less true rate (deg/s) before and after correction, and the share of samples outside the calibrated
    /// range. Samples without a measured or true rate (NaN) are left out.
    ///
    /// # Errors
    /// A sentence if the lists do not fit, the model needs a temperature, or no sample is usable.
    pub fn score(
        &self,
        measured: &[f64],
        truth: &[f64],
        temperature: Option<&[f64]>,
    ) -> Result<(f64, f64, f64), String> {
        if self.needs_temperature() && temperature.is_none() {
            return Err("this model was calibrated with temperature: give temperature_c".into());
        }
        if truth.len() != measured.len() || temperature.is_some_and(|t| t.len() != measured.len()) {
            return Err(format!(
                "{} measured and {} true rates must be as many (as must temperatures)",
                measured.len(),
                truth.len()
            ));
        }
        let [mut raw, mut left, mut outside, mut count] = [0.0; 4];
        for (k, (y, w)) in measured.iter().zip(truth).enumerate().filter(|(_, (y, w))| y.is_finite() && w.is_finite()) {
            let corrected = self.curve.correct(*y, [temperature.map_or(0.0, |t| t[k]), 0.0]);
            raw += (y - w) * (y - w);
            left += (corrected.rate - w) * (corrected.rate - w);
            outside += if corrected.flags.has(stillrate::Flags::EDGE_HELD) { 1.0 } else { 0.0 };
            count += 1.0;
        }
        if count == 0.0 {
            return Err("no usable sample".into());
        }
        Ok((stillrate::Real::root(raw / count), stillrate::Real::root(left / count), outside / count))
    }

    /// The text of the file.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut map = self.content();
        let sum = checksum(&map);
        map.insert("checksum".into(), Value::from(sum));
        let mut text = serde_json::to_string_pretty(&Value::Object(map)).unwrap_or_default();
        text.push('\n');
        text
    }

    fn content(&self) -> Map<String, Value> {
        let curve = &self.curve;
        let (inputs, hidden) = (curve.inputs as usize, curve.hidden as usize);
        let value = json!({
            "format": FORMAT,
            "version": VERSION,
            "unit": UNIT,
            "kind": self.kind,
            "held_out_dps": self.held_out_dps,
            "uncorrected_dps": self.uncorrected_dps,
            "distinct_rates": self.rates,
            "sample_rate_hz": self.sample_rate_hz,
            "slope_limit": self.slope_limit,
            "inputs": INPUT_NAMES[..inputs.min(INPUT_NAMES.len())],
            "trained_low": curve.low[..inputs],
            "trained_high": curve.high[..inputs],
            "centre": curve.centre[..inputs],
            "scale": curve.scale[..inputs],
            "fixed_point_steps": curve.steps,
            "polynomial": curve.terms,
            "input_weights": curve.input_weights[..hidden].iter().map(|row| row[..inputs].to_vec()).collect::<Vec<_>>(),
            "hidden_bias": curve.hidden_bias[..hidden],
            "output_weights": curve.output_weights[..hidden],
            "output_offset": curve.output_offset,
            "output_scale": curve.output_scale,
        });
        match value {
            Value::Object(map) => map,
            _ => Map::new(),
        }
    }

    /// Reads a file's text.
    ///
    /// # Errors
    /// A sentence that says why the file is refused.
    pub fn from_text(text: &str) -> Result<Self, String> {
        if text.len() > LARGEST_FILE {
            return Err(format!("{} bytes (a model has at most {LARGEST_FILE})", text.len()));
        }
        let value: Value = serde_json::from_str(text).map_err(|error| format!("not a model file: {error}"))?;
        let Value::Object(mut map) = value else { return Err("not a model file: no object".into()) };
        if map.get("format").and_then(Value::as_str) != Some(FORMAT) {
            return Err(format!("not a model file: format is not {FORMAT:?}"));
        }
        match map.get("version").and_then(Value::as_u64) {
            Some(VERSION) => {}
            other => return Err(format!("version {} is unknown (this program reads {VERSION})", display(other))),
        }
        let given = map.remove("checksum").unwrap_or(Value::Null);
        let model = Self::from_content(&map)?;
        let canonical = model.content();
        if let Some(unknown) = map.keys().find(|key| !canonical.contains_key(*key)) {
            return Err(format!("unknown field {unknown:?}"));
        }
        let sum = checksum(&canonical);
        if given != sum.clone() {
            return Err(format!("checksum is {given} but the content has \"{sum}\": the file was changed or damaged"));
        }
        guard(&model.curve, model.slope_limit)?;
        Ok(model)
    }

    fn from_content(map: &Map<String, Value>) -> Result<Self, String> {
        if map.get("unit").and_then(Value::as_str) != Some(UNIT) {
            return Err(format!("unit must be {UNIT:?}"));
        }
        let names = array(map, "inputs")?;
        let inputs = names.len();
        if inputs == 0
            || inputs > INPUT_NAMES.len()
            || names.iter().zip(INPUT_NAMES).any(|(a, b)| a.as_str() != Some(b))
        {
            return Err(format!("inputs must be the first one or two of {INPUT_NAMES:?}"));
        }
        let hidden = array(map, "hidden_bias")?.len();
        let weights = array(map, "input_weights")?;
        if hidden > HIDDEN || weights.len() != hidden {
            return Err(format!(
                "{} rows of input_weights for {hidden} hidden units (at most {HIDDEN})",
                weights.len()
            ));
        }
        let mut input_weights = [[0.0; INPUTS]; HIDDEN];
        for (row, value) in input_weights.iter_mut().zip(weights) {
            *row = padded("input_weights", value, inputs, 0.0)?;
        }
        let terms: [f64; TERMS] = padded("polynomial", field(map, "polynomial")?, TERMS, 0.0)?;
        let curve = ErrorCurve {
            inputs: inputs as u32,
            hidden: hidden as u32,
            steps: whole(map, "fixed_point_steps")? as u32,
            cubic: u32::from(terms[4..].iter().any(|t| *t != 0.0)),
            low: padded("trained_low", field(map, "trained_low")?, inputs, 0.0)?,
            high: padded("trained_high", field(map, "trained_high")?, inputs, 0.0)?,
            centre: padded("centre", field(map, "centre")?, inputs, 0.0)?,
            scale: padded("scale", field(map, "scale")?, inputs, 1.0)?,
            terms,
            input_weights,
            hidden_bias: padded("hidden_bias", field(map, "hidden_bias")?, hidden, 0.0)?,
            output_weights: padded("output_weights", field(map, "output_weights")?, hidden, 0.0)?,
            output_offset: number(map, "output_offset")?,
            output_scale: number(map, "output_scale")?,
        };
        Ok(Self {
            curve: curve.checked().map_err(|error| error.to_string())?,
            kind: field(map, "kind")?.as_str().ok_or("kind must be a word")?.to_owned(),
            held_out_dps: number(map, "held_out_dps")?,
            uncorrected_dps: number(map, "uncorrected_dps")?,
            rates: whole(map, "distinct_rates")? as usize,
            sample_rate_hz: if field(map, "sample_rate_hz")?.is_null() {
                None
            } else {
                Some(number(map, "sample_rate_hz")?)
            },
            slope_limit: number(map, "slope_limit")?,
        })
    }
}

fn checksum(map: &Map<String, Value>) -> String {
    let text = serde_json::to_string(map).unwrap_or_default();
    format!("crc32:{:08x}", crc32(text.as_bytes()))
}

fn display(version: Option<u64>) -> String {
    version.map_or_else(|| "(none)".into(), |v| v.to_string())
}

fn field<'a>(map: &'a Map<String, Value>, name: &str) -> Result<&'a Value, String> {
    map.get(name).ok_or_else(|| format!("field {name:?} is missing"))
}

fn array<'a>(map: &'a Map<String, Value>, name: &str) -> Result<&'a Vec<Value>, String> {
    field(map, name)?.as_array().ok_or_else(|| format!("{name} must be a list"))
}

fn number(map: &Map<String, Value>, name: &str) -> Result<f64, String> {
    field(map, name)?.as_f64().filter(|v| v.is_finite()).ok_or_else(|| format!("{name} must be a finite number"))
}

fn whole(map: &Map<String, Value>, name: &str) -> Result<u64, String> {
    field(map, name)?.as_u64().filter(|v| *v < 1 << 31).ok_or_else(|| format!("{name} must be a whole number"))
}

/// A list of exactly `count` finite numbers, the rest filled up.
fn padded<const N: usize>(name: &str, value: &Value, count: usize, rest: f64) -> Result<[f64; N], String> {
    let items = value.as_array().filter(|items| items.len() == count && count <= N);
    let items = items.ok_or_else(|| format!("{name} must be a list of {count} numbers"))?;
    let mut out = [rest; N];
    for (slot, item) in out.iter_mut().zip(items) {
        *slot = item.as_f64().filter(|v| v.is_finite()).ok_or_else(|| format!("{name} must hold finite numbers"))?;
    }
    Ok(out)
}
