//! The frames of one flight: keyframes stand alone, those between are written relative to a prediction.
//!
//! The prediction by average of two is the one that is easily got wrong. The firmware keeps the last two frames it wrote
//! and sets both to a keyframe after writing one, so that the first frame behind a keyframe is predicted from the keyframe
//! alone. The division by two drops the fraction, as it does in C.
//!
//! A frame counts if every field can be read, the next byte begins another frame, and time goes on by less than
//! ten seconds. Behind one that does not count, frames are read again from the next keyframe on; a keyframe at an
//! unlikely time is believed once the next one fits to it.

use super::bytes::{Cursor, Encoding};
use super::header::{Header, Predictor, Rule};

/// Time does not jump by more within a flight, in microseconds.
const MAX_JUMP_US: i32 = 10_000_000;

/// The frames of a flight, column by column as they were counted.
#[derive(Clone, Debug, Default)]
pub(super) struct Frames {
    pub(super) time_us: Vec<i64>,
    pub(super) columns: Vec<Vec<i32>>,
    pub(super) damaged_places: usize,
    pub(super) ended: bool,
    pub(super) full: bool,
}

/// Where time stands: the clock of 32 bits, and the time since it began.
#[derive(Clone, Copy, Debug)]
struct Clock {
    stamp: u32,
    time_us: i64,
}

impl Clock {
    fn after(self, stamp: u32) -> Option<Self> {
        let step = stamp.wrapping_sub(self.stamp).cast_signed();
        (0..=MAX_JUMP_US).contains(&step).then(|| Self { stamp, time_us: self.time_us + i64::from(step) })
    }
}

/// What stood where a frame was tried.
enum Found {
    Frame(Vec<i32>, Clock),
    Passed,
    Doubtful(u32),
    Resumed(u32),
    End,
}

struct Reader<'h> {
    header: &'h Header,
    /// The last frame and the one before; empty until a keyframe is met.
    history: Option<[Vec<i32>; 2]>,
    clock: Option<Clock>,
    /// The stamp of a keyframe that did not fit, until the next shows which of the two is wrong.
    doubtful: Option<u32>,
}

/// Reads frames to the end of the flight, `max_values` numbers at most.
pub(super) fn read(cursor: &mut Cursor<'_>, header: &Header, max_values: usize) -> Frames {
    let mut frames = Frames { columns: vec![Vec::new(); header.names.len()], ..Frames::default() };
    let mut reader = Reader { header, history: None, clock: None, doubtful: None };
    let max_frames = max_values / header.names.len().max(1);
    loop {
        let start = cursor.at;
        let Some(kind) = cursor.byte() else { break };
        let found = reader.frame(kind, cursor);
        let followed = cursor.peek().is_none_or(|next| b"IPSGHE".contains(&next));
        match found {
            Some(Found::End) => {
                frames.ended = true;
                break;
            }
            Some(found) if followed => match found {
                Found::Frame(values, clock) => {
                    if frames.time_us.len() == max_frames {
                        frames.full = true;
                        break;
                    }
                    frames.time_us.push(clock.time_us);
                    for (column, &value) in frames.columns.iter_mut().zip(&values) {
                        column.push(value);
                    }
                    reader.accept(kind, values, clock);
                }
                Found::Doubtful(stamp) => {
                    reader.history = None;
                    reader.doubtful = Some(stamp);
                }
                Found::Resumed(stamp) => reader.resume(stamp),
                Found::Passed | Found::End => {}
            },
            // The last frame of a log without an end mark is often half written: no damage in what came before.
            None if cursor.peek().is_none() => break,
            _ => {
                frames.damaged_places += 1;
                reader.history = None;
                cursor.at = start + 1;
                cursor.seek(b'I');
            }
        }
    }
    frames
}

impl Reader<'_> {
    fn frame(&mut self, kind: u8, cursor: &mut Cursor<'_>) -> Option<Found> {
        match kind {
            b'I' => {
                let values = self.main(cursor, &self.header.key)?;
                let stamp = self.stamp(&values);
                let expected = self.doubtful.map(|stamp| self.nearest(stamp));
                let clock = match self.clock {
                    None => Some(Clock { stamp, time_us: i64::from(stamp) }),
                    Some(clock) => clock.after(stamp).or_else(|| expected.and_then(|clock| clock.after(stamp))),
                };
                Some(clock.map_or(Found::Doubtful(stamp), |clock| Found::Frame(values, clock)))
            }
            // Without a keyframe there is nothing to add the differences to: they are read to find their end.
            b'P' => {
                let values = self.main(cursor, &self.header.between)?;
                if self.history.is_none() {
                    return Some(Found::Passed);
                }
                let clock = self.clock?.after(self.stamp(&values))?;
                Some(Found::Frame(values, clock))
            }
            b'S' => passed(cursor, &self.header.slow),
            b'G' => passed(cursor, &self.header.gps),
            b'H' => passed(cursor, &self.header.home),
            b'E' => event(cursor),
            _ => None,
        }
    }

    fn stamp(&self, values: &[i32]) -> u32 {
        values.get(self.header.time).copied().unwrap_or_default().cast_unsigned()
    }

    /// The clock at a stamp that does not fit: earlier or later, whichever is nearer.
    fn nearest(&self, stamp: u32) -> Clock {
        let start = Clock { stamp, time_us: i64::from(stamp) };
        self.clock.map_or(start, |clock| {
            let step = stamp.wrapping_sub(clock.stamp).cast_signed();
            Clock { stamp, time_us: clock.time_us + i64::from(step) }
        })
    }

    /// After a pause, however long, which only goes forward.
    fn resume(&mut self, stamp: u32) {
        self.clock = self.clock.map(|clock| {
            let pause = stamp.wrapping_sub(clock.stamp);
            Clock { stamp, time_us: clock.time_us + i64::from(pause) }
        });
        self.history = None;
    }

    fn accept(&mut self, kind: u8, values: Vec<i32>, clock: Clock) {
        self.clock = Some(clock);
        self.doubtful = None;
        self.history = Some(match self.history.take() {
            Some([last, _]) if kind == b'P' => [values, last],
            _ => [values.clone(), values],
        });
    }

    fn main(&self, cursor: &mut Cursor<'_>, rules: &[Rule]) -> Option<Vec<i32>> {
        let mut values = differences(cursor, rules.iter().map(|rule| rule.encoding))?;
        for (index, rule) in rules.iter().enumerate() {
            let base = self.prediction(rule.predictor, index, &values);
            if let Some(value) = values.get_mut(index) {
                *value = value.wrapping_add(base);
            }
        }
        Some(values)
    }

    fn prediction(&self, predictor: Predictor, index: usize, current: &[i32]) -> i32 {
        let before = |frames: &[Vec<i32>; 2]| {
            let [last, last_but_one] = frames;
            (last.get(index).copied().unwrap_or_default(), last_but_one.get(index).copied().unwrap_or_default())
        };
        let (last, last_but_one) = self.history.as_ref().map(before).unwrap_or_default();
        match predictor {
            Predictor::Fixed(value) => value,
            Predictor::Previous => last,
            Predictor::StraightLine => last.wrapping_mul(2).wrapping_sub(last_but_one),
            Predictor::Average if self.header.signed.get(index) == Some(&true) => last.wrapping_add(last_but_one) / 2,
            Predictor::Average => (last.cast_unsigned().wrapping_add(last_but_one.cast_unsigned()) / 2).cast_signed(),
            Predictor::SameFrame(other) => current.get(other).copied().unwrap_or_default(),
            Predictor::Increment => self.next_logged(last.cast_unsigned()).cast_signed(),
        }
    }

    /// The loop after `last` that the log does not leave out by plan.
    fn next_logged(&self, last: u32) -> u32 {
        let (of, all) = self.header.share;
        let logged = |turn: &u32| (turn % self.header.key_interval + of - 1) % all < of;
        (1..=all).map(|step| last.wrapping_add(step)).find(logged).unwrap_or(last.wrapping_add(1))
    }
}

/// Reads the fields of a frame as they are written, packet by packet.
fn differences(cursor: &mut Cursor<'_>, encodings: impl Iterator<Item = Encoding> + Clone) -> Option<Vec<i32>> {
    let mut values = Vec::with_capacity(encodings.size_hint().0);
    let mut rest = encodings;
    while let Some(encoding) = rest.next() {
        let mut count = 1;
        while count < encoding.group() && rest.clone().next() == Some(encoding) {
            rest.next();
            count += 1;
        }
        values.extend_from_slice(cursor.packet(encoding, count)?.get(..count)?);
    }
    Some(values)
}

fn passed(cursor: &mut Cursor<'_>, encodings: &[Encoding]) -> Option<Found> {
    if encodings.is_empty() {
        return None;
    }
    differences(cursor, encodings.iter().copied()).map(|_| Found::Passed)
}

/// An event: its kind and what it carries.
fn event(cursor: &mut Cursor<'_>) -> Option<Found> {
    match cursor.byte()? {
        // A beep to align with video, the reason of disarming, a failure of the sensor.
        0 | 15 | 40 => cursor.unsigned().map(drop)?,
        // A setting changed in flight: a float if the topmost bit is set.
        13 if cursor.byte()? & 0x80 != 0 => (0..4).try_for_each(|_| cursor.byte().map(drop))?,
        13 => cursor.signed().map(drop)?,
        // Logging goes on after a pause: loop and time.
        14 => {
            cursor.unsigned()?;
            return cursor.unsigned().map(Found::Resumed);
        }
        // Modes now and before.
        30 => {
            cursor.unsigned()?;
            cursor.unsigned().map(drop)?;
        }
        // "End of log", in INAV with a reason behind it.
        255 => return cursor.passes(b"End of log").map(|()| Found::End),
        _ => return None,
    }
    Some(Found::Passed)
}
