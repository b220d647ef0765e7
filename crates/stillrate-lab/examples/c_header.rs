//! Writes `stillrate.h` and the list of C functions anew: `cargo run -p stillrate-lab --example c_header`.

use std::path::Path;

fn main() -> std::io::Result<()> {
    let home = Path::new(env!("CARGO_MANIFEST_DIR")).join("../stillrate-c");
    std::fs::write(home.join("include/stillrate.h"), stillrate_lab::export::c_header())?;
    std::fs::write(home.join("abi/src/functions.rs"), stillrate_lab::export::c_functions())
}
