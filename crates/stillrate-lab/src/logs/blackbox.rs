//! Betaflight and INAV blackbox logs through the crate `blackbox-log`: the main frames of every flight in a file.
//!
//! A file holds one log a flight, end to end. What is damaged inside a flight the parser leaves out (the time stamps show
//! the gap); a flight whose header cannot be read is counted, not guessed.
//!
//! Not in use yet: version 0.4.3 of the crate is wrong by a few counts between keyframes in fields that are predicted by
//! the average of the last two frames (gyro, accelerometer, motors). The firmware sets both to the keyframe after one;
//! the crate keeps the frame before it. Stamps and counts of frames are right.

use blackbox_log::frame::{FieldDef, MainValue};
use blackbox_log::prelude::*;
use blackbox_log::units::si::acceleration::standard_gravity;
use blackbox_log::units::si::angular_velocity::degree_per_second;
use blackbox_log::{File, Filter, FilterSet};

/// One flight.
#[derive(Clone, Debug, Default)]
pub struct Flight {
    /// Firmware that wrote it.
    pub firmware: String,
    /// Time stamps in microseconds.
    pub time_us: Vec<i64>,
    /// Names of the columns, such as `gyroADC[0]`.
    pub names: Vec<String>,
    /// Columns: rates in deg/s, accelerations in g.
    pub columns: Vec<Vec<f64>>,
}

/// The flights of a file.
#[derive(Clone, Debug, Default)]
pub struct Flights {
    /// Those that can be read and have samples.
    pub flights: Vec<Flight>,
    /// Why others cannot.
    pub unreadable: Vec<String>,
}

/// Reads all flights of a file.
#[must_use]
pub fn read(bytes: &[u8]) -> Flights {
    let filters = FilterSet {
        main: Filter::Unfiltered,
        slow: Filter::OnlyFields(["none"].into()),
        gps: Filter::OnlyFields(["none"].into()),
    };
    let mut found = Flights::default();
    for headers in File::new(bytes).iter() {
        match headers {
            Ok(headers) => {
                let flight = flight(&headers, &filters);
                if !flight.time_us.is_empty() {
                    found.flights.push(flight);
                }
            }
            Err(error) => found.unreadable.push(error.to_string()),
        }
    }
    found
}

fn flight(headers: &Headers<'_>, filters: &FilterSet) -> Flight {
    let mut parser = headers.data_parser_with_filters(filters);
    let names: Vec<String> = parser.main_frame_def().iter().map(|FieldDef { name, .. }| name.to_owned()).collect();
    let mut flight = Flight {
        firmware: headers.firmware_revision().to_owned(),
        columns: vec![Vec::new(); names.len()],
        names,
        ..Flight::default()
    };
    while let Some(event) = parser.next() {
        let ParserEvent::Main(frame) = event else { continue };
        flight.time_us.push(i64::try_from(frame.time_raw()).unwrap_or(i64::MAX));
        for (column, value) in flight.columns.iter_mut().zip(frame.iter()) {
            column.push(match value {
                MainValue::Rotation(rate) => rate.get::<degree_per_second>(),
                MainValue::Acceleration(force) => force.get::<standard_gravity>(),
                MainValue::Signed(whole) => whole.into(),
                MainValue::Unsigned(whole) => whole.into(),
                MainValue::Amperage(_) | MainValue::Voltage(_) => f64::NAN,
            });
        }
    }
    flight
}

#[cfg(test)]
mod tests {
    #[test]
    fn what_is_no_log_has_no_flights() {
        for junk in
            [&b""[..], &[0; 4096], b"H Product:Blackbox flight data recorder by Nicholas Sherlock\nH Data version:9\n"]
        {
            assert!(super::read(junk).flights.is_empty());
        }
    }
}
