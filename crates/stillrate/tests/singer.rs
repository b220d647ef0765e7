//! Singer's closed forms against 80 digits (`tables/singer.txt`) and against the project's 40-digit reference.

use stillrate::Real;
use stillrate::models::{SingerCoefficients, singer_derivatives};

const NAMES: [&str; 7] = ["r", "s", "q11", "q12", "q22", "r'", "s'"];
/// What the module promises, relative.
const PROMISED_DOUBLE: f64 = 5e-16;
const PROMISED_SINGLE: f64 = 3e-7;

fn forms<T: Real>(alpha: f64, dt: f64) -> [f64; 7] {
    let c = SingerCoefficients::new(T::of(alpha), T::of(dt));
    let (slope_r, slope_s) = singer_derivatives(T::of(alpha), T::of(dt));
    [c.r, c.s, c.q11, c.q12, c.q22, slope_r, slope_s].map(Real::widen)
}

/// Worst relative error of each form over a table, and the x = alpha T where it is.
fn worst_of<T: Real>(table: &str) -> [(f64, f64); 7] {
    let mut worst = [(0.0, 0.0); 7];
    for line in table.lines().filter(|line| !line.starts_with('#')) {
        let mut fields = line.split(' ');
        let mut bits = || f64::from_bits(u64::from_str_radix(fields.next().unwrap(), 16).unwrap());
        let (alpha, dt) = (bits(), bits());
        if T::of(alpha).widen() != alpha || T::of(dt).widen() != dt {
            continue;
        }
        for (result, worst) in forms::<T>(alpha, dt).into_iter().zip(&mut worst) {
            let near = f64::from_bits(u64::from_str_radix(fields.next().unwrap(), 16).unwrap());
            let unit = libm::scalbn(1.0, libm::ilogb(near) - 52);
            let rest = fields.next().unwrap().parse::<f64>().unwrap() / 1000.0 * unit;
            let error = ((result - near - rest) / near).abs();
            if error > worst.0 || error.is_nan() {
                *worst = (error, alpha * dt);
            }
        }
    }
    worst
}

fn check<T: Real>(table: &str, promised: f64) {
    for (name, (error, x)) in NAMES.into_iter().zip(worst_of::<T>(table)) {
        println!("{name}: {error:.3e} at alpha T = {x:e}");
        assert!(error > 0.0 && error <= promised, "{name} is off by {error:e} at alpha T = {x:e}");
    }
}

#[test]
fn closed_forms_match_eighty_digits_in_double_precision() {
    check::<f64>(include_str!("tables/singer.txt"), PROMISED_DOUBLE);
}

#[test]
fn closed_forms_match_eighty_digits_in_single_precision() {
    check::<f32>(include_str!("tables/singer.txt"), PROMISED_SINGLE);
}

/// `python singer.py SEED COUNT > FILE; STILLRATE_SINGER_TABLE=FILE cargo test --test singer -- --ignored`
#[test]
#[ignore = "needs a table named by STILLRATE_SINGER_TABLE"]
fn closed_forms_match_a_table_of_any_size() {
    let table = std::fs::read_to_string(std::env::var("STILLRATE_SINGER_TABLE").expect("a path")).unwrap();
    check::<f64>(&table, PROMISED_DOUBLE);
    check::<f32>(&table, PROMISED_SINGLE);
}

/// The first 36 significant digits of a decimal number as an integer, and the power of ten of its last digit.
fn digits(text: &str) -> (i128, i32) {
    let (number, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
    let mut power = exponent.parse::<i32>().unwrap() - fraction.len() as i32;
    let mut all = format!("{whole}{fraction}");
    all = all.trim_start_matches('0').to_string();
    while all.len() < 36 {
        all.push('0');
        power -= 1;
    }
    power += all.len() as i32 - 36;
    (all[..36].parse().unwrap(), power)
}

/// (result - reference) / reference, with both taken to 36 digits.
fn relative_error(result: f64, reference: &str) -> f64 {
    let (mut ours, our_power) = digits(&format!("{result:.50e}"));
    let (mut theirs, their_power) = digits(reference);
    match our_power - their_power {
        0 => {}
        1 => theirs /= 10,
        -1 => ours /= 10,
        _ => return f64::INFINITY,
    }
    ((ours - theirs) as f64 / theirs as f64).abs()
}

/// The text of a field of one JSON object.
fn field<'a>(object: &'a str, name: &str) -> &'a str {
    let at = object.find(&format!("\"{name}\": ")).unwrap() + name.len() + 4;
    object[at..].split([',', '}']).next().unwrap().trim_matches('"')
}

#[test]
fn closed_forms_match_the_forty_digit_reference() {
    let file = include_str!("../../../tests/reference/filters/singer_closed_forms_40digits.json");
    let mut compared = 0;
    for object in file.split('{').skip(1) {
        let (alpha, dt) = (field(object, "alpha").parse().unwrap(), field(object, "T").parse().unwrap());
        for (name, result) in NAMES.into_iter().zip(forms::<f64>(alpha, dt)).take(5) {
            let error = relative_error(result, field(object, name));
            // The file was computed for alpha = aT / T before alpha was rounded; e^-x turns that half unit into x half units.
            let x = if name == "s" { field(object, "aT").parse().unwrap() } else { 0.0 };
            assert!(
                error <= PROMISED_DOUBLE + x * f64::EPSILON / 2.0,
                "{name} is off by {error:e} for alpha {alpha}, T {dt}"
            );
            compared += 1;
        }
    }
    assert!(compared >= 200, "only {compared} figures found");
}

#[test]
fn without_decay_the_model_is_constant_acceleration() {
    let c = SingerCoefficients::<f64>::new(0.0, 2.0);
    assert_eq!(forms::<f64>(0.0, 2.0), [2.0, 1.0, 8.0 / 3.0, 2.0, 2.0, -2.0, -2.0]);
    assert_eq!(SingerCoefficients::<f64>::new(0.0, 0.0).q11, 0.0);
    assert!(c.q11 * c.q22 > c.q12 * c.q12);
}

#[test]
fn absurd_arguments_give_no_nan() {
    for alpha in [0.0, 1e-300, 1.0, 1e150, 1e300, f64::MAX] {
        for dt in [0.0, 1e-300, 1.0, 1e100] {
            let all = forms::<f64>(alpha, dt);
            assert!(all.iter().all(|number| !number.is_nan()), "{alpha:e} {dt:e} {all:?}");
        }
    }
}
