//! Betaflight and INAV blackbox logs: the main frames of the longest flight in a file.
//!
//! A file holds one log a flight, end to end, each with a header of its own. What is damaged inside a flight is left out
//! and counted (the time stamps show the gap); a flight whose header cannot be read is counted, not guessed.
//!
//! Decoded here, not by the crate `blackbox-log`: its version 0.4.3 predicts the first frame behind a keyframe from the
//! frame before the keyframe as well (one gyro value in three comes out 1 or 2 deg/s wrong), adds differences
//! to stale frames behind damage, and refuses firmware it does not list; none of it can be set right from outside.

mod bytes;
mod frames;
mod header;

use bytes::Cursor;
use header::Header;

const MARKER: &[u8] = b"H Product:Blackbox flight data recorder";
/// Numbers that a flight may hold: an hour at 2 kHz of 37 fields.
const MAX_VALUES: usize = 1 << 28;
/// Reasons that are kept word for word.
const MAX_REASONS: usize = 100;

/// Values of one field.
///
/// # Example
/// ```
/// use stillrate_lab::logs::blackbox::{Values, read};
/// # let mut log = b"H Product:Blackbox flight data recorder\nH Data version:2\nH Field I name:time,gyroADC[0]\n\
/// # H Field I signed:0,1\nH Field I predictor:0,0\nH Field I encoding:1,0\nH Field P predictor:1,1\n\
/// # H Field P encoding:0,0\nH gyro_scale:0x3f000000\n".to_vec(); // half a deg/s a count
/// # log.extend(b"I\x64\x03P\x14\x02E\xffEnd of log\0"); // 100 us and -2 counts, then 10 us and 1 count more
/// let flight = read(&log).longest.unwrap();
/// assert_eq!(flight.columns[0], Values::Unsigned(vec![100, 110])); // time: as counted
/// assert_eq!(flight.columns[1], Values::Physical(vec![-1.0, -0.5])); // a gyro: deg/s
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// In physical units.
    Physical(Vec<f64>),
    /// Counts with sign, in the firmware's own units.
    Signed(Vec<i32>),
    /// Counts without sign.
    Unsigned(Vec<u32>),
}

/// One flight.
///
/// # Example
/// ```
/// use stillrate_lab::logs::blackbox::{Flight, read};
/// let mut log = b"H Product:Blackbox flight data recorder\nH Data version:2\nH Field I name:time,gyroADC[0]\n\
/// H Field I signed:0,1\nH Field I predictor:0,0\nH Field I encoding:1,0\nH Field P predictor:1,1\n\
/// H Field P encoding:0,0\nH gyro_scale:0x3f000000\n".to_vec(); // half a deg/s a count
/// log.extend(b"I\x64\x03P\x14\x02"); // 100 us and -2 counts, then 10 us and 1 count more
/// let Flight { time_us, names, ended, .. } = read(&log).longest.unwrap();
/// assert_eq!((time_us, names[1].as_str()), (vec![100, 110], "gyroADC[0]"));
/// assert!(!ended); // no end mark: the power went first
/// ```
#[derive(Clone, Debug, Default)]
pub struct Flight {
    /// Firmware that wrote it.
    pub firmware: String,
    /// Time stamps in microseconds.
    pub time_us: Vec<i64>,
    /// Names of the columns, such as `gyroADC[0]`.
    pub names: Vec<String>,
    /// Columns: rates in deg/s, accelerations in g, all else as counted.
    pub columns: Vec<Values>,
    /// Places where bytes were no frame; the log goes on at the next keyframe.
    pub damaged_places: usize,
    /// Whether the log was closed: false if the power went first, or the file was cut.
    pub ended: bool,
    /// Whether the flight holds more than can be read.
    pub full: bool,
}

/// The flights of a file.
///
/// # Example
/// ```
/// use stillrate_lab::logs::blackbox::{Flights, read};
/// let of_another_age = b"H Product:Blackbox flight data recorder\nH Data version:1\n";
/// let Flights { longest, count, unreadable } = read(of_another_age);
/// assert!(longest.is_none() && count == 0);
/// assert_eq!(unreadable, ["its data version is not 2"]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Flights {
    /// The one with most samples.
    pub longest: Option<Flight>,
    /// How many have samples.
    pub count: usize,
    /// Why others cannot be read.
    pub unreadable: Vec<String>,
}

/// Reads the bytes of a file.
///
/// # Example
/// ```
/// let found = stillrate_lab::logs::blackbox::read(b"no log at all");
/// assert!(found.longest.is_none() && found.count == 0);
/// ```
#[must_use]
pub fn read(bytes: &[u8]) -> Flights {
    let mut found = Flights::default();
    let mut rest = bytes.get(find(bytes, MARKER)..).unwrap_or_default();
    while !rest.is_empty() {
        let end = rest.get(MARKER.len()..).map_or(0, |behind| find(behind, MARKER)) + MARKER.len();
        let (own, behind) = rest.split_at(end.min(rest.len()));
        let mut cursor = Cursor::new(own);
        match Header::read(&mut cursor) {
            Ok(header) => {
                let frames = frames::read(&mut cursor, &header, MAX_VALUES);
                found.count += usize::from(!frames.time_us.is_empty());
                let longest = found.longest.as_ref().map_or(0, |flight| flight.time_us.len());
                if frames.time_us.len() > longest {
                    found.longest = Some(flight(header, frames));
                }
            }
            Err(reason) if found.unreadable.len() < MAX_REASONS => found.unreadable.push(reason),
            Err(_) => {}
        }
        rest = behind;
    }
    found
}

/// Where `word` begins in `bytes`, or their end.
fn find(bytes: &[u8], word: &[u8]) -> usize {
    bytes.windows(word.len()).position(|window| window == word).unwrap_or(bytes.len())
}

fn flight(header: Header, frames: frames::Frames) -> Flight {
    let fields = header.names.iter().zip(&header.signed);
    let columns = fields.zip(frames.columns).map(|((name, &signed), counts)| {
        let scale = match name.split('[').next() {
            Some("gyroADC" | "gyroUnfilt" | "gyroRaw") => Some(header.gyro_dps),
            Some("accSmooth") => header.accel_g,
            _ => None,
        };
        match scale {
            Some(scale) => Values::Physical(counts.into_iter().map(|count| f64::from(count) * scale).collect()),
            None if signed => Values::Signed(counts),
            None => Values::Unsigned(counts.into_iter().map(i32::cast_unsigned).collect()),
        }
    });
    Flight {
        columns: columns.collect(),
        firmware: header.firmware,
        time_us: frames.time_us,
        names: header.names,
        damaged_places: frames.damaged_places,
        ended: frames.ended,
        full: frames.full,
    }
}
