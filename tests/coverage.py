"""Coverage of the core by line and branch, over the tests of the core and of the lab.

``python tests/coverage.py`` runs both crates' tests with instrumented code (`make coverage`) and prints a table by folder;
``--files`` prints it by file, ``--missed FILE`` what is missed in one, ``--no-run`` reads the run before again.

A line or a branch of a generic function counts once, and as run if any of its instantiations ran it. Tests that stand in the
sources are no part of either figure.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
from collections import Counter
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
CORE = ROOT / "crates" / "stillrate" / "src"
LINES, BRANCHES = ROOT / "target" / "coverage.info", ROOT / "target" / "coverage.json"
TESTED = ("-p", "stillrate", "-p", "stillrate-lab")
SLOW = ("default_", "recovers_from_every_fault")
"""Begin the names of long Monte Carlo tests that run nothing others don't, and take minutes with every line counted."""
BRANCH_KIND = 4
"""What the export calls a branch with two ways."""


def measure() -> None:
    """Run the tests; branches need an option that the stable compiler keeps for later."""
    llvm = {"LLVM_COV": _newest("llvm-cov"), "LLVM_PROFDATA": _newest("llvm-profdata")}
    environment = {**os.environ, **llvm, "RUSTC_BOOTSTRAP": "1"}

    def run(*words: str) -> None:
        subprocess.run(("cargo", "llvm-cov", *words), cwd=ROOT, check=True, env=environment)

    run("clean", "--workspace")
    run(*TESTED, "--branch", "--no-report", "--", *(word for test in SLOW for word in ("--skip", test)))
    run("report", "--branch", "--lcov", "--output-path", str(LINES))
    run("report", "--branch", "--json", "--output-path", str(BRANCHES))


def _newest(tool: str) -> str:
    """Return a tool of the newest LLVM here; it must not be older than the compiler's."""
    names = (*(f"{tool}-{version}" for version in range(30, 20, -1)), tool)
    found = next((path for path in map(shutil.which, names) if path), None)
    if found is None:
        raise SystemExit(
            f"{tool} is not installed (LLVM 22 or the newer one of your compiler: rustc --version --verbose)"
        )
    return found


@cache
def code_lines(path: Path) -> int:
    """Return the number of the first line that belongs to the tests in a source file."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return next((n for n, line in enumerate(lines, start=1) if line.startswith("#[cfg(test)]")), len(lines) + 1)


def of_files() -> dict[Path, tuple[dict[int, int], dict[tuple[int, ...], int]]]:
    """Return how often each line, and each way of each branch, of each file of the core ran."""
    lines = _lines()
    branches: dict[Path, Counter[tuple[int, ...]]] = {path: Counter() for path in lines}
    [export] = json.loads(BRANCHES.read_text(encoding="utf-8"))["data"]
    for function in export["functions"]:
        for first, column, last, last_column, yes, no, file, _, kind in function["branches"]:
            path = Path(function["filenames"][file])
            if path in lines and kind == BRANCH_KIND and first < code_lines(path):
                branches[path][first, column, last, last_column, 1] += yes
                branches[path][first, column, last, last_column, 0] += no
    return {path: (lines[path], dict(branches[path])) for path in sorted(lines)}


def _lines() -> dict[Path, dict[int, int]]:
    """Return how often each line ran; the export has already added up the instantiations."""
    found: dict[Path, dict[int, int]] = {}
    path, end = Path(), 0
    for record in LINES.read_text(encoding="utf-8").splitlines():
        kind, _, value = record.partition(":")
        if kind == "SF":
            path = Path(value)
            end = code_lines(path) if path.is_relative_to(CORE) else 0
        elif kind == "DA":
            number, count = map(int, value.split(",")[:2])
            if number < end:
                found.setdefault(path, {})[number] = count
    return found


def share(counts: list[int]) -> str:
    """Return how many of these ran, in words."""
    ran = sum(count > 0 for count in counts)
    return f"{100 * ran / len(counts):5.1f} % of {len(counts):5}" if counts else "      none"


def main() -> None:
    """Print the table."""
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--no-run", action="store_true")
    arguments.add_argument("--files", action="store_true")
    arguments.add_argument("--missed", metavar="FILE")
    given = arguments.parse_args()
    if not given.no_run:
        measure()
    found = of_files()
    if given.missed:
        for path, (lines, branches) in found.items():
            if str(path).endswith(given.missed):
                print(path.relative_to(CORE), "lines", sorted(n for n, count in lines.items() if not count))
                ways = sorted((*key[:2], bool(key[4])) for key, count in branches.items() if not count)
                print(*(f"  {line}:{column} never {way}" for line, column, way in ways), sep="\n")
        return
    groups: dict[str, tuple[list[int], list[int]]] = {}
    for path, (lines, branches) in found.items():
        place = path.relative_to(CORE)
        name = str(place) if given.files else place.parts[0] if len(place.parts) > 1 else "."
        for of in (groups.setdefault(name, ([], [])), groups.setdefault("all of the core", ([], []))):
            of[0].extend(lines.values())
            of[1].extend(branches.values())
    for name, (lines_of, branches_of) in sorted(groups.items(), key=lambda item: item[0] == "all of the core"):
        print(f"{name:<34} lines {share(lines_of)}   branches {share(branches_of)}")


if __name__ == "__main__":
    main()
