"""How a method does on the runs of the demonstration, measured while the site is built."""

from __future__ import annotations

import functools
import math
from typing import Any

from cells import table
from docutils import nodes
from sphinx.util.docutils import SphinxDirective
from stillrate import Filter, MsImmIkf, demo
from stillrate.config import Config, methods

LIGHT = "ms-imm-ikf, light"
RAW, BEST = "no filter", "the best that is possible"


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx."""
    app.add_directive("score", Score)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


@functools.cache
def measured() -> dict[str, demo.Row]:
    """Return the figures of every method with its defaults, of no filter, and of the bound."""
    runs = demo.runs()
    beds = (runs.static, runs.waves, runs.steps)
    given: dict[str, Any] = {
        "sample_rate_hz": runs.static.sample_rate_hz,
        "noise": runs.noise,
    }
    configs: dict[str, Config] = {name: cls(**given) for name, cls in methods().items()}
    configs[LIGHT] = MsImmIkf(**given, oscillators=())
    rows = {RAW: demo.score_one(RAW, runs, *(bed.measured_dps for bed in beds))}
    for name, config in configs.items():
        rows[name] = demo.score_one(
            name, runs, *(Filter(config).run(bed.measured_dps) for bed in beds)
        )
    assert runs.static.bound_dps is not None and runs.waves.bound_dps is not None
    rows[BEST] = demo.score_one(
        BEST, runs, runs.static.bound_dps, runs.waves.bound_dps, None
    )
    return rows


def _settling(value: float) -> str:
    if math.isnan(value):
        return "-"
    return "never" if math.isinf(value) else f"{value:.2f}"


class Score(SphinxDirective):
    """``{score} METHOD ...``: one row a method between no filter and the bound; ``all`` for all of them."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        """Build the table."""
        rows = measured()
        asked = [name.strip() for name in self.arguments[0].split(";")]
        names = list(rows) if asked == ["all"] else [RAW, *asked, BEST]
        head = (
            "",
            "at rest, deg/s",
            "in 2 Hz waves, deg/s",
            "calm after, deg/s",
            "lag, ms",
            "settling, s",
        )
        body = [_cells(name, rows[name]) for name in names]
        return [table(head, body, (30, 14, 14, 14, 14, 14), ("score",))]


def _cells(name: str, row: demo.Row) -> tuple[str, ...]:
    # Adding zero takes the sign off a rounded one.
    lag = f"{round(row.lag_ms, 2) + 0.0:+.2f}" if math.isfinite(row.lag_ms) else "-"
    figures = (f"{value:.4f}" for value in (row.static_dps, row.waves_dps, row.calm_dps))
    return (name, *figures, lag, _settling(row.settling_s))
