"""Counts the instructions of a step of every filter with callgrind and compares them with the committed table.

python benches/instructions.py            # fails where a filter became more than 3 % slower
python benches/instructions.py --update   # writes the table, and README.md anew
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import tables

HERE = Path(__file__).parent
ALLOWED = 0.03


def main(arguments: list[str]) -> int:
    if not shutil.which("valgrind"):
        print("instruction counts: skipped, valgrind is not installed")
        return 0
    counts, compiler = count(), rustc_version()
    if "--update" in arguments:
        found = {"rustc": compiler, "per_sample": counts}
        tables.COUNTS.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        tables.write()
        return 0
    table = json.loads(tables.COUNTS.read_text(encoding="utf-8"))
    if table["rustc"] != compiler:
        print(f"instruction counts: skipped, the table was made with {table['rustc']}, this is {compiler}")
        return 0
    return report(table["per_sample"], counts)


def report(expected: dict[str, float], counts: dict[str, float]) -> int:
    """Prints what changed by more than what is allowed; 1 if anything became slower."""
    slower = 0
    for case, number in counts.items():
        before = expected.get(case)
        if before is None:
            print(f"instruction counts: {case} is not in the table; run with --update")
            slower = 1
        elif abs(number / before - 1) > ALLOWED:
            print(f"instruction counts: {case} took {before:.1f} a sample, now {number:.1f}")
            slower |= number > before
    print(f"instruction counts: {len(counts)} cases, {'slower' if slower else 'none slower'}")
    return slower


def count() -> dict[str, float]:
    """Instructions a sample and channel of every case."""
    # A member of the workspace: elsewhere the folder's own name would change symbols, and with them the inlining.
    build = ["cargo", "build", "--release", "--quiet", "--package", "stillrate-instructions"]
    subprocess.run(build, cwd=HERE.parent, check=True)
    program = HERE.parent / os.environ.get("CARGO_TARGET_DIR", "target") / "release" / "stillrate-instructions"
    cases = subprocess.run([program, "list"], check=True, capture_output=True, text=True).stdout.splitlines()
    counts = {}
    with tempfile.TemporaryDirectory() as folder:
        dump = Path(folder) / "dump"
        valgrind = ["valgrind", "--quiet", "--tool=callgrind", f"--callgrind-out-file={dump}"]
        for line in cases:
            case, samples = line.split("\t")
            subprocess.run([*valgrind, "--toggle-collect=*counted*", program, "count", case], check=True)
            counts[case] = round(collected(dump) / int(samples), 2)
    return counts


def collected(dump: Path) -> int:
    """The total of one dump."""
    lines = dump.read_text(encoding="utf-8").splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith(("totals:", "summary:")))


def rustc_version() -> str:
    return subprocess.run(["rustc", "--version"], check=True, capture_output=True, text=True).stdout.strip()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
