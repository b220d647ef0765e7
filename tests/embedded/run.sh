#!/bin/sh
# Cross-builds the C library, runs every filter on an emulated Cortex-M4F and M7 and compares the bits with the desk. Exits with 0
# and a remark where the tools cannot be had. Configurations come from `cargo test -p stillrate-c`.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
sh "$here/toolchain.sh" || { echo "skipped: no Arm tools"; exit 0; }
tools="$root/target/embedded/toolchain"
work="$root/target/embedded/run"
libraries="$tools/usr/lib/x86_64-linux-gnu:$tools/usr/lib:$tools/lib/x86_64-linux-gnu"
mkdir -p "$work"
(cd "$root" && nice cargo test --quiet -p stillrate-c --test c_abi > /dev/null)
(cd "$root/crates/stillrate-c/abi" && RUSTC="$tools/usr/bin/rustc" RUSTC_BOOTSTRAP=1 LD_LIBRARY_PATH="$libraries" \
    nice cargo build --quiet --locked --release -Zbuild-std=core --features core-sqrt --target thumbv7em-none-eabihf \
    --target-dir "$root/target/embedded/abi")
arm_library="$root/target/embedded/abi/thumbv7em-none-eabihf/release/libstillrate_abi.a"
arm="$tools/usr/bin/arm-none-eabi-gcc"
cpu="-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16"
names=$(cd "$root/target/tmp" && ls -d stillrate_*_f32 stillrate_*_f64)
: > "$work/units.h"
for name in $names; do echo "extern const struct unit ${name}_unit;" >> "$work/units.h"; done
echo "static const struct unit *const UNITS[] = {" >> "$work/units.h"
for name in $names; do echo "    &${name}_unit," >> "$work/units.h"; done
echo "};" >> "$work/units.h"
for name in $names; do
    case $name in *_f32) real=float ;; *) real=double ;; esac
    period=period_s
    case $name in *hmm_rls*) period=mean.period_s ;; esac
    flags="-std=c99 -O2 -ffp-contract=off -Wall -Wextra -Werror -DFILTER=$name -DREAL=$real -DUNIT_PERIOD=$period
        -I$here -I$work -I$root/crates/stillrate-c/include -I$root/target/tmp/$name"
    cc $flags -c "$here/unit.c" -o "$work/$name.desk.o"
    LD_LIBRARY_PATH="$libraries" "$arm" $cpu -isystem "$here/include" $flags -ffreestanding -c "$here/unit.c" -o "$work/$name.arm.o"
done
cc -I"$here" -I"$work" "$here/desk.c" "$work"/*.desk.o "$root/target/debug/libstillrate.a" -o "$work/desk"
LD_LIBRARY_PATH="$libraries" "$arm" $cpu -O2 -ffreestanding -fno-builtin -fno-tree-loop-distribute-patterns -nostdlib \
    -I"$here" -I"$work" -T "$here/link.ld" -Wl,--gc-sections,-z,noexecstack,--no-warn-rwx-segments "$here/firmware.c" "$work"/*.arm.o "$arm_library" -lgcc -o "$work/firmware.elf"
"$work/desk" > "$work/desk.txt"
for machine in mps2-an386 mps2-an500; do
    LD_LIBRARY_PATH="$libraries" "$tools/usr/bin/qemu-system-arm" -machine $machine -icount shift=0 -nographic -monitor none -serial none \
        -semihosting-config enable=on,target=native -kernel "$work/firmware.elf" > "$work/$machine.txt" 2>&1
    cut -d'|' -f1 "$work/$machine.txt" | sed 's/ *$//' | diff - "$work/desk.txt" > "$work/$machine.diff" \
        || { echo "$machine: bits differ from the desk"; cat "$work/$machine.diff"; exit 1; }
    echo "$machine: the bits of the desk in $(wc -l < "$work/desk.txt") filters"
done
# The table: instructions a step include making the sample and summing the output, about 150; code is the step function alone.
LD_LIBRARY_PATH="$libraries" "$tools/usr/bin/arm-none-eabi-nm" -S -t d "$work/firmware.elf" | awk '$4 ~ /_step$/ { print $4, $2 + 0 }' > "$work/code.txt"
awk 'FNR == 1 { file += 1 }
    file == 1 { sub(/_step$/, "", $1); code[$1] = $2; next }
    file == 2 { m7[$1] = $5; next }
    FNR == 1 { print "| filter | instructions a step, M4F | M7 | code of the step, bytes | settings | state | stack |"; print "|---|---|---|---|---|---|---|" }
    { print "| " $1 " | " $5 " | " m7[$1] " | " code[$1] " | " $7 " | " $8 " | " $6 " |" }' \
    "$work/code.txt" "$work/mps2-an500.txt" "$work/mps2-an386.txt" > "$work/table.md"
cat "$work/table.md"
