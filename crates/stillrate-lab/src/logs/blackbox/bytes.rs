//! Bytes of a blackbox log into whole numbers: the encodings that its header names by number.
//!
//! Written from the format's public description ("Blackbox logging internals" of the Cleanflight family).
//! A reader hands back `None` where the bytes end or cannot be what they claim to be; it never looks past the end.

/// Fields that one encoding packs together at most.
pub(super) const GROUP: usize = 8;

/// How a field is written, by its number in the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// 0: seven bits a byte, sign in the lowest bit.
    Signed,
    /// 1: seven bits a byte.
    Unsigned,
    /// 3: fourteen bits, negated.
    Negative14,
    /// 6: a byte that tells which of up to eight fields are not zero, then those.
    TaggedBytes,
    /// 7: three fields of 2, 4 or 6 bits, or of whole bytes.
    ThreeFixed,
    /// 8: four fields of 0, 4, 8 or 16 bits.
    Four,
    /// 9: not written, zero.
    Nothing,
    /// 10: three fields of 2, 5-5-4 or 8-7-7 bits, or of whole bytes.
    ThreeUneven,
}

impl Encoding {
    pub(super) fn from_number(number: i64) -> Option<Self> {
        Some(match number {
            0 => Self::Signed,
            1 => Self::Unsigned,
            3 => Self::Negative14,
            6 => Self::TaggedBytes,
            7 => Self::ThreeFixed,
            8 => Self::Four,
            9 => Self::Nothing,
            10 => Self::ThreeUneven,
            _ => return None,
        })
    }

    /// How many neighbours of the same encoding share one packet.
    pub(super) fn group(self) -> usize {
        match self {
            Self::TaggedBytes => 8,
            Self::Four => 4,
            Self::ThreeFixed | Self::ThreeUneven => 3,
            Self::Signed | Self::Unsigned | Self::Negative14 | Self::Nothing => 1,
        }
    }
}

/// A place in the bytes of a log.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    /// Index of the next byte.
    pub(super) at: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    pub(super) fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    pub(super) fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    pub(super) fn byte(&mut self) -> Option<u8> {
        let byte = self.peek()?;
        self.at += 1;
        Some(byte)
    }

    /// The line up to the next line feed, which is passed.
    pub(super) fn line(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        let end = rest.iter().position(|&byte| byte == b'\n')?;
        self.at += end + 1;
        rest.get(..end)
    }

    /// Passes `expected` if it comes next; otherwise stops where it ceases to.
    pub(super) fn passes(&mut self, expected: &[u8]) -> Option<()> {
        let same = self.rest().iter().zip(expected).take_while(|(found, expected)| found == expected).count();
        self.at += same;
        (same == expected.len()).then_some(())
    }

    /// Goes on to the next byte that is `marker`, or to the end.
    pub(super) fn seek(&mut self, marker: u8) {
        self.at += self.rest().iter().position(|&byte| byte == marker).unwrap_or(self.rest().len());
    }

    /// Seven bits a byte, the lowest first, five bytes at most.
    pub(super) fn unsigned(&mut self) -> Option<u32> {
        let mut value = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    /// The same with the sign in the lowest bit.
    pub(super) fn signed(&mut self) -> Option<i32> {
        let value = self.unsigned()?;
        Some((value >> 1).cast_signed() ^ -(value & 1).cast_signed())
    }

    /// A little-endian number of `bytes` bytes with sign.
    fn little(&mut self, bytes: u32) -> Option<i32> {
        let mut value = 0;
        for index in 0..bytes {
            value |= u32::from(self.byte()?) << (8 * index);
        }
        Some(extended(value, 8 * bytes))
    }

    /// The next packet: `count` fields of one encoding, at most [`Encoding::group`].
    pub(super) fn packet(&mut self, encoding: Encoding, count: usize) -> Option<[i32; GROUP]> {
        let mut values = [0; GROUP];
        match encoding {
            Encoding::Signed => values[0] = self.signed()?,
            Encoding::Unsigned => values[0] = self.unsigned()?.cast_signed(),
            Encoding::Negative14 => values[0] = extended(self.unsigned()? & 0x3fff, 14).wrapping_neg(),
            Encoding::Nothing => {}
            Encoding::TaggedBytes if count == 1 => values[0] = self.signed()?,
            Encoding::TaggedBytes => self.tagged_bytes(values.get_mut(..count)?)?,
            Encoding::ThreeFixed => [values[0], values[1], values[2]] = self.three(false)?,
            Encoding::ThreeUneven => [values[0], values[1], values[2]] = self.three(true)?,
            Encoding::Four => [values[0], values[1], values[2], values[3]] = self.four()?,
        }
        Some(values)
    }

    fn tagged_bytes(&mut self, values: &mut [i32]) -> Option<()> {
        let mut tag = self.byte()?;
        for value in values {
            if tag & 1 == 1 {
                *value = self.signed()?;
            }
            tag >>= 1;
        }
        (tag == 0).then_some(())
    }

    /// Three fields behind a two-bit choice: two bits each, two wider sets, or whole bytes.
    fn three(&mut self, uneven: bool) -> Option<[i32; 3]> {
        let lead = u32::from(self.byte()?);
        let mut low = lead & 0x3f;
        let (bits, widths) = match (lead >> 6, uneven) {
            (0, _) => (low, [2, 2, 2]),
            (1, false) => (low << 8 | u32::from(self.byte()?), [4, 4, 4]),
            (1, true) => (low << 8 | u32::from(self.byte()?), [5, 5, 4]),
            (2, false) => {
                let middle = u32::from(self.byte()?) & 0x3f;
                (low << 12 | middle << 6 | u32::from(self.byte()?) & 0x3f, [6, 6, 6])
            }
            (2, true) => {
                let middle = u32::from(self.byte()?);
                (low << 16 | middle << 8 | u32::from(self.byte()?), [8, 7, 7])
            }
            _ => {
                let mut values = [0; 3];
                for value in &mut values {
                    *value = self.little((low & 3) + 1)?;
                    low >>= 2;
                }
                return Some(values);
            }
        };
        let [first, second, third] = widths;
        Some([extended(bits >> (second + third), first), extended(bits >> third, second), extended(bits, third)])
    }

    /// Four fields of 0, 4, 8 or 16 bits, packed by half bytes, the high half first.
    fn four(&mut self) -> Option<[i32; 4]> {
        let mut tag = self.byte()?;
        let mut left: Option<u8> = None;
        let mut values = [0; 4];
        for value in &mut values {
            let halves = [0, 1, 2, 4][usize::from(tag & 3)];
            let mut bits = 0;
            for _ in 0..halves {
                let half = if let Some(low) = left.take() {
                    low
                } else {
                    let byte = self.byte()?;
                    left = Some(byte & 0xf);
                    byte >> 4
                };
                bits = bits << 4 | u32::from(half);
            }
            *value = extended(bits, 4 * halves);
            tag >>= 2;
        }
        Some(values)
    }
}

/// The lowest `bits` of a number as a number with sign.
fn extended(value: u32, bits: u32) -> i32 {
    match 32_u32.checked_sub(bits) {
        Some(unused @ 0..=31) => (value << unused).cast_signed() >> unused,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packet(bytes: &[u8], encoding: Encoding, count: usize) -> Option<Vec<i32>> {
        let mut cursor = Cursor::new(bytes);
        let values = cursor.packet(encoding, count)?;
        assert_eq!(cursor.at, bytes.len(), "all bytes are taken");
        Some(values[..count].to_vec())
    }

    #[test]
    fn reads_each_encoding_as_described() {
        for (bytes, encoding, expected) in [
            (&[0x03][..], Encoding::Signed, &[-2][..]),
            (&[0xff, 0xff, 0xff, 0xff, 0x0f], Encoding::Signed, &[i32::MIN]),
            (&[0xac, 0x02], Encoding::Unsigned, &[300]),
            (&[0x05], Encoding::Negative14, &[-5]),
            (&[0xff, 0x7f], Encoding::Negative14, &[1]),
            (&[0b0000_0101, 2, 3], Encoding::TaggedBytes, &[1, 0, -2]),
            (&[0b0001_1011], Encoding::ThreeFixed, &[1, -2, -1]),
            (&[0b0100_0111, 0x8f], Encoding::ThreeFixed, &[7, -8, -1]),
            (&[0b1001_1111, 0x20, 0x3f], Encoding::ThreeFixed, &[31, -32, -1]),
            (&[0b1100_0100, 0xff, 0x00, 0x80, 0x05], Encoding::ThreeFixed, &[-1, -32768, 5]),
            (
                &[0b1111_1010, 0, 0, 0xfe, 0, 0, 1, 1, 0, 0, 0x80],
                Encoding::ThreeFixed,
                &[-0x2_0000, 0x1_0000, i32::MIN + 1],
            ),
            (&[0b0110_0000, 0x78], Encoding::ThreeUneven, &[-16, 7, -8]),
            (&[0b1010_0000, 0x3f, 0xbf], Encoding::ThreeUneven, &[-128, 0x7f - 0x80, 0x3f]),
            (&[0b1110_0100, 0x7f, 0x11, 0x23, 0x40], Encoding::Four, &[0, 7, -15, 0x1234]),
        ] {
            assert_eq!(packet(bytes, encoding, expected.len()).as_deref(), Some(expected), "{encoding:?} {bytes:x?}");
        }
    }

    #[test]
    fn nothing_is_read_past_the_end() {
        for number in [0, 1, 3, 6, 7, 8, 10] {
            let encoding = Encoding::from_number(number).expect("a known number");
            assert_eq!(packet(&[], encoding, encoding.group()), None);
            assert_eq!(packet(&[0xff], encoding, encoding.group()), None);
        }
        assert_eq!(packet(&[0x80; 5], Encoding::Unsigned, 1), None, "too long for 32 bits");
    }
}
