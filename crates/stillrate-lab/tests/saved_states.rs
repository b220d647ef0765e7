//! A saved filter of every method and precision: what is cut off, flipped, of another version, of another filter or made up is refused
//! with a sentence.

use stillrate::Real;
use stillrate_lab::runner::{Precision, Runner, build, method_names, restore};
use stillrate_lab::saved::{self, Saved, crc32};
use stillrate_lab::settings_map::{SettingsMap, Value};

fn every_filter(check: impl Fn(&dyn Runner)) {
    for method in method_names() {
        for precision in [Precision::Single, Precision::Double] {
            let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
            let mut filter = build(method, &settings, 2, precision).unwrap();
            for k in 0..100 {
                let swing = (0.1 * f64::from(k)).sine_cosine().0;
                filter.update(&mut [0.1 * swing, if k % 9 == 0 { f64::NAN } else { 2.0 * swing }], None);
            }
            check(&*filter);
        }
    }
}

fn refused(bytes: &[u8], what: &dyn Fn() -> String) {
    match restore(bytes) {
        Ok(_) => panic!("{} was restored", what()),
        Err(refusal) => assert!(refusal.to_string().len() > 20, "{}: {refusal}", what()),
    }
}

/// The bytes with the checksum that their maker would have written.
fn signed(mut bytes: Vec<u8>) -> Vec<u8> {
    let body = bytes.len() - 4;
    let sum = crc32(&bytes[..body]);
    bytes[body..].copy_from_slice(&sum.to_le_bytes());
    bytes
}

/// The file again, with its numbers changed.
fn rewritten(good: &Saved, change: impl Fn(&mut Saved)) -> Vec<u8> {
    let mut saved = good.clone();
    change(&mut saved);
    let numbers = &saved.numbers;
    match saved.precision {
        Precision::Single => {
            let single: Vec<f32> = numbers.iter().map(|&number| f32::of(number)).collect();
            saved::write(&saved.method, &saved.settings, saved.channels, &single)
        }
        Precision::Double => saved::write(&saved.method, &saved.settings, saved.channels, numbers),
    }
}

#[test]
fn what_was_saved_is_restored_to_the_bit() {
    every_filter(|filter| {
        let bytes = filter.save();
        assert_eq!(restore(&bytes).unwrap().save(), bytes, "{}", filter.method());
        assert_eq!(rewritten(&saved::read(&bytes).unwrap(), |_| {}), bytes);
    });
}

#[test]
fn a_state_that_is_cut_off_is_refused_wherever_it_ends() {
    every_filter(|filter| {
        let good = filter.save();
        for end in 0..good.len() {
            refused(&good[..end], &|| format!("{} cut at {end}", filter.method()));
        }
        let body = good.len() - 4;
        for end in (12..body).step_by(17) {
            let cut = signed([&good[..end], &[0; 4]].concat());
            refused(&cut, &|| format!("{} cut at {end} with a right checksum", filter.method()));
        }
    });
}

#[test]
fn a_state_with_a_flipped_bit_is_refused() {
    every_filter(|filter| {
        let good = filter.save();
        for byte in 0..good.len() {
            let mut bad = good.clone();
            bad[byte] ^= 1 << (byte % 8);
            refused(&bad, &|| format!("{} with byte {byte} flipped", filter.method()));
        }
    });
}

#[test]
fn a_state_of_another_version_is_refused() {
    every_filter(|filter| {
        let mut other = filter.save();
        other[8] = 2;
        let refusal = restore(&signed(other)).err().expect("refused").to_string();
        assert!(refusal.contains("version 2") && refusal.contains("version 1"), "{refusal}");
    });
}

#[test]
fn a_state_of_another_filter_is_refused() {
    every_filter(|filter| {
        let good = saved::read(&filter.save()).unwrap();
        for other in method_names().into_iter().filter(|name| *name != filter.method()) {
            let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
            let own_settings = rewritten(&good, |saved| saved.method = other.into());
            refused(&own_settings, &|| format!("{} as {other}", filter.method()));
            // States of one size can be told apart by their settings only, which come with them.
            if !same_size(other, filter) {
                let neutral = rewritten(&good, |saved| {
                    saved.method = other.into();
                    saved.settings = settings.clone();
                });
                refused(&neutral, &|| format!("{} as {other} with neutral settings", filter.method()));
            }
        }
    });
}

/// Whether two methods keep as many numbers.
fn same_size(other: &str, filter: &dyn Runner) -> bool {
    let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
    let other = build(other, &settings, 2, filter.precision()).unwrap().save();
    saved::read(&other).unwrap().numbers.len() == saved::read(&filter.save()).unwrap().numbers.len()
}

#[test]
fn a_state_that_is_not_finite_is_refused_whichever_number_it_is() {
    every_filter(|filter| {
        let good = saved::read(&filter.save()).unwrap();
        let estimates = 2 * (5 + filter.models());
        for at in 0..good.numbers.len() {
            // The frequency of methods without one is NaN in the estimate.
            let frequency =
                at >= good.numbers.len() - estimates && (at - (good.numbers.len() - estimates)) % (estimates / 2) == 3;
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                if !(frequency && bad.is_nan()) {
                    let bytes = rewritten(&good, |saved| saved.numbers[at] = bad);
                    refused(&bytes, &|| format!("{} with number {at} = {bad}", filter.method()));
                }
            }
        }
    });
}

/// Place of a number in the state of a method that cannot be below zero: a variance, a weight or a time.
fn never_negative(method: &str) -> Option<usize> {
    Some(match method {
        "singer-kf" | "singer-imm-kf" | "ms-imm-ikf" | "sage-husa-kf" => 2,
        "ms-imm-ikf-paper" | "one-euro" => 3,
        "ar-kf" => 8,
        "hmm-kf" | "hmm-rls" | "cusum-forgetting" | "variable-forgetting" => 1,
        "fir" | "pt1" | "biquad" | "linear-prediction" => return None,
        other => panic!("which number of {other} is a variance?"),
    })
}

#[test]
fn a_negative_variance_or_weight_and_an_absurd_size_are_refused() {
    every_filter(|filter| {
        let good = saved::read(&filter.save()).unwrap();
        if let Some(at) = never_negative(filter.method()) {
            assert!(good.numbers[at] > 0.0 || filter.method() == "one-euro", "{}", filter.method());
            let bytes = rewritten(&good, |saved| saved.numbers[at] = -1.0);
            refused(&bytes, &|| format!("{} with number {at} negative", filter.method()));
        }
        let absurd = if filter.precision() == Precision::Single { 3e38 } else { 1e308 };
        let bytes = rewritten(&good, |saved| saved.numbers.iter_mut().for_each(|number| *number = absurd));
        refused(&bytes, &|| format!("{} of absurd numbers", filter.method()));
        let bytes = rewritten(&good, |saved| saved.channels = 1 << 20);
        refused(&bytes, &|| format!("{} of a million channels", filter.method()));
    });
}

#[test]
fn settings_out_of_range_or_unknown_are_refused_in_a_saved_state_too() {
    every_filter(|filter| {
        let good = saved::read(&filter.save()).unwrap();
        for (name, value) in &good.settings {
            let absurd = match value {
                Value::Number(_) => Value::Number(1e300),
                Value::List(list) => Value::List(vec![1e300; list.len().max(1)]),
                Value::Word(_) => Value::Word("nothing".into()),
            };
            let bytes = rewritten(&good, |saved| {
                saved.settings.insert(name.clone(), absurd.clone());
            });
            refused(&bytes, &|| format!("{} with an absurd {name}", filter.method()));
        }
        let bytes = rewritten(&good, |saved| {
            saved.settings.insert("cutof".into(), Value::Number(1.0));
        });
        refused(&bytes, &|| format!("{} with an unknown setting", filter.method()));
    });
}
