"""Published figures again: the short form gives what is committed, verdicts follow from figures, files are safe.

`tests/reproduced_short.json` is the file that `stillrate reproduce --short -o FOLDER` writes. Nothing in it depends on time
or machine: figures must agree to 1e-6 of themselves, or to 1e-9 where a figure is nothing but rounding.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import chromium
import pytest
from stillrate.cli import main
from stillrate.reproduce.all import DATA, PAGE, STUDIES, as_json, run, write
from stillrate.reproduce.row import NOT_REPRODUCED, NOT_REPRODUCIBLE, REPRODUCED, Row, around

COMMITTED = Path(__file__).parent / "reproduced_short.json"
RELATIVE, ROUNDING = 1e-6, 1e-9
WORDS = ("study", "quantity", "published", "unit", "verdict", "effort")
FIGURES = ("ours", "least", "most", "floor")
NEAR = Row(study="bank", quantity="rms", published="2", ours=2.1, unit="deg/s", **around(2.0, 0.1))


@pytest.fixture(scope="module")
def told() -> dict[str, tuple[list[Row], list[float]]]:
    """Rows of every study in the short form, and what it told of its progress."""
    found = {}
    for name in STUDIES:
        parts: list[float] = []
        [(_, rows)] = run([name], short=True, advance=parts.append)
        found[name] = (rows, parts)
    return found


@pytest.fixture(scope="module")
def rows(told: dict[str, tuple[list[Row], list[float]]]) -> list[Row]:
    return [row for rows, _ in told.values() for row in rows]


def committed() -> list[dict[str, object]]:
    found = json.loads(COMMITTED.read_text(encoding="utf-8"))
    assert found["format"] == 1 and found["short"] is True
    return list(found["rows"])


def same(one: object, other: object) -> bool:
    """Return whether two figures of a row agree; words and missing figures must be equal."""
    if isinstance(one, (int, float)) and isinstance(other, (int, float)):
        return one == pytest.approx(other, rel=RELATIVE, abs=ROUNDING)
    return one == other


@pytest.mark.parametrize("study", STUDIES)
def test_the_short_form_gives_what_is_committed(study: str, rows: list[Row]) -> None:
    ours = [row.as_json() for row in rows if row.study == study]
    theirs = [row for row in committed() if row["study"] == study]
    assert [row["quantity"] for row in ours] == [row["quantity"] for row in theirs]
    for one, other in zip(ours, theirs, strict=True):
        assert {key: one[key] for key in WORDS} == {key: other[key] for key in WORDS}
        for key in FIGURES:
            assert same(one[key], other[key]), (one["quantity"], key, one[key], other[key])


@pytest.mark.long
def test_the_full_form_has_the_same_rows_as_the_short_one(rows: list[Row]) -> None:
    full = [row for _, found in run(STUDIES) for row in found]
    assert [(row.study, row.quantity, row.published) for row in full] == [
        (row.study, row.quantity, row.published) for row in rows
    ]


def test_a_figure_that_moves_is_noticed() -> None:
    assert not same(2.0, 2.0 * (1 + 1e-5)) and not same(None, 1.0) and not same("inf", 1.0)
    assert same(2.0, 2.0 * (1 + 1e-7)) and same(1e-11, 3e-11)


def test_verdicts_follow_from_figures() -> None:
    assert NEAR.verdict == REPRODUCED
    assert replace(NEAR, ours=2.3).verdict == NOT_REPRODUCED
    assert replace(NEAR, ours=float("nan")).verdict == NOT_REPRODUCED
    assert replace(NEAR, ours=None).verdict == NOT_REPRODUCIBLE
    assert replace(NEAR, ours=2.3, floor=2.3).verdict == NOT_REPRODUCIBLE
    assert replace(NEAR, floor=2.0).verdict == REPRODUCED


def test_every_study_has_rows_and_every_missing_figure_a_reason(rows: list[Row]) -> None:
    assert {row.study for row in rows} == set(STUDIES)
    assert all(row.reason for row in rows if row.verdict == NOT_REPRODUCIBLE)
    assert len({(row.study, row.quantity) for row in rows}) == len(rows)


def test_every_study_tells_how_far_it_is(told: dict[str, tuple[list[Row], list[float]]]) -> None:
    for name, (_, parts) in told.items():
        assert parts and parts == sorted(set(parts)), name
        assert parts[0] > 0 and parts[-1] <= 1, name
    assert len(told["gimbal"][1]) > 20  # the longest of them


def test_an_infinite_figure_is_written_as_a_word() -> None:
    text = as_json([replace(NEAR, ours=float("inf"))], short=False)
    assert json.loads(text)["rows"][0]["ours"] == "inf"


def test_the_command_writes_page_and_file_and_overwrites_nothing_unasked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "out"
    arguments = ["reproduce", "two-point", "--short", "--quiet", "-o", str(folder)]
    assert main(arguments) == 0
    assert sorted(path.name for path in folder.iterdir()) == [PAGE, DATA]
    assert [row["study"] for row in json.loads((folder / DATA).read_text())["rows"]] == ["two-point"] * 3
    before = (folder / PAGE).stat().st_mtime_ns
    capsys.readouterr()
    assert main(arguments) == 2
    assert "exists: --force overwrites it" in capsys.readouterr().err
    assert (folder / PAGE).stat().st_mtime_ns == before
    assert main([*arguments, "--force"]) == 0
    assert main(["reproduce", "all", "-o", str(tmp_path / "none" / "out")]) == 2


def test_without_arguments_the_studies_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["reproduce"]) == 0
    listed = capsys.readouterr().out
    assert all(name in listed for name in (*STUDIES, "all"))
    assert main(["reproduce", "nothing"]) == 2


@pytest.mark.skipif(chromium.find() is None, reason="no Chromium on this machine")
@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_the_page_fits_a_phone_and_asks_for_nothing(rows: list[Row], tmp_path: Path, dark: bool) -> None:
    page, _ = write(tmp_path, rows, short=True)
    with chromium.browser(str(chromium.find())) as tab:
        tab.open(page, width=360, dark=dark)
        assert tab.ask("document.documentElement.scrollWidth") <= 360
        assert tab.ask("document.querySelectorAll('.rows tbody tr').length") == len(rows)
        paper = tab.ask("getComputedStyle(document.body).backgroundColor")
        assert (paper == "rgb(255, 255, 255)") is not dark
        assert tab.errors == [] and all(url.startswith(("file:", "data:")) for url in tab.requests)
