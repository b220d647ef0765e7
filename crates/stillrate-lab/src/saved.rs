//! Saved filters: configuration and state as explicit little-endian bytes, versioned and checksummed.
//!
//! Layout: magic `STILLRAT`, version u16, precision u8 (4 or 8 bytes a number), method (u8 length, text), settings
//! (u16 count; each u8 length, name, kind u8, then a number, a u16-counted list, or a u8-counted word), channels
//! u32, numbers (u64 count, then numbers of the stated size): the state of each channel, then the last estimate of each
//! channel, which may be absent; CRC-32 of everything before. Nothing else is trusted: lengths are checked against
//! the bytes at hand, and the configuration is built anew and checked like any other.

use stillrate::Real;

use crate::samples::Precision;
use crate::settings_map::{SettingsMap, Value};

const MAGIC: &[u8; 8] = b"STILLRAT";
const VERSION: u16 = 1;

/// What [`read`] found.
///
/// # Example
/// ```
/// use stillrate_lab::runner::{Precision, build};
/// use stillrate_lab::saved::{self, Saved};
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
/// let filter = build("pt1", &settings, 3, Precision::Single)?;
/// let Saved { method, precision, channels, .. } = saved::read(&filter.save()).unwrap();
/// assert_eq!((method.as_str(), precision, channels), ("pt1", Precision::Single, 3));
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Saved {
    /// Name of the method.
    pub method: String,
    /// Every setting.
    pub settings: SettingsMap,
    /// Number type of the state.
    pub precision: Precision,
    /// Number of channels.
    pub channels: usize,
    /// States and last estimates, widened to `f64` (exact).
    pub numbers: Vec<f64>,
}

/// Writes a filter's configuration and state.
///
/// # Example
/// ```
/// use stillrate_lab::saved::write;
/// use stillrate_lab::settings_map::SettingsMap;
/// let bytes = write("pt1", &SettingsMap::new(), 1, &[0.5_f32]);
/// assert_eq!(&bytes[..11], b"STILLRAT\x01\x00\x04"); // version 1, four bytes a number
/// assert_eq!(bytes[bytes.len() - 8..bytes.len() - 4], 0.5_f32.to_le_bytes()); // before the checksum
/// ```
#[must_use]
pub fn write<T: Real>(method: &str, settings: &SettingsMap, channels: usize, numbers: &[T]) -> Vec<u8> {
    let mut out = Vec::with_capacity(256 + numbers.len() * T::BYTES);
    out.extend_from_slice(MAGIC);
    out.extend_from_slice(&VERSION.to_le_bytes());
    out.push(T::BYTES as u8);
    word(&mut out, method);
    out.extend_from_slice(&(settings.len() as u16).to_le_bytes());
    for (name, value) in settings {
        word(&mut out, name);
        match value {
            Value::Number(number) => {
                out.push(0);
                out.extend_from_slice(&number.to_le_bytes());
            }
            Value::List(list) => {
                out.push(1);
                out.extend_from_slice(&(list.len() as u16).to_le_bytes());
                for number in list {
                    out.extend_from_slice(&number.to_le_bytes());
                }
            }
            Value::Word(text) => {
                out.push(2);
                word(&mut out, text);
            }
        }
    }
    out.extend_from_slice(&(channels as u32).to_le_bytes());
    out.extend_from_slice(&(numbers.len() as u64).to_le_bytes());
    for number in numbers {
        out.extend_from_slice(&number.to_little_endian()[..T::BYTES]);
    }
    let sum = crc32(&out);
    out.extend_from_slice(&sum.to_le_bytes());
    out
}

fn word(out: &mut Vec<u8>, text: &str) {
    out.push(text.len().min(255) as u8);
    out.extend_from_slice(&text.as_bytes()[..text.len().min(255)]);
}

/// Reads what [`write()`] wrote.
///
/// # Errors
/// A sentence that says why the bytes are refused.
///
/// # Example
/// ```
/// use stillrate_lab::saved::{read, write};
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let settings = SettingsMap::from([("cutoff_hz".to_string(), Value::Number(8.0))]);
/// let mut bytes = write("pt1", &settings, 1, &[1.0_f64, 2.0]);
/// assert_eq!(read(&bytes).unwrap().numbers, [1.0, 2.0]);
/// bytes[20] ^= 1;
/// assert!(read(&bytes).unwrap_err().contains("damaged"));
/// ```
pub fn read(bytes: &[u8]) -> Result<Saved, String> {
    if !bytes.starts_with(MAGIC) {
        return Err("not a saved filter (the first bytes are not STILLRAT)".into());
    }
    let Some((body, sum)) = bytes.split_last_chunk::<4>() else { return Err(truncated()) };
    let mut at = Cursor { bytes: body, position: MAGIC.len() };
    let version = u16::from_le_bytes(at.take()?);
    if version != VERSION {
        return Err(format!("saved filter has version {version}, this library reads version {VERSION}"));
    }
    if crc32(body) != u32::from_le_bytes(*sum) {
        return Err("saved filter is damaged (checksum differs) or truncated".into());
    }
    let precision = match at.take::<1>()? {
        [4] => Precision::Single,
        [8] => Precision::Double,
        [other] => return Err(format!("saved filter has numbers of {other} bytes")),
    };
    let method = at.word()?;
    let mut settings = SettingsMap::new();
    for _ in 0..u16::from_le_bytes(at.take()?) {
        let name = at.word()?;
        let value = match at.take::<1>()? {
            [0] => Value::Number(f64::from_le_bytes(at.take()?)),
            [1] => {
                let count = u16::from_le_bytes(at.take()?);
                Value::List((0..count).map(|_| at.take().map(f64::from_le_bytes)).collect::<Result<_, _>>()?)
            }
            [2] => Value::Word(at.word()?),
            [kind] => return Err(format!("saved filter has a setting of unknown kind {kind}")),
        };
        settings.insert(name, value);
    }
    let channels = u32::from_le_bytes(at.take()?) as usize;
    let count = u64::from_le_bytes(at.take()?) as usize;
    let size = if precision == Precision::Single { 4 } else { 8 };
    let left = body.len() - at.position;
    if count.checked_mul(size) != Some(left) {
        return Err(truncated());
    }
    let numbers = (0..count)
        .map(|_| match precision {
            Precision::Single => at.take().map(|four| f64::from(f32::from_le_bytes(four))),
            Precision::Double => at.take().map(f64::from_le_bytes),
        })
        .collect::<Result<_, _>>()?;
    Ok(Saved { method, settings, precision, channels, numbers })
}

fn truncated() -> String {
    "saved filter is truncated".into()
}

struct Cursor<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl Cursor<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let rest = self.bytes.get(self.position..).ok_or_else(truncated)?;
        let chunk = rest.first_chunk::<N>().ok_or_else(truncated)?;
        self.position += N;
        Ok(*chunk)
    }

    fn word(&mut self) -> Result<String, String> {
        let length = usize::from(self.take::<1>()?[0]);
        let text = self.bytes.get(self.position..self.position + length).ok_or_else(truncated)?;
        self.position += length;
        String::from_utf8(text.to_vec()).map_err(|_| "saved filter has a name that is no text".into())
    }
}

/// CRC-32 (IEEE 802.3), bit by bit: states are small.
///
/// # Example
/// ```
/// assert_eq!(stillrate_lab::saved::crc32(b"123456789"), 0xCBF4_3926); // the check value of its definition
/// ```
#[must_use]
pub fn crc32(bytes: &[u8]) -> u32 {
    let mut sum = u32::MAX;
    for byte in bytes {
        sum ^= u32::from(*byte);
        for _ in 0..8 {
            sum = (sum >> 1) ^ (0xEDB8_8320 & (sum & 1).wrapping_neg());
        }
    }
    !sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flipped_bit_and_every_cut_is_refused() {
        let settings = SettingsMap::from([("cutoff_hz".to_string(), Value::Number(8.0))]);
        let good = write("pt1", &settings, 1, &[1.0_f64, 2.0]);
        assert!(read(&good).is_ok());
        for cut in 0..good.len() {
            assert!(read(&good[..cut]).is_err(), "cut at {cut}");
        }
        for bit in 0..8 * good.len() {
            let mut bad = good.clone();
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(read(&bad).is_err(), "bit {bit}");
        }
    }
}
