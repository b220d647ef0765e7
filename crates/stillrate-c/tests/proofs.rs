//! The proofs prove something, and the examples work: a step that can panic is caught, the exported Rust source compiles and gives
//! its own samples, and both build files of the C example build it.

use std::path::{Path, PathBuf};
use std::process::Command;

use stillrate::{Filter, Sample};
use stillrate_lab::export::export;
use stillrate_lab::runner::Precision;
use stillrate_lab::settings_map::{SettingsMap, Value};

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("proofs").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn here() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn settings() -> SettingsMap {
    let number = |name: &str, value| (name.to_string(), Value::Number(value));
    SettingsMap::from([number("sample_rate_hz", 50.0), number("noise.density_dps_sqrt_hz", 0.0151)])
}

#[test]
fn a_step_that_can_panic_does_not_link() {
    let folder = folder("can_panic");
    let library = folder.join("libcan_panic.a");
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let built = Command::new(rustc)
        .env("NEVER", here().join("abi/src"))
        .args(["--edition=2024", "--crate-type=staticlib", "--crate-name=can_panic"])
        .args(["-Copt-level=3", "-Cpanic=abort", "-o"])
        .arg(&library)
        .arg(here().join("tests/can_panic.rs.txt"))
        .output()
        .expect("rustc runs");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let program = folder.join("main.c");
    std::fs::write(
        &program,
        "float stillrate_control_step(const float *, unsigned long);\n\
         int main(int n, char **v) { float t[4] = {0}; (void)v; return (int)stillrate_control_step(t, (unsigned long)n); }\n",
    )
    .unwrap();
    let linked = Command::new("cc").arg(&program).arg(&library).arg("-o").arg(folder.join("main")).output().unwrap();
    let said = String::from_utf8_lossy(&linked.stderr);
    assert!(!linked.status.success() && said.contains("stillrate_a_step_can_panic"), "{said}");
}

/// The exported Rust source of three filters, compiled.
macro_rules! exported {
    ($($module:ident $method:literal $precision:ident $file:literal;)*) => { $(
        mod $module {
            #![allow(unreachable_pub, clippy::approx_constant, reason = "generated")]
            include!(concat!("exported/", $file));

            #[test]
            fn exported_source_compiles_and_is_the_configuration() {
                let files = super::export($method, &super::settings(), super::Precision::$precision).unwrap();
                let path = super::here().join("tests/exported").join($file);
                if std::env::var_os("STILLRATE_UPDATE").is_some() {
                    std::fs::write(&path, &files.config_rs).unwrap();
                }
                let committed = std::fs::read_to_string(path).unwrap();
                assert!(committed == files.config_rs, "run this test with STILLRATE_UPDATE=1");
                let mut state = STILLRATE_CONFIG.start();
                let mut built = super::runner($method, super::Precision::$precision);
                for k in 0..200_u32 {
                    let value = f64::from(k % 17) - 8.0;
                    let sample = super::Sample { value: value as _, dt: STILLRATE_CONFIG.period() };
                    let mut row = [value];
                    built.update(&mut row, None);
                    assert_eq!(super::widen(STILLRATE_CONFIG.step(&mut state, sample).rate), row[0]);
                }
            }
            use super::Filter as _;
        }
    )* };
}

fn runner(method: &str, precision: Precision) -> Box<dyn stillrate_lab::runner::Runner> {
    stillrate_lab::runner::build(method, &settings(), 1, precision).unwrap()
}

fn widen<T: stillrate::Real>(number: T) -> f64 {
    number.widen()
}

exported! {
    pt1 "pt1" Double "pt1_f64.rs";
    singer_imm_kf "singer-imm-kf" Single "singer_imm_kf_f32.rs";
    ms_imm_ikf "ms-imm-ikf" Double "ms_imm_ikf_f64.rs";
}

/// What `export-c` writes for the filter that the example's build files name.
fn exported_for_c(folder: &Path) -> PathBuf {
    let files = export("ms-imm-ikf", &settings(), Precision::Single).unwrap();
    let out = folder.join("export");
    std::fs::create_dir_all(&out).unwrap();
    std::fs::write(out.join("stillrate_config.h"), files.config_h).unwrap();
    std::fs::write(out.join("stillrate_selftest.h"), files.selftest_h).unwrap();
    std::fs::copy(Path::new(stillrate_c::INCLUDE).join("stillrate.h"), out.join("stillrate.h")).unwrap();
    out
}

fn works(mut command: Command) {
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {said}");
}

#[test]
fn the_example_builds_with_make_and_passes_its_self_test() {
    if Command::new("make").arg("--version").output().is_err() {
        println!("skipped: no make");
        return;
    }
    let folder = folder("make");
    let export = exported_for_c(&folder);
    for file in ["main.c", "Makefile"] {
        std::fs::copy(here().join("example").join(file), folder.join(file)).unwrap();
    }
    let mut make = Command::new("make");
    make.arg("-C").arg(&folder).arg("-B").arg(format!("EXPORT={}", export.display()));
    make.arg("-o").arg(stillrate_c::LIBRARY).arg(format!("LIBRARY={}", stillrate_c::LIBRARY));
    works(make);
    let mut run = Command::new(folder.join("clean_rates"));
    run.stdin(std::process::Stdio::null());
    works(run);
}

#[test]
fn the_example_builds_with_cmake_and_passes_its_self_test() {
    if Command::new("cmake").arg("--version").output().is_err() {
        println!("skipped: no cmake");
        return;
    }
    let folder = folder("cmake");
    let export = exported_for_c(&folder);
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(here().join("example")).arg("-B").arg(folder.join("build"));
    configure.arg(format!("-DEXPORT={}", export.display())).arg(format!("-DLIBRARY={}", stillrate_c::LIBRARY));
    works(configure);
    let mut build = Command::new("cmake");
    build.arg("--build").arg(folder.join("build"));
    works(build);
    let mut run = Command::new(folder.join("build/clean_rates"));
    run.stdin(std::process::Stdio::null());
    works(run);
}
