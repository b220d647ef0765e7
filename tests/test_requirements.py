"""The map from promises to tests (`tests/README.md`) is true; and promises that had no test elsewhere."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import numpy as np
import stillrate as sr

ROOT = Path(__file__).parents[1]
MAP = (ROOT / "tests/README.md").read_text(encoding="utf-8")
NAMED = re.findall(r"`([\w/.-]+\.(?:py|rs))::(\w+)`( \(long\))?", MAP)


def _python_tests(text: str) -> dict[str, bool]:
    """Return the tests of a module and whether each is long."""
    found = {}
    for node in ast.parse(text).body:
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
            found[node.name] = any("mark.long" in ast.unparse(mark) for mark in node.decorator_list)
    return found


def _rust_tests(text: str) -> dict[str, bool]:
    found = {}
    for attributes, name in re.findall(r"#\[test\]((?:\s*(?:#\[[^\n]*\]|//[^\n]*))*)\s*(?:pub )?fn (\w+)", text):
        found[name] = "#[ignore" in attributes
    return found


def test_every_test_that_the_map_names_exists_and_is_long_where_it_says_so() -> None:
    assert len(NAMED) > 80
    for file, name, long in NAMED:
        text = (ROOT / file).read_text(encoding="utf-8")
        tests = _python_tests(text) if file.endswith(".py") else _rust_tests(text)
        assert name in tests, f"{file}::{name} does not exist"
        assert tests[name] == bool(long), f"{file}::{name} is {'long' if tests[name] else 'not long'}"


def test_every_row_of_the_map_names_a_test_or_a_command_or_says_there_is_none() -> None:
    rows = [line for line in MAP.splitlines() if line.startswith("| ") and not line.startswith("| promise ")]
    assert len(rows) > 60
    for row in rows:
        held = row.rsplit(" | ", 1)[1]
        assert "::" in held or "`make " in held or "no test" in held, row


def test_every_page_of_the_documentation_has_its_place_in_the_map() -> None:
    heads = " ".join(line for line in MAP.splitlines() if line.startswith("## "))
    for page in [*(ROOT / "docs").glob("*.md"), *(ROOT / "docs").glob("*/*.md")]:
        name = page.relative_to(ROOT).as_posix()
        if "generated" not in name:
            assert name in heads or f"{Path(name).parent.as_posix()}/" in heads.split(), name


def test_every_long_file_has_its_reason() -> None:
    page = (ROOT / "docs/contributing.md").read_text(encoding="utf-8")
    told = page.partition("## Long files\n")[2].partition("\n## ")[0]
    files = [
        path
        for place in ("crates", "python", "tests", "benches", "docs", "examples", "fuzz")
        for path in (ROOT / place).rglob("*")
    ]
    sources = [
        path
        for path in files
        if path.suffix in (".rs", ".py", ".pyi", ".h", ".js") and not {"target", "generated"} & set(path.parts)
    ]
    assert len(sources) > 400
    long = [path for path in sources if len(path.read_text(encoding="utf-8").splitlines()) > 300]
    assert not [path for path in long if f"{path.name}`" not in told]


def test_a_density_too_low_costs_more_than_one_too_high() -> None:
    run = sr.simulate.static(50.0, seed=3)
    right = 0.1068 / 50.0**0.5
    error = {}
    for factor in (0.5, 1.0, 2.0):
        noise = sr.GyroNoise(density_dps_sqrt_hz=factor * right, rate_random_walk_dps_sqrt_s=0.0033)
        clean = sr.Filter(sr.MsImmIkf(sample_rate_hz=50.0, noise=noise)).run(run.measured_dps)
        error[factor] = float(np.sqrt(np.mean((clean - run.truth_dps) ** 2)))
    assert error[0.5] > 2.0 * error[1.0], error  # "several times the noise at rest"
    assert error[2.0] < 1.5 * error[1.0] and error[2.0] < error[0.5], error
