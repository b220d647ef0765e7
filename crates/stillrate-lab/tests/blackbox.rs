//! Blackbox logs written here, byte by byte as the format's description says, and read back.

use proptest::prelude::*;
use stillrate_lab::logs::blackbox::{Flight, Values, read};

const HEADER: &str = "H Product:Blackbox flight data recorder by Nicholas Sherlock\n\
    H Data version:2\n\
    H I interval:16\n\
    H P interval:1/4\n\
    H Field I name:loopIteration,time,gyroADC[0],gyroADC[1],motor[0],motor[1],debug[0]\n\
    H Field I signed:0,0,1,1,0,0,1\n\
    H Field I predictor:0,0,0,0,11,5,0\n\
    H Field I encoding:1,1,0,0,1,0,0\n\
    H Field P predictor:6,2,3,3,3,3,1\n\
    H Field P encoding:9,0,0,0,0,0,0\n\
    H Field S name:flags\n\
    H Field S encoding:1\n\
    H Firmware revision:Betaflight 4.5.1\n\
    H gyro_scale:0x3f000000\n\
    H motorOutput:158,2047\n";

fn unsigned(bytes: &mut Vec<u8>, mut value: u32) {
    while value > 0x7f {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

fn signed(bytes: &mut Vec<u8>, value: i64) {
    let value = value as i32;
    unsigned(bytes, (value.wrapping_shl(1) ^ (value >> 31)) as u32);
}

/// What the firmware keeps: both of the last frames become the keyframe after one.
fn log(rows: &[[i64; 6]]) -> Vec<u8> {
    let mut bytes = HEADER.as_bytes().to_vec();
    let mut history = [[0; 6]; 2];
    for (index, row) in rows.iter().enumerate() {
        let [last, before] = history;
        if index % 4 == 0 {
            bytes.push(b'I');
            unsigned(&mut bytes, 4 * index as u32);
            unsigned(&mut bytes, row[0] as u32);
            signed(&mut bytes, row[1]);
            signed(&mut bytes, row[2]);
            unsigned(&mut bytes, (row[3] - 158) as u32);
            signed(&mut bytes, row[4] - row[3]);
            signed(&mut bytes, row[5]);
            history = [*row; 2];
        } else {
            bytes.push(b'P');
            signed(&mut bytes, row[0] - (2 * last[0] - before[0]));
            for field in 1..5 {
                signed(&mut bytes, row[field] - i64::midpoint(last[field], before[field]));
            }
            signed(&mut bytes, row[5] - last[5]);
            history = [*row, last];
        }
        if index % 5 == 2 {
            bytes.extend(b"S\x05");
        }
        if index == 6 {
            bytes.extend(b"E\x1e\x01\x02");
        }
    }
    bytes.extend(b"E\xffEnd of log\0");
    bytes
}

fn rows(count: usize) -> Vec<[i64; 6]> {
    let row = |k: i64| [1000 + 2000 * k + k % 3, k * k % 301 - 150, -7 * k, 158 + 13 * k % 900, 200 + k, -k];
    (0..count as i64).map(row).collect()
}

fn table(flight: &Flight) -> Vec<[i64; 6]> {
    let column = |name: &str| {
        let at = flight.names.iter().position(|found| found == name).expect("a field of the header");
        match &flight.columns[at] {
            Values::Physical(values) => values.iter().map(|value| (value / 0.5) as i64).collect::<Vec<_>>(),
            Values::Signed(values) => values.iter().map(|&value| value.into()).collect(),
            Values::Unsigned(values) => values.iter().map(|&value| value.into()).collect(),
        }
    };
    let columns = ["gyroADC[0]", "gyroADC[1]", "motor[0]", "motor[1]", "debug[0]"].map(column);
    let row =
        |(k, &time): (usize, &i64)| [time, columns[0][k], columns[1][k], columns[2][k], columns[3][k], columns[4][k]];
    flight.time_us.iter().enumerate().map(row).collect()
}

#[test]
fn reads_back_what_was_written() {
    let found = read(&log(&rows(101)));
    let flight = found.longest.expect("one flight");
    assert_eq!(table(&flight), rows(101));
    assert!(flight.ended && flight.damaged_places == 0 && found.count == 1 && found.unreadable.is_empty());
    assert_eq!(flight.firmware, "Betaflight 4.5.1");
    let Values::Unsigned(loops) = &flight.columns[0] else { panic!("loops have no sign") };
    assert!(loops.iter().enumerate().all(|(k, &turn)| turn as usize == 4 * k), "every fourth loop is logged");
}

#[test]
fn takes_the_longest_of_several_flights_and_counts_the_unreadable() {
    let mut bytes = log(&rows(9));
    bytes.extend(log(&rows(40)));
    let mut other = log(&rows(5));
    let at = HEADER.find("version:2").expect("the version") + 8;
    other[at] = b'7';
    bytes.extend(other);
    let found = read(&bytes);
    assert_eq!(found.longest.expect("a flight").time_us.len(), 40);
    assert_eq!((found.count, found.unreadable.len()), (2, 1));
}

#[test]
fn goes_on_at_the_keyframe_behind_damage() {
    let written = rows(80);
    let clean = log(&written);
    let from = HEADER.len() + 200;
    for at in from..from + 60 {
        let mut bytes = clean.clone();
        bytes[at] = 0xf1;
        let flight = read(&bytes).longest.expect("a flight");
        let found = table(&flight);
        // 80 rows are 20 keyframes; a damaged byte costs the frames up to the second keyframe behind it at most.
        assert_eq!(found[found.len() - 36..], written[44..], "byte {at}");
        assert!(found.len() >= 68, "byte {at}: {} frames", found.len());
    }
}

#[test]
fn a_cut_log_is_read_to_its_last_whole_frame() {
    let clean = log(&rows(30));
    // The zero behind the end mark may be missing.
    for end in HEADER.len() + 30..clean.len() - 1 {
        let flight = read(&clean[..end]).longest.expect("a flight");
        assert_eq!(table(&flight), rows(30)[..flight.time_us.len()]);
        assert!(!flight.ended && flight.damaged_places == 0);
    }
}

#[test]
fn time_goes_on_when_the_clock_of_32_bits_starts_anew() {
    let shifted: Vec<[i64; 6]> = rows(20)
        .into_iter()
        .map(|mut row| {
            row[0] += (1 << 32) - 20_000;
            row
        })
        .collect();
    let flight = read(&log(&shifted)).longest.expect("a flight");
    assert_eq!(table(&flight), shifted);
}

#[test]
fn headers_that_make_no_sense_are_refused_with_a_reason() {
    let clean = String::from_utf8_lossy(&log(&rows(9))).into_owned();
    for (from, to) in [
        ("1,1,0,0,1,0,0", "1,1,0,0,1,0"),
        ("6,2,3,3,3,3,1", "6,2,3,3,3,3,99"),
        ("9,0,0,0,0,0,0", "9,0,0,0,0,0,5"),
        ("0,0,0,0,11,5,0", "0,0,0,0,11,5,1"),
        (",time,", ",tame,"),
        ("0x3f000000", "0x00000001"),
        ("H motorOutput", "H motorInput"),
    ] {
        let found = read(clean.replacen(from, to, 1).as_bytes());
        assert!(found.longest.is_none() && found.unreadable.len() == 1, "{to}");
    }
}

proptest! {
    #[test]
    fn no_bytes_make_it_panic(junk in prop::collection::vec(any::<u8>(), 0..600), at in 0_usize..1500) {
        let mut bytes = log(&rows(50));
        let at = at.min(bytes.len());
        bytes.splice(at..bytes.len().min(at + junk.len()), junk.iter().copied());
        drop(read(&bytes));
        bytes.splice(..0, HEADER.bytes());
        drop(read(&bytes));
        drop(read(&junk));
    }
}
