"""Every study in one go: the rows, the file they go to, and where each study lives."""

from __future__ import annotations

import importlib
import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stillrate import __version__
from stillrate.io.safely import atomic
from stillrate.reproduce.progress import Advance, unwatched
from stillrate.reproduce.row import VERDICTS, Row

FORMAT = 1
"""Version of the JSON file."""
PAGE, DATA = "reproduced.html", "reproduced.json"


@dataclass(frozen=True)
class Study:
    """Where a study lives: a module of `stillrate.reproduce`, what prints its tables, what gives its rows."""

    module: str
    tables: str
    rows: str
    summary: str

    def find(self, function: str) -> Any:
        """Return one of its functions; the module is imported now and not before."""
        return getattr(importlib.import_module(f"stillrate.reproduce.{self.module}"), function)


STUDIES = {
    "bank": Study("bank", "reproduce", "rows", "MS-IMM-IKF beside Singer-IMM and the AR filter, at rest and in waves."),
    "recursive": Study("recursive", "recursive", "rows", "Recursive filters: gains, lags, adaptive forgetting."),
    "two-point": Study(
        "recursive",
        "two_point",
        "two_point_rows",
        "Gyro bias from two reference attitudes, exact and by the shortcuts.",
    ),
    "rate-table": Study(
        "rate_table", "reproduce", "rows", "The published error network and what it does on other rates."
    ),
    "gimbal": Study("gimbal", "reproduce", "rows", "Calibration of a gimballed head, four starts, all methods."),
    "platform": Study(
        "platform", "reproduce", "rows", "The stabilised platform: table 1 and the figures of the closed loop."
    ),
}
"""The studies by name, in the order of the page."""


def run(names: Iterable[str], *, short: bool = False, advance: Advance = unwatched) -> Iterator[tuple[str, list[Row]]]:
    """Run studies one after the other and yield the rows of each; `advance` is told the part of each that is done."""
    for name in names:
        study = STUDIES[name]
        yield name, study.find(study.rows)(short, advance)


def counts(rows: Sequence[Row]) -> dict[str, int]:
    """Return how many rows have each verdict."""
    return {verdict: sum(row.verdict == verdict for row in rows) for verdict in VERDICTS}


def as_json(rows: Sequence[Row], *, short: bool) -> str:
    """Return the rows as JSON; the same rows give the same text."""
    content = {
        "format": FORMAT,
        "stillrate": __version__,
        "short": short,
        "counts": counts(rows),
        "rows": [row.as_json() for row in rows],
    }
    return json.dumps(content, indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def write(folder: Path, rows: Sequence[Row], *, short: bool, force: bool = False) -> tuple[Path, Path]:
    """Write the page and the JSON into a folder, which is made if it is not there.

    Raises
    ------
    FileExistsError
        If one of the files exists and `force` is not set.
    """
    from stillrate.reproduce.page import render

    folder.mkdir(exist_ok=True)
    page, data = folder / PAGE, folder / DATA
    with atomic(page, force=force) as one, atomic(data, force=force) as other:
        one.write_text(render(rows, short=short), encoding="utf-8")
        other.write_text(as_json(rows, short=short), encoding="utf-8")
    return page, data
