#!/bin/sh
# Unpacks what the firmware tests need into target/embedded/toolchain, without touching the system: Debian's matched pair of
# rustc and its library sources (rustup offers no bare-metal target everywhere), C compilers for both Arms and the emulators.
# Exits with 3 where the packages cannot be had; the tests are then skipped.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
tools="$root/target/embedded/toolchain"
[ -e "$tools/.complete" ] && exit 0
mkdir -p "$tools/archives/partial"
packages="rustc-web rust-web-src qemu-system-arm gcc-arm-none-eabi qemu-user gcc-aarch64-linux-gnu libc6-dev-arm64-cross"
command -v apt-get > /dev/null && command -v dpkg > /dev/null || { echo "no Debian packages here"; exit 3; }
# A list of our own: the machine's may be old, and so may be the compiler it names.
mkdir -p "$tools/lists/partial"
lists="-o Debug::NoLocking=true -o Dir::State::lists=$tools/lists"
nice apt-get update --quiet $lists > "$tools/lists.log" 2>&1 || { echo "no list of packages (see $tools/lists.log)"; exit 3; }
# Downloads just what this machine lacks, dependencies included.
nice apt-get install --yes --quiet --download-only --no-install-recommends $lists \
    -o "Dir::Cache::archives=$tools/archives" $packages > "$tools/download.log" 2>&1 \
    || { echo "packages cannot be had (see $tools/download.log)"; exit 3; }
for package in "$tools"/archives/*.deb; do
    nice dpkg -x "$package" "$tools"
done
rm -rf "$tools/archives" "$tools/lists"
needed=$(sed -n 's/^rust-version = "1\.\(.*\)"/\1/p' "$root/Cargo.toml")
found=$(LD_LIBRARY_PATH="$tools/usr/lib/x86_64-linux-gnu:$tools/usr/lib" "$tools/usr/bin/rustc" --version | sed 's/rustc 1\.\([0-9]*\).*/\1/')
[ "$found" -ge "$needed" ] || { echo "the packages have Rust 1.$found, which is older than 1.$needed"; exit 3; }
touch "$tools/.complete"
