//! A memory in seconds or as a factor a sample: settings by name take either, or both in agreement.

use stillrate::filters::RecursiveLeastSquaresSettings;
use stillrate_lab::settings_map::{SettingsMap, Value, from_map};

fn settings(named: &[(&str, f64)]) -> Result<RecursiveLeastSquaresSettings, String> {
    let mut map: SettingsMap = named.iter().map(|(name, x)| ((*name).to_owned(), Value::Number(*x))).collect();
    map.insert("sample_rate_hz".into(), Value::Number(1000.0));
    from_map(&map).map_err(|error| error.to_string())
}

#[test]
fn either_decides_over_the_default_of_the_other() {
    assert!((settings(&[("forgetting_factor", 0.9)]).unwrap().tau_s - 0.009_491).abs() < 1e-6);
    assert!((settings(&[("tau_s", 2.0)]).unwrap().forgetting_factor - 0.999_500).abs() < 1e-6);
}

#[test]
fn both_in_agreement_are_taken() {
    // tau_s is the default here, the factor is rounded to nine digits.
    for both in
        [[("tau_s", 0.1), ("forgetting_factor", 0.990_049_834)], [("tau_s", f64::INFINITY), ("forgetting_factor", 1.0)]]
    {
        assert!(settings(&both).is_ok(), "{both:?}");
    }
}

#[test]
fn a_contradiction_is_refused_even_with_the_default_of_either() {
    for both in [
        [("tau_s", 2.0), ("forgetting_factor", 0.9)],
        [("tau_s", 0.1), ("forgetting_factor", 0.9)],
        [("tau_s", 3.0), ("forgetting_factor", (-0.01_f64).exp())],
    ] {
        let error = settings(&both).unwrap_err();
        assert!(error.contains("forgetting_factor = ") && error.contains("give one of the two"), "{error}");
    }
}
