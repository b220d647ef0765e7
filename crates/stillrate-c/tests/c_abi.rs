//! The C library from outside: header and function list are those of the sources, C programs compile without a warning and
//! give the bits of Rust, and the library needs nothing but `memcpy` and the like.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use stillrate::{Filter, Real, Sample, Settings};
use stillrate_lab::export::{c_functions, c_header, export};
use stillrate_lab::runner::{Precision, build, method_names};
use stillrate_lab::settings_map::{SettingsMap, Value};

/// Samples of the replayed log.
const SAMPLES: usize = 10_240;

fn settings() -> SettingsMap {
    let number = |name: &str, value| (name.to_string(), Value::Number(value));
    SettingsMap::from([number("sample_rate_hz", 50.0), number("noise.density_dps_sqrt_hz", 0.0151)])
}

/// The log of `tests/embedded/unit.c`: motion, noise, missing samples, spikes, repeated stamps and gaps.
fn log<T: Real>(period_s: T) -> Vec<Sample<T>> {
    (0..SAMPLES as u32)
        .map(|k| {
            let mut bits = (k + 1).wrapping_mul(2_654_435_761);
            bits ^= bits >> 15;
            let noise = (f64::from(bits & 1023) - 512.0) / 1024.0;
            let swing = if (k / 512) % 2 == 1 { f64::from(k % 512) * 0.125 } else { 0.0 };
            let value = match (k % 509, k % 1531) {
                (_, 1000) => 16_384.0,
                (300, _) => f64::NAN,
                _ => noise + swing,
            };
            let dt = match (k % 701, k % 811, k) {
                (400, _, _) => T::ZERO,
                (_, 500, _) => T::of(2.5) * period_s,
                (_, _, 7000) => T::of(11.0),
                _ => period_s,
            };
            Sample { value: T::of(value), dt }
        })
        .collect()
}

/// FNV-1a, as in `tests/embedded/unit.c`.
fn sum(words: impl Iterator<Item = u32>) -> u32 {
    words.fold(2_166_136_261, |sum, word| (sum ^ word).wrapping_mul(16_777_619))
}

/// The line of `tests/embedded/bits.txt` for a filter: what every language and machine must find.
fn committed(name: &str) -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/embedded/bits.txt");
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().find(|line| line.split(' ').next() == Some(name)).map(str::to_string)
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Bytes that the C program must print for the log.
fn expected<S: Settings, T: Real>(name: &str, settings: &SettingsMap) -> (Vec<u8>, Vec<u8>) {
    let filter = stillrate_lab::settings_map::from_map::<S>(settings).unwrap().build::<T>().unwrap();
    let mut state = filter.start();
    let (mut input, mut output, mut rates, mut flags) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for sample in log(filter.period()) {
        let estimate = filter.step(&mut state, sample);
        input.extend_from_slice(&sample.value.to_little_endian()[..T::BYTES]);
        input.extend_from_slice(&sample.dt.to_little_endian()[..T::BYTES]);
        rates.extend_from_slice(&estimate.rate.to_little_endian()[..T::BYTES]);
        output.extend_from_slice(&estimate.rate.to_little_endian()[..T::BYTES]);
        output.extend_from_slice(&estimate.flags.0.to_le_bytes());
        flags.push(estimate.flags.0);
    }
    let rates = sum(rates.into_iter().map(u32::from));
    let found = format!("{name} 0 {rates:08x} {:08x}", sum(flags.into_iter()));
    assert_eq!(Some(found), committed(name), "run `sh tests/embedded/run.sh --update` if the bits are meant to change");
    (input, output)
}

fn compile(folder: &Path, name: &str, real: &str) -> PathBuf {
    let program = folder.join("replay");
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let output = Command::new("cc")
        .args(["-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-pedantic"])
        .arg(format!("-DFILTER={name}"))
        .arg(format!("-DREAL={real}"))
        .arg(format!("-I{}", stillrate_c::INCLUDE))
        .arg(format!("-I{}", folder.display()))
        .arg(here.join("tests/replay.c"))
        .arg(stillrate_c::LIBRARY)
        .arg("-o")
        .arg(&program)
        .output()
        .expect("a C compiler runs");
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    program
}

/// `form` tells another configuration of the same filter from the default one.
fn replays<S: Settings, T: Real>(form: &str, settings: &SettingsMap) {
    let (suffix, real, precision) =
        if T::BYTES == 4 { ("f32", "float", Precision::Single) } else { ("f64", "double", Precision::Double) };
    let function = format!("stillrate_{}_{suffix}", S::METHOD.replace('-', "_"));
    let name = format!("stillrate_{}{form}_{suffix}", S::METHOD.replace('-', "_"));
    let folder = folder(&name);
    let files = export(S::METHOD, settings, precision).unwrap();
    std::fs::write(folder.join("stillrate_config.h"), files.config_h).unwrap();
    std::fs::write(folder.join("stillrate_selftest.h"), files.selftest_h).unwrap();
    let program = compile(&folder, &function, real);
    let (input, output) = expected::<S, T>(&name, settings);
    let mut running = Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut pipe = running.stdin.take().unwrap();
    let feeder = std::thread::spawn(move || pipe.write_all(&input).unwrap());
    let result = running.wait_with_output().unwrap();
    feeder.join().unwrap();
    assert!(result.status.success(), "{name}");
    assert_eq!(result.stdout.len(), SAMPLES * (T::BYTES + 4), "{name}");
    assert!(result.stdout == output, "{name}: C and Rust differ");
}

macro_rules! every_method {
    ($($name:ident),* $(,)?) => { $( #[allow(non_snake_case)] mod $name {
        #[test]
        fn replays_a_log_from_c_to_the_same_bits_in_single_precision() {
            super::replays::<stillrate::filters::$name, f32>("", &super::settings());
        }

        #[test]
        fn replays_a_log_from_c_to_the_same_bits_in_double_precision() {
            super::replays::<stillrate::filters::$name, f64>("", &super::settings());
        }
    } )* };
}
stillrate::methods!(every_method);

fn light_bank() -> SettingsMap {
    let mut light = settings();
    light.insert("oscillators".into(), Value::List(Vec::new()));
    light
}

#[test]
fn light_bank_replays_a_log_from_c_to_the_same_bits_in_single_precision() {
    replays::<stillrate::filters::MsImmIkfSettings, f32>("_light", &light_bank());
}

#[test]
fn light_bank_replays_a_log_from_c_to_the_same_bits_in_double_precision() {
    replays::<stillrate::filters::MsImmIkfSettings, f64>("_light", &light_bank());
}

#[test]
fn header_and_function_list_are_those_of_the_sources() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let hint = "run `cargo run -p stillrate-lab --example c_header`";
    assert!(std::fs::read_to_string(here.join("include/stillrate.h")).unwrap() == c_header(), "{hint}");
    assert!(std::fs::read_to_string(here.join("abi/src/functions.rs")).unwrap() == c_functions(), "{hint}");
}

#[test]
fn no_step_can_panic_or_allocate_and_the_library_imports_only_memory_functions() {
    let output = Command::new("nm").arg(stillrate_c::LIBRARY).output().expect("nm runs");
    let text = String::from_utf8_lossy(&output.stdout);
    // The archive also carries the compiler's own run-time library, of which nothing but what a target needs is ever linked.
    let mut ours = false;
    let mut symbols: Vec<(&str, &str)> = Vec::new();
    for line in text.lines() {
        if let Some(object) = line.strip_suffix(':') {
            ours = object.starts_with("stillrate_abi");
        } else if let Some((left, name)) = line.rsplit_once(' ').filter(|_| ours) {
            symbols.push((&left[left.len() - 1..], name));
        }
    }
    let functions = symbols.iter().filter(|(kind, name)| *kind == "T" && name.starts_with("stillrate_")).count();
    assert_eq!(functions, 8 * method_names().len());
    for (kind, name) in symbols {
        assert!(!name.contains("panic") && !name.contains("alloc"), "{name}");
        // The panic handler calls this one, which is defined nowhere: it is there only if a panic can be reached.
        assert_ne!(name, "stillrate_a_step_can_panic");
        if kind == "U" {
            let known = ["memcpy", "memmove", "memset", "memcmp", "bcmp", "_GLOBAL_OFFSET_TABLE_"];
            assert!(known.contains(&name), "the library imports {name}");
        }
        assert!(!["B", "b", "D", "d", "C"].contains(&kind), "global variable {name}");
    }
}

#[test]
fn an_unknown_method_is_refused_before_anything_is_written() {
    assert!(export("ptl", &settings(), Precision::Double).unwrap_err().to_string().contains("pt1"));
    assert!(build("pt1", &settings(), 1, Precision::Single).is_ok());
}
