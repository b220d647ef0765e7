"""The two pictures of the rate-table study: what the published network answers, and errors on motion it has not seen."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from stillrate import _native
from stillrate.rate_table.drawing import Line, draw


def staircase(path: Path, table: dict[str, Any]) -> None:
    """Draw what the published network answers to a noise-free rate."""
    x = table["staircase_input"]
    draw(
        path,
        "What the published network answers",
        "true rate, deg/s",
        "corrected rate, deg/s",
        [
            Line("a perfect sensor", x, x, "#999999"),
            Line("published 1-10-1 network", x, table["staircase_output"], "#c0392b"),
        ],
    )


def motions(path: Path, studies: list[dict[str, Any]]) -> None:
    """Draw the RMS error of the main methods on each motion of unit 1."""
    names, jumps = _native.rate_table_motions()
    x = np.arange(float(len(names) + len(jumps)))
    colours = {
        "raw": "#999999",
        "published network": "#c0392b",
        "calibration + KF, innovations on motion": "#2980b9",
        "two-state KF, innovations, then calibration": "#8e44ad",
        "IMM bank, innovations, then calibration": "#27ae60",
    }
    rows = {row[0]: np.array([*row[2], *row[3]]) for row in studies[0]["rows"]}
    draw(
        path,
        "RMS error on held-out motion, unit 1",
        "",
        "deg/s",
        [Line(name, x, rows[name], colour) for name, colour in colours.items() if name in rows],
        ticks=[*names, *jumps],
        logarithmic=True,
    )
