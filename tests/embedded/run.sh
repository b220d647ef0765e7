#!/bin/sh
# Cross-builds the C library, runs every filter on an emulated Cortex-M4F (doubles in software), M7 (doubles in hardware) and a
# 64-bit Arm and compares the bits with the desk; prints the table of README.md. Exits with 0 and a remark where the tools cannot
# be had. Configurations come from `cargo test -p stillrate-c`. `--update` takes the desk's bits as what everyone must find, and
# writes the table.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
sh "$here/toolchain.sh" || { echo "skipped: no Arm tools"; exit 0; }
tools="$root/target/embedded/toolchain"
work="$root/target/embedded/run"
libraries="$tools/usr/lib/x86_64-linux-gnu:$tools/usr/lib:$tools/lib/x86_64-linux-gnu"
rm -rf "$work" && mkdir -p "$work"
# With --update the table is not yet what the tests ask for.
(cd "$root" && cargo test --quiet -p stillrate-c --test c_abi > "$work/tests.txt" 2>&1) || [ "${1:-}" = --update ] || { cat "$work/tests.txt"; exit 1; }
names="harness_f32 harness_f64 $(cd "$root/target/tmp" && ls -d stillrate_*_f32 stillrate_*_f64)"
{
    for name in $names; do echo "extern const struct unit ${name}_unit;"; done
    echo "static const struct unit *const UNITS[] = {"
    for name in $names; do echo "    &${name}_unit,"; done
    echo "};"
} > "$work/units.h"

# Flags of the C compiler for one unit.
unit_flags() {
    case $1 in *_f32) real=float ;; *) real=double ;; esac
    period=period_s
    case $1 in *hmm_rls*) period=mean.period_s ;; harness*) printf '%s ' -DHARNESS ;; esac
    printf '%s ' -std=c99 -O2 -ffp-contract=off -Wall -Wextra -Werror "-DNAME=$1" "-DFILTER=$(echo "$1" | sed s/_light//)" "-DREAL=$real" \
        "-DUNIT_PERIOD=$period" "-I$here" "-I$work" "-I$root/crates/stillrate-c/include" "-I$root/target/tmp/$1"
}

for name in $names; do cc $(unit_flags "$name") -c "$here/unit.c" -o "$work/$name.desk.o"; done
cc -I"$here" -I"$work" "$here/desk.c" "$work"/*.desk.o "$root/target/debug/libstillrate.a" -o "$work/desk"
"$work/desk" > "$work/desk.txt"
if [ "${1:-}" = --update ]; then grep -v '^harness' "$work/desk.txt" > "$here/bits.txt"; fi
grep -v '^harness' "$work/desk.txt" | diff - "$here/bits.txt" \
    || { echo "the desk's bits are not those of bits.txt (run with --update if that is meant)"; exit 1; }

# The library for a processor: name, target, optimisation level, the Rust compiler's options.
build_for() {
    (cd "$root/crates/stillrate-c/abi" && CARGO_PROFILE_RELEASE_OPT_LEVEL="$3" RUSTC="$tools/usr/bin/rustc" RUSTC_BOOTSTRAP=1 RUSTFLAGS="$4" \
        LD_LIBRARY_PATH="$libraries" cargo build --quiet --locked --release -Zbuild-std=core --features core-sqrt \
        --target "$2" --target-dir "$root/target/embedded/abi-$1")
    library="$root/target/embedded/abi-$1/$2/release/libstillrate_abi.a"
}

# What a processor said, name first, against the desk.
compare() {
    diff "$2" "$work/desk.txt" > "$work/$1/bits.diff" || { echo "$1: bits differ from the desk"; cat "$work/$1/bits.diff"; exit 1; }
    echo "$1: the bits of the desk in $(wc -l < "$here/bits.txt") configurations"
}

# One microcontroller: name, emulated machine, the C compiler's options, the Rust compiler's.
run_on() {
    out="$work/$1"
    mkdir -p "$out"
    # Level 2: the compiler's level 3 copies tails of the steps for nothing on a processor without caches.
    build_for "$1" thumbv7em-none-eabihf 2 "$4"
    arm="$tools/usr/bin/arm-none-eabi-gcc -mthumb -mfloat-abi=hard $3"
    for name in $names; do
        LD_LIBRARY_PATH="$libraries" $arm -isystem "$here/include" $(unit_flags "$name") -ffreestanding -c "$here/unit.c" -o "$out/$name.o"
    done
    LD_LIBRARY_PATH="$libraries" $arm -O2 -ffreestanding -fno-builtin -fno-tree-loop-distribute-patterns -nostdlib \
        -I"$here" -I"$work" -T "$here/link.ld" -Wl,--gc-sections,-z,noexecstack,--no-warn-rwx-segments \
        "$here/firmware.c" "$out"/*.o "$library" -lgcc -o "$out/firmware.elf"
    LD_LIBRARY_PATH="$libraries" "$tools/usr/bin/qemu-system-arm" -machine "$2" -icount shift=0 -nographic -monitor none -serial none \
        -semihosting-config enable=on,target=native -kernel "$out/firmware.elf" > "$out/said.txt" 2>&1
    cut -d'|' -f1 "$out/said.txt" | sed 's/ *$//' > "$out/bits.txt"
    compare "$1" "$out/bits.txt"
}
run_on cortex-m4f mps2-an386 "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16" ""
run_on cortex-m7 mps2-an500 "-mcpu=cortex-m7 -mfpu=fpv5-d16" "-Ctarget-cpu=cortex-m7"

# A 64-bit Arm runs the desk's program.
mkdir -p "$work/aarch64"
build_for aarch64 aarch64-unknown-none 3 ""
arm="$tools/usr/bin/aarch64-linux-gnu-gcc -B$tools/usr/aarch64-linux-gnu/lib -isystem $tools/usr/aarch64-linux-gnu/include -L$tools/usr/aarch64-linux-gnu/lib"
for name in $names; do LD_LIBRARY_PATH="$libraries" $arm $(unit_flags "$name") -c "$here/unit.c" -o "$work/aarch64/$name.o"; done
LD_LIBRARY_PATH="$libraries" $arm -static -I"$here" -I"$work" "$here/desk.c" "$work/aarch64"/*.o "$library" -o "$work/aarch64/desk"
LD_LIBRARY_PATH="$libraries" "$tools/usr/bin/qemu-aarch64" "$work/aarch64/desk" > "$work/aarch64/said.txt"
compare aarch64 "$work/aarch64/said.txt"

# The table: instructions less those of the same loop around a step that does nothing; code is the step, and what it alone calls.
LD_LIBRARY_PATH="$libraries" "$tools/usr/bin/arm-none-eabi-nm" -S -t d "$work/cortex-m4f/firmware.elf" | awk '
    $4 ~ /_step$/ { code[$4] += $2 }
    $4 ~ /singer_imm_kf/ && $4 ~ /ImmKff|Modelf|compact[0-9]+[a-z_]+f[CE]/ { code["stillrate_singer_imm_kf_f32_step"] += $2 }
    $4 ~ /singer_imm_kf/ && $4 ~ /ImmKfd|Modeld|compact[0-9]+[a-z_]+d[CE]/ { code["stillrate_singer_imm_kf_f64_step"] += $2 }
    END { for (name in code) print name, code[name] }' > "$work/code.txt"
awk 'function key(name) { sub(/_light/, "", name); return name }
    function net(name, count) { return count - harness[FILENAME, name ~ /_f64$/] }
    FNR == 1 { file += 1 }
    file == 1 { sub(/_step$/, "", $1); code[$1] = $2; next }
    $1 ~ /^harness/ { harness[FILENAME, $1 ~ /_f64$/] = $6; next }
    file == 2 { m7[$1] = net($1, $6); next }
    !said++ { print "| filter | instructions a step, M4F | M7 | code of the step, bytes | settings | state | stack |"; print "|---|---|---|---|---|---|---|" }
    { print "| " $1 " | " net($1, $6) " | " m7[$1] " | " code[key($1)] " | " $8 " | " $9 " | " $7 " |" }' \
    "$work/code.txt" "$work/cortex-m7/said.txt" "$work/cortex-m4f/said.txt" > "$work/table.md"
if [ "${1:-}" = --update ]; then
    sed '/^| filter/,$d' "$here/README.md" > "$work/README.md"
    cat "$work/table.md" >> "$work/README.md"
    mv "$work/README.md" "$here/README.md"
fi
cat "$work/table.md"
