//! C ABI of stillrate. Building this package builds the static library `libstillrate.a` beside the other build results;
//! `include/stillrate.h` declares what is in it. See `README.md`.

/// Where `stillrate.h` lies, for build scripts of programs that mix C and Rust.
///
/// # Example
/// ```
/// assert!(std::path::Path::new(stillrate_c::INCLUDE).join("stillrate.h").exists());
/// ```
pub const INCLUDE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/include");

/// Where `libstillrate.a` lies after this package was built.
pub const LIBRARY: &str = env!("STILLRATE_LIBRARY");
