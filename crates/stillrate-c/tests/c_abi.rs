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
const SAMPLES: usize = 10_000;

fn settings() -> SettingsMap {
    let number = |name: &str, value| (name.to_string(), Value::Number(value));
    SettingsMap::from([number("sample_rate_hz", 50.0), number("noise.density_dps_sqrt_hz", 0.0151)])
}

/// A log with motion, noise, missing samples, spikes, repeated stamps and gaps.
fn log() -> Vec<(f64, f64)> {
    let mut bits = 1_u64;
    (0..SAMPLES)
        .map(|k| {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let noise = (bits >> 40) as f64 / f64::from(1 << 24) - 0.5;
            let swing = if k % 3000 > 1000 { 30.0 * (0.07 * k as f64).sine_cosine().0 } else { 0.0 };
            match k % 1009 {
                500 => (f64::NAN, 0.02),
                600 => (1e4, 0.02),
                700 => (swing + noise, 0.0),
                800 => (swing + noise, 0.137),
                900 if k > 9000 => (swing + noise, 11.0),
                _ => (swing + noise, 0.02),
            }
        })
        .collect()
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Bytes that the C program must print for the log.
fn expected<S: Settings, T: Real>(samples: &[(f64, f64)]) -> (Vec<u8>, Vec<u8>) {
    let filter = stillrate_lab::settings_map::from_map::<S>(&settings()).unwrap().build::<T>().unwrap();
    let mut state = filter.start();
    let (mut input, mut output) = (Vec::new(), Vec::new());
    for &(value, dt) in samples {
        let sample = Sample { value: T::of(value), dt: T::of(dt) };
        let estimate = filter.step(&mut state, sample);
        input.extend_from_slice(&sample.value.to_little_endian()[..T::BYTES]);
        input.extend_from_slice(&sample.dt.to_little_endian()[..T::BYTES]);
        output.extend_from_slice(&estimate.rate.to_little_endian()[..T::BYTES]);
        output.extend_from_slice(&estimate.flags.0.to_le_bytes());
    }
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

fn replays<S: Settings, T: Real>() {
    let (suffix, real, precision) =
        if T::BYTES == 4 { ("f32", "float", Precision::Single) } else { ("f64", "double", Precision::Double) };
    let name = format!("stillrate_{}_{suffix}", S::METHOD.replace('-', "_"));
    let folder = folder(&name);
    let files = export(S::METHOD, &settings(), precision).unwrap();
    std::fs::write(folder.join("stillrate_config.h"), files.config_h).unwrap();
    std::fs::write(folder.join("stillrate_selftest.h"), files.selftest_h).unwrap();
    let program = compile(&folder, &name, real);
    let (input, output) = expected::<S, T>(&log());
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
        fn replays_a_log_from_c_to_the_same_bits() {
            super::replays::<stillrate::filters::$name, f32>();
            super::replays::<stillrate::filters::$name, f64>();
        }
    } )* };
}
stillrate::methods!(every_method);

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
