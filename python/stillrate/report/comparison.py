"""The page of a comparison: methods over logs, each gain beside its price, and what each made of the same few seconds."""

from __future__ import annotations

import math
import statistics
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from stillrate.comparing import AT_REST, LAG_REACH_S, MOVING, Comparison, Stretch
from stillrate.io.log import Log
from stillrate.io.safely import write_text
from stillrate.report.packing import pack
from stillrate.report.page import MAX_PAGE_BYTES
from stillrate.report.shell import as_json, assemble, table

_FINEST = 32
_NAMES = {AT_REST: "rest", MOVING: "motion"}
_TOOK_MOTION = 1.1
"""From this distortion on a page says that motion went with the noise: a filter that takes all noise and nothing else has 1."""


@dataclass(frozen=True)
class Compared:
    """A log and how the methods did on it."""

    source: str
    log: Log
    rows: list[Comparison]
    stretches: list[Stretch]


def write_page(path: str | Path, found: list[Compared], *, force: bool = False) -> None:
    """Write the page of a comparison.

    Raises
    ------
    FileExistsError
        If the file exists and `force` is not set.
    """
    write_text(Path(path), render(found), force=force)


def render(found: list[Compared]) -> str:
    """Return the page as text; pictures of the last logs are left out where it would become too large."""
    methods = list(dict.fromkeys(row.method for log in found for row in log.rows))
    pictured = len(found)
    while True:
        channels = [entry for index, log in enumerate(found) for entry in _channels(log, index < pictured)]
        shared = {"unit": "deg/s", "reach_ms": 1e3 * LAG_REACH_S, "took_motion": _TOOK_MOTION}
        data = as_json({**shared, "methods": methods, "channels": channels})
        if len(data) < MAX_PAGE_BYTES or pictured == 0:
            break
        pictured //= 2
    left_out = f"Pictures of the stretches stand in the first {pictured} logs only." if pictured < len(found) else ""
    logs = escape(found[0].source) if len(found) == 1 else f"{len(found)} logs"
    return assemble(
        title=f"{len(methods)} methods on {found[0].source if len(found) == 1 else f'{len(found)} logs'}",
        lead="What each gains where the sensor stands still, and what that costs where it moves.",
        body="comparison.html",
        parts={"summary": _summary(found, methods, logs), "precision": left_out, "took": f"{_TOOK_MOTION:g}"},
        data=data,
        scripts=("plot.js", "touch.js", "unpack.js", "comparison.js"),
        styles=("page.css", "comparison.css"),
    )


def _channels(log: Compared, pictured: bool) -> list[dict[str, Any]]:
    found = []
    for channel in log.log.channels:
        stretches = [s for s in log.stretches if s.channel == channel]
        found.append(
            {
                "name": f"{log.source} · {channel}",
                "about": _about(log, channel, stretches),
                "rows": [_row(row) for row in log.rows if row.channel == channel],
                "stretches": {_NAMES[s.title]: _stretch(log.log, s) for s in stretches} if pictured else {},
            }
        )
    return found


def _about(log: Compared, channel: str, stretches: list[Stretch]) -> str:
    noise = f", noise {stretches[0].sigma_dps:.3g} deg/s a sample" if stretches else ""
    rests = "" if any(s.title == AT_REST for s in stretches) else "; it never rests"
    size = f"{len(log.log):,} samples at {log.log.sample_rate_hz:.6g} Hz"
    return f"{log.source}, {channel}: {size}{noise}{rests}."


def _row(row: Comparison) -> dict[str, Any]:
    return {
        "method": row.method,
        "rest": _number(row.suppression),
        "lag": _number(row.lag_ms),
        "distortion": _number(row.distortion),
        "settling": _number(row.settling_s),
        "cost": _number(row.cost_ns),
    }


def _number(value: float) -> float | str | None:
    if math.isnan(value):
        return None
    return "inf" if math.isinf(value) else float(f"{value:.7g}")


def _stretch(log: Log, stretch: Stretch) -> dict[str, Any]:
    step = max(stretch.sigma_dps / _FINEST, 1e-9)
    time = log.t_s[stretch.where]
    if log.timing.backward or log.timing.missing:
        # Stamps that jump back have no place on an axis: count samples instead.
        time = np.arange(stretch.where.start, stretch.where.stop) / log.sample_rate_hz
    return {
        "time": pack(time, 1e-6, wide=True),
        "raw": pack(stretch.raw, step),
        "clean": {method: pack(clean, step / 4.0) for method, clean in stretch.clean.items()},
    }


def _summary(found: list[Compared], methods: list[str], logs: str) -> str:
    """Return the table over all logs and channels: the usual gain beside the worst price."""
    rows = [row for log in found for row in log.rows]
    channels = len(rows) // len(methods)
    if channels < 2:
        return ""
    lines = []
    for method in methods:
        own = [row for row in rows if row.method == method]
        distortion = _worst([row.distortion for row in own])
        took = (
            f'<span class="took">{_word(distortion, ".2f")}</span>'
            if distortion > _TOOK_MOTION
            else _word(distortion, ".2f")
        )
        lines.append(
            [
                escape(method),
                _word(_median([row.suppression for row in own]), ".3g"),
                _word(_least([row.suppression for row in own]), ".3g"),
                _lag(_worst([row.lag_ms for row in own])),
                took,
                _word(_worst([row.settling_s for row in own]), ".3f"),
                _word(_median([row.cost_ns for row in own]), ".0f"),
            ]
        )
    head = (
        "method",
        "rest ×, median",
        "least",
        "lag ms, worst",
        "distortion σ, worst",
        "settling s, worst",
        "cost ns, median",
    )
    title = f"<h2>Over all {channels} channels of {logs}</h2>"
    return f'{title}<div class="scroll">{table(head, lines, "summary")}</div><h2>Channel by channel</h2>'


def _known(values: list[float]) -> list[float]:
    return [value for value in values if not math.isnan(value)]


def _median(values: list[float]) -> float:
    return statistics.median(_known(values)) if _known(values) else math.nan


def _least(values: list[float]) -> float:
    return min(_known(values), default=math.nan)


def _worst(values: list[float]) -> float:
    return max(_known(values), key=abs, default=math.nan)


def _word(value: float, form: str) -> str:
    if math.isnan(value):
        return "–"
    return "never" if math.isinf(value) else format(value, form)


def _lag(value: float) -> str:
    reach = 1e3 * LAG_REACH_S
    return f"> {math.copysign(reach, value):.0f}" if abs(value) >= reach else _word(round(value, 2) + 0.0, "+.2f")
