//! The header of one flight: which fields its frames have, how they are written and predicted, and the scales.

use super::bytes::{Cursor, Encoding};

/// More fields than any firmware logs; the header is not believed beyond.
const MAX_FIELDS: usize = 256;
const MAX_LINES: usize = 4096;

/// What a field is written relative to, by its number in the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Predictor {
    /// 0, 4, 8, 9 and 11: a number that the header gives.
    Fixed(i32),
    /// 1: the frame before.
    Previous,
    /// 2: the straight line through the two frames before.
    StraightLine,
    /// 3: the average of the two frames before.
    Average,
    /// 5: another field of the same frame, `motor[0]`.
    SameFrame(usize),
    /// 6: one up, more where the log leaves frames out by plan.
    Increment,
}

/// How a field is written in one kind of frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rule {
    pub(super) predictor: Predictor,
    pub(super) encoding: Encoding,
}

/// What a flight says of itself.
#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) firmware: String,
    pub(super) names: Vec<String>,
    pub(super) signed: Vec<bool>,
    /// How the fields stand in keyframes.
    pub(super) key: Vec<Rule>,
    /// How they stand in the frames between.
    pub(super) between: Vec<Rule>,
    /// Encodings of the frames that are passed over: slow state, GPS, GPS home.
    pub(super) slow: Vec<Encoding>,
    pub(super) gps: Vec<Encoding>,
    pub(super) home: Vec<Encoding>,
    /// Index of the time stamp.
    pub(super) time: usize,
    /// A keyframe stands at every multiple of this many loops.
    pub(super) key_interval: u32,
    /// Of so many loops (second) so many are logged (first).
    pub(super) share: (u32, u32),
    /// deg/s for a count of the gyro, and g for one of the accelerometer.
    pub(super) gyro_dps: f64,
    pub(super) accel_g: Option<f64>,
}

/// Lines of the header by name, as far as they matter.
struct Lines<'a>(Vec<(&'a str, &'a str)>);

impl<'a> Lines<'a> {
    fn get(&self, name: &str) -> Option<&'a str> {
        self.0.iter().rev().find(|(found, _)| *found == name).map(|&(_, value)| value)
    }

    fn number(&self, name: &str) -> Option<i64> {
        self.get(name)?.split(',').next()?.trim().parse().ok()
    }

    fn numbers(&self, name: &str) -> Result<Vec<i64>, String> {
        let text = self.get(name).ok_or_else(|| format!("its header has no line {name:?}"))?;
        let numbers: Result<Vec<i64>, _> = text.split(',').map(|word| word.trim().parse()).collect();
        match numbers {
            Ok(numbers) if numbers.len() <= MAX_FIELDS => Ok(numbers),
            _ => Err(format!("line {name:?} of its header is damaged")),
        }
    }

    fn encodings(&self, frame: char) -> Result<Vec<Encoding>, String> {
        let name = format!("Field {frame} encoding");
        let known: Option<Vec<_>> = self.numbers(&name)?.into_iter().map(Encoding::from_number).collect();
        known.ok_or_else(|| format!("line {name:?} of its header has an encoding that is not known"))
    }
}

impl Header {
    /// Reads the header at the cursor, which then stands at the first frame.
    pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<Self, String> {
        let mut lines = Lines(Vec::new());
        while cursor.rest().starts_with(b"H ") && lines.0.len() < MAX_LINES {
            let line = cursor.line().ok_or("the file ends within its header")?;
            let text = std::str::from_utf8(line).ok().and_then(|line| line.strip_prefix("H "));
            lines.0.extend(text.and_then(|text| text.split_once(':')));
        }
        if lines.get("Data version") != Some("2") {
            return Err("its data version is not 2".into());
        }
        let text = lines.get("Field I name").ok_or("its header names no fields")?;
        let names: Vec<String> = text.split(',').take(MAX_FIELDS + 1).map(|name| name.trim().to_owned()).collect();
        let signed: Vec<bool> = lines.numbers("Field I signed")?.into_iter().map(|sign| sign != 0).collect();
        let motor = names.iter().position(|name| name == "motor[0]");
        let key = rules(&lines, 'I', motor)?;
        let between = rules(&lines, 'P', motor)?;
        if [signed.len(), key.len(), between.len()].iter().any(|&count| count != names.len()) {
            return Err("the lines of its header do not fit each other".into());
        }
        if key.iter().any(|rule| !matches!(rule.predictor, Predictor::Fixed(_) | Predictor::SameFrame(_))) {
            return Err("its keyframes do not stand alone".into());
        }
        let optional = |frame| {
            if lines.get(&format!("Field {frame} name")).is_some() { lines.encodings(frame) } else { Ok(Vec::new()) }
        };
        Ok(Self {
            firmware: lines.get("Firmware revision").unwrap_or_default().chars().take(200).collect(),
            time: names.iter().position(|name| name == "time").ok_or("its frames have no time")?,
            slow: optional('S')?,
            gps: optional('G')?,
            home: optional('H')?,
            key_interval: lines.number("I interval").and_then(positive).unwrap_or(32),
            share: share(&lines),
            gyro_dps: gyro_dps(&lines)?,
            accel_g: lines.number("acc_1G").filter(|&counts| counts > 0).map(|counts| 1.0 / counts as f64),
            names,
            signed,
            key,
            between,
        })
    }
}

fn rules(lines: &Lines<'_>, frame: char, motor: Option<usize>) -> Result<Vec<Rule>, String> {
    let name = format!("Field {frame} predictor");
    let encodings = lines.encodings(frame)?;
    let numbers = lines.numbers(&name)?;
    if numbers.len() != encodings.len() {
        return Err("the lines of its header do not fit each other".into());
    }
    let mut found = Vec::new();
    for (index, (number, encoding)) in numbers.into_iter().zip(encodings).enumerate() {
        let given = |line: &str| {
            let value = lines.number(line).and_then(|value| i32::try_from(value).ok());
            value.map(Predictor::Fixed).ok_or_else(|| format!("its header has no usable line {line:?}"))
        };
        let predictor = match number {
            0 => Predictor::Fixed(0),
            1 => Predictor::Previous,
            2 => Predictor::StraightLine,
            3 => Predictor::Average,
            4 => given("minthrottle")?,
            5 => Predictor::SameFrame(motor.filter(|&motor| motor < index).ok_or("its frames have no motor[0] first")?),
            6 => Predictor::Increment,
            8 => Predictor::Fixed(1500),
            9 => given("vbatref")?,
            11 => given("motorOutput")?,
            other => return Err(format!("predictor {other} of its frames is not known")),
        };
        found.push(Rule { predictor, encoding });
    }
    Ok(found)
}

fn positive(value: i64) -> Option<u32> {
    u32::try_from(value).ok().filter(|&value| (1..=65_536).contains(&value))
}

/// "1/4" as INAV has it, "4" as Betaflight has it.
fn share(lines: &Lines<'_>) -> (u32, u32) {
    let text = lines.get("P interval").unwrap_or("1");
    let (of, all) = text.split_once('/').unwrap_or(("1", text));
    let number = |word: &str| word.trim().parse().ok().and_then(positive);
    match (number(of), number(all)) {
        (Some(of), Some(all)) if of <= all => (of, all),
        _ => (1, 1),
    }
}

/// The bits of a float in hexadecimal; deg/s a count in Betaflight and INAV.
fn gyro_dps(lines: &Lines<'_>) -> Result<f64, String> {
    let Some(text) = lines.get("gyro_scale").or_else(|| lines.get("gyro.scale")) else { return Ok(1.0) };
    let bits = text.trim().strip_prefix("0x").and_then(|hex| u32::from_str_radix(hex, 16).ok());
    let scale = bits.map_or(f64::NAN, |bits| f64::from(f32::from_bits(bits)));
    // Firmware of the first years wrote rad/us; it holds another data version or a scale far below these.
    if (1e-4..=1e4).contains(&scale) { Ok(scale) } else { Err("line \"gyro_scale\" of its header is damaged".into()) }
}
