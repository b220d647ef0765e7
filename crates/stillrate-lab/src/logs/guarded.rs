//! Text on its way to the reader of tables: stopped where no table goes on, so that a damaged file is refused with its line and not read
//! into memory.

use std::io::{self, Read};

/// No row of a log is longer; a longer one means that the file is no table.
const LONGEST_LINE_BYTES: usize = 1 << 20;

/// Passes text through; stops at bytes that no table holds. With `squeeze`, runs of blanks become one tab.
pub(super) struct Guarded<R> {
    inner: R,
    squeeze: bool,
    /// Number of the line being read.
    line: usize,
    /// Bytes of it so far.
    length: usize,
    /// Whether the byte before was blank or began a line.
    blank: bool,
}

impl<R> Guarded<R> {
    /// Guards text whose first line has a number in the file.
    pub(super) fn new(inner: R, line: usize, squeeze: bool) -> Self {
        Self { inner, squeeze, line, length: 0, blank: true }
    }
}

impl<R: Read> Read for Guarded<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let taken = self.inner.read(buffer)?;
            let mut kept = 0;
            for index in 0..taken {
                let byte = buffer[index];
                self.length += 1;
                if byte == 0 {
                    let text = format!("line {} holds binary zeros: the file is damaged or half-written", self.line);
                    return Err(io::Error::new(io::ErrorKind::InvalidData, text));
                }
                if self.length > LONGEST_LINE_BYTES {
                    let text = format!("line {} is longer than a megabyte: no table of text", self.line);
                    return Err(io::Error::new(io::ErrorKind::InvalidData, text));
                }
                if byte == b'\n' {
                    (self.line, self.length) = (self.line + 1, 0);
                }
                let blank = byte == b' ' || byte == b'\t';
                if self.squeeze && blank && self.blank {
                    continue;
                }
                self.blank = blank || byte == b'\n';
                buffer[kept] = if self.squeeze && blank { b'\t' } else { byte };
                kept += 1;
            }
            if kept > 0 || taken == 0 {
                return Ok(kept);
            }
        }
    }
}
