"""``stillrate compare``: all methods on one's own logs, gains beside their price."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from stillrate.cli.options import ReadOptions

_NO_READING = ReadOptions()


def command(
    *sources: Annotated[Path, Parameter(name="IN")],
    method: Annotated[tuple[str, ...], Parameter(negative="")] = (),
    reading: ReadOptions = _NO_READING,
) -> int:
    """Run all methods on logs: noise suppression at rest beside lag, distortion, settling and cost.

    Parameters
    ----------
    sources
        The logs.
    method
        Only these methods (may be repeated).
    """
    from rich.console import Console

    from stillrate.cli.problems import UsageError
    from stillrate.comparing import compare
    from stillrate.tables import plain_table

    if not sources:
        raise UsageError("compare needs a log")
    console = Console()
    for source in sources:
        log = reading.read(source)
        with console.status(f"comparing on {source.name}"):
            rows = compare(log, method)
        table = plain_table(
            f"{source.name}: {len(log)} samples at {log.sample_rate_hz:.6g} Hz",
            ("channel", "method", "rest\nx", "lag\nms", "distortion\nσ", "settling\ns", "cost\nns/sample"),
            words=("channel", "method"),
            caption="Rest: scatter raw / filtered. Lag: against the raw record. Distortion: what was taken from the"
            " motion, over the sensor's noise; above 1 motion went with it, and then neither rest nor lag means much. Settling: simulated step of 40 deg/s."
            " Cost: on this machine, now. -: the log doesn't show it.",
            no_wrap=True,
            padding=(0, 0, 0, 1),
            pad_edge=False,
        )
        last = ""
        for row in rows:
            table.add_row(
                row.channel if row.channel != last else "",
                row.method,
                _word(row.suppression, ".3g"),
                _word(row.lag_ms, "+.2f"),
                _word(row.distortion, ".2f"),
                _word(row.settling_s, ".3f"),
                f"{row.cost_ns:.0f}",
            )
            last = row.channel
        console.print(table)
    return 0


def _word(value: float, form: str) -> str:
    if math.isnan(value):
        return "-"
    return "never" if math.isinf(value) else format(value, form)
