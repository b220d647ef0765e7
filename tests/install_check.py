"""Packages as a stranger gets them: built, installed each into an environment of its own, and used there.

``python tests/install_check.py dist`` builds and checks all of it; ``make package`` runs that. Words behind the folder choose
parts: build, wheel, oldest, sdist, crates, rust. It downloads what the package depends on.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
import venv
from pathlib import Path

ROOT = Path(__file__).parents[1]
PARTS = ("build", "wheel", "oldest", "sdist", "crates", "rust")
# What pyproject.toml asks for at least, and nothing newer.
OLDEST = tuple(
    requirement.replace(">=", "==")
    for requirement in tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]
)
# Tests that need nothing but the package, pytest and hypothesis.
PLAIN_TESTS = ("test_filter.py", "test_widths.py", "test_analysis.py", "test_reading.py", "test_reference_filters.py")


def run(*command: str | Path, **options: object) -> None:
    """Run a command and end here if it fails."""
    print("+", *command, flush=True)
    subprocess.run([str(word) for word in command], check=True, **options)  # type: ignore[call-overload]


def beside(name: str) -> str:
    """Return the program that lies beside this Python, or else the one on the path."""
    found = shutil.which(name, path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    if found is None:
        raise SystemExit(f"{name} is not installed")
    return found


def environment(folder: Path) -> Path:
    """Make a clean environment; return the folder of its programs."""
    venv.create(folder, with_pip=True)
    return folder / "bin"


def use(programs: Path, folder: Path, search_path: str) -> None:
    """Clean a log with the installed command, with nothing on the path but `search_path`."""
    folder.mkdir()
    plain = {"PATH": search_path, "HOME": str(folder)}
    stillrate = programs / "stillrate"
    run(stillrate, "simulate", "steps", "-o", "log.csv", "--duration", "60", cwd=folder, env=plain)
    run(stillrate, "filter", "log.csv", "-o", "clean.csv", cwd=folder, env=plain)
    raw, clean = ((folder / name).read_text().splitlines() for name in ("log.csv", "clean.csv"))
    if len(raw) != len(clean) or len(raw) < 1000 or raw == clean:
        raise SystemExit(f"{len(raw)} lines in, {len(clean)} out")


def main(dist: Path, parts: tuple[str, ...]) -> None:
    """Build and check the parts."""
    if "build" in parts:
        run(beside("maturin"), "build", "--release", "--quiet", "--out", dist, cwd=ROOT)
        run(beside("maturin"), "sdist", "--out", dist, cwd=ROOT)
    wheel = max(dist.glob("*.whl"), key=os.path.getmtime, default=None)
    sdist = max(dist.glob("*.tar.gz"), key=os.path.getmtime, default=None)
    with tempfile.TemporaryDirectory() as name:
        scratch = Path(name)
        if "wheel" in parts:
            assert wheel is not None, "no wheel"
            programs = environment(scratch / "wheel")
            without_rust = f"{programs}:/usr/bin:/bin"
            if found := shutil.which("cargo", path=without_rust):
                print(f"note: {found} is in reach of what should be without Rust")
            options = {"env": {**os.environ, "PATH": without_rust}}
            run(programs / "pip", "install", "--quiet", "--only-binary", ":all:", wheel, **options)
            use(programs, scratch / "wheel-use", without_rust)
        if "oldest" in parts:
            assert wheel is not None, "no wheel"
            programs = environment(scratch / "oldest")
            run(programs / "pip", "install", "--quiet", wheel, *OLDEST, "pytest", "hypothesis")
            use(programs, scratch / "oldest-use", f"{programs}:/usr/bin:/bin")
            tests = [ROOT / "tests" / test for test in PLAIN_TESTS]
            run(programs / "python", "-m", "pytest", "-q", "-p", "no:cacheprovider", *tests, cwd=ROOT)
        if "sdist" in parts:
            assert sdist is not None, "no source archive"
            programs = environment(scratch / "sdist")
            run(programs / "pip", "install", "--quiet", sdist)
            use(programs, scratch / "sdist-use", f"{programs}:/usr/bin:/bin")
    if "crates" in parts:
        # The second is verified against the first as packaged, without a registry that has it.
        run("cargo", "package", "--quiet", "--allow-dirty", "-p", "stillrate", "-p", "stillrate-lab", cwd=ROOT)
    if "rust" in parts:
        oldest_rust()
    print("checked:", *parts)


def oldest_rust() -> None:
    """Check every crate with the oldest compiler that Cargo.toml admits, where rustup can fetch it."""
    if shutil.which("rustup") is None:
        print("skipped: the oldest Rust, without rustup to fetch it")
        return
    package = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]
    version = f"{package['rust-version']}.0"
    run("rustup", "toolchain", "install", "--no-self-update", "--profile", "minimal", version)
    with tempfile.TemporaryDirectory() as target:
        run("cargo", f"+{version}", "check", "--quiet", "--workspace", "--target-dir", target, cwd=ROOT)


if __name__ == "__main__":
    if len(sys.argv) < 2 or set(sys.argv[2:]) - set(PARTS):
        raise SystemExit(f"usage: install_check.py FOLDER [{' | '.join(PARTS)} ...]")
    main(Path(sys.argv[1]).resolve(), tuple(sys.argv[2:]) or PARTS)
