//! Builds the static library in `abi` with a profile of its own (one unit, link-time optimised, aborting) and puts it where
//! C programs look for it: `libstillrate.a` beside the other results of this profile.
//!
//! A static library without the standard library needs a panic handler and `panic = "abort"`, neither of which
//! a member of this workspace can have.

use std::path::PathBuf;
use std::process::Command;
use std::{env, fs};

fn main() {
    let variable = |name: &str| env::var(name).unwrap_or_else(|_| panic!("{name} is set by cargo"));
    let (out, root) = (PathBuf::from(variable("OUT_DIR")), PathBuf::from(variable("CARGO_MANIFEST_DIR")));
    for path in ["abi/src", "abi/Cargo.toml", "../stillrate/src", "../stillrate/Cargo.toml"] {
        println!("cargo::rerun-if-changed={path}");
    }
    let (host, target) = (variable("HOST"), variable("TARGET"));
    let mut build = Command::new(variable("CARGO"));
    build.args(["build", "--release", "--quiet", "--locked", "--manifest-path"]).arg(root.join("abi/Cargo.toml"));
    build.arg("--target-dir").arg(out.join("abi"));
    if target != host {
        build.args(["--target", &target]);
    }
    // The outer build's flags may unwind or instrument; this library is the same whatever they are.
    build.env_remove("CARGO_ENCODED_RUSTFLAGS").env_remove("RUSTFLAGS");
    let status = build.status().expect("cargo runs");
    assert!(status.success(), "the C library does not build");
    let built = out.join("abi").join(if target == host { "release".into() } else { format!("{target}/release") });
    // OUT_DIR is <profile>/build/<package>/out.
    let profile = out.ancestors().nth(3).expect("OUT_DIR lies in the profile's folder").to_path_buf();
    fs::copy(built.join("libstillrate_abi.a"), profile.join("libstillrate.a")).expect("the library can be copied");
    println!("cargo::rustc-env=STILLRATE_LIBRARY={}", profile.join("libstillrate.a").display());
}
