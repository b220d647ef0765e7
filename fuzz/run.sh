#!/bin/sh
# Builds the fuzz targets with the address sanitizer and runs each for so many seconds (first argument, 60). More arguments name
# targets. Works with a stable compiler; says so and passes where a C++ compiler (of the fuzzer's own run time) is missing.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
seconds=${1:-60}
[ $# -gt 0 ] && shift
targets=${*:-"configuration restore steps c_abi differential"}
command -v c++ > /dev/null || { echo "skipped: no C++ compiler"; exit 0; }
coverage="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters
    -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares"
export RUSTC_BOOTSTRAP=1
export RUSTFLAGS="$(echo $coverage) -Ccodegen-units=8 --cfg fuzzing -Zsanitizer=address"
cd "$here"
cargo build --quiet --locked --release --target x86_64-unknown-linux-gnu --target-dir "$here/../target/fuzz"
for target in $targets; do
    work="$here/../target/fuzz/corpus/$target"
    mkdir -p "$work"
    echo "== $target"
    "$here/../target/fuzz/x86_64-unknown-linux-gnu/release/$target" -max_total_time="$seconds" -timeout=20 -max_len=2048 \
        -print_final_stats=1 -artifact_prefix="$work/../$target-" "$work" "$here/seeds/$target" \
        > "$work/../$target.log" 2>&1 || { tail -60 "$work/../$target.log"; exit 1; }
    grep -E "number_of_executed_units" "$work/../$target.log"
done
