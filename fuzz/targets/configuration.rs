//! Any settings are refused with a sentence or give a filter that keeps what every filter promises.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stillrate::Settings;
use stillrate_fuzz::Input;
use stillrate_lab::runner::{Precision, build, method_names, restore};
use stillrate_lab::settings_map::{SettingsMap, Value, to_map};

/// The default settings of every method: the names that exist.
fn known(method: &str) -> SettingsMap {
    macro_rules! by_name {
        ($($name:ident),* $(,)?) => {
            match method {
                $(<stillrate::filters::$name as Settings>::METHOD => {
                    let noise = stillrate::GyroNoise::from_density_two_sided(0.015);
                    to_map(&stillrate::filters::$name::defaults(50.0, noise))
                })*
                _ => SettingsMap::new(),
            }
        };
    }
    stillrate::methods!(by_name)
}

fn word(input: &mut Input<'_>) -> String {
    let length = input.choice(12);
    (0..length).map(|_| char::from(input.byte() % 96 + 32)).collect()
}

fuzz_target!(|bytes: &[u8]| {
    let mut input = Input(bytes);
    let names = method_names();
    let method = names[input.choice(names.len())];
    let precision = if input.byte() % 2 == 0 { Precision::Double } else { Precision::Single };
    let known = known(method);
    let fields: Vec<&String> = known.keys().collect();
    let mut map = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
    for _ in 0..input.choice(6) {
        let name = if input.byte() < 250 { fields[input.choice(fields.len())].clone() } else { word(&mut input) };
        let value = match input.byte() {
            0..=139 => Value::Number(input.number()),
            140..=199 => Value::List((0..input.choice(8)).map(|_| input.number()).collect()),
            200..=229 => known.get(&name).cloned().unwrap_or(Value::Number(1.0)),
            _ => Value::Word(word(&mut input)),
        };
        map.insert(name, value);
    }
    let mut filter = match build(method, &map, 1 + input.choice(3), precision) {
        Ok(filter) => filter,
        Err(refusal) => {
            assert!(!refusal.to_string().is_empty());
            return;
        }
    };
    let channels = filter.channels();
    for _ in 0..40 {
        let mut row: Vec<f64> = (0..channels).map(|_| input.number()).collect();
        let dt = if input.byte() < 200 { None } else { Some(input.number()) };
        filter.update(&mut row, dt);
        for (channel, rate) in row.iter().enumerate() {
            let last = filter.estimate(channel);
            let sound =
                rate.is_finite() && last.acceleration.is_finite() && last.variance >= 0.0 && last.variance.is_finite();
            assert!(sound, "{method} {precision:?} {map:?}: {last:?}");
        }
    }
    // With settings as far from any gyro as these a state may have overflowed inside: then it is refused, but never altered.
    match restore(&filter.save()) {
        Ok(twin) => assert_eq!(twin.save(), filter.save()),
        Err(refusal) => assert!(refusal.to_string().contains("none that a"), "{method}: {refusal}"),
    }
});
