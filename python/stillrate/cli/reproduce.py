"""`stillrate reproduce`: published figures beside ours."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from stillrate.cli.problems import UsageError

STUDIES = {
    "recursive": ("recursive", "recursive", "Recursive filters: gains, lags, adaptive forgetting."),
    "two-point": ("recursive", "two_point", "Gyro bias from two reference attitudes, exact and by the shortcuts."),
    "rate-table": ("rate_table", "reproduce", "The published error network and what it does on other rates."),
    "gimbal": ("gimbal", "reproduce", "Calibration of a gimballed head, four starts, all methods."),
    "platform": ("platform", "reproduce", "The stabilised platform: table 1 and the figures of the closed loop."),
}
"""Name -> module in `stillrate.reproduce`, its function, one line of help."""


PIPE_WIDTH = 132
"""Columns where the output is no terminal."""


def command(name: Annotated[str | None, Parameter(help="Which study; without it, they are listed.")] = None) -> None:
    """Compute published figures again and print them beside ours."""
    from rich.console import Console

    # A pipe has no width of its own: tables keep theirs.
    console = Console() if sys.stdout.isatty() else Console(width=PIPE_WIDTH)
    if name is None:
        for study, (_, _, summary) in STUDIES.items():
            console.print(f"{study:<12} {summary}")
        return
    if name not in STUDIES:
        raise UsageError(f"no study {name!r} (one of {', '.join(STUDIES)})")
    module, function, _ = STUDIES[name]
    found: Any = getattr(importlib.import_module(f"stillrate.reproduce.{module}"), function)()
    if isinstance(found, (str, Path)):
        console.print(found)
    elif isinstance(found, Iterable):
        for part in found:
            console.print(part)
