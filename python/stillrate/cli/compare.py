"""``stillrate compare``: all methods on one's own logs, gains beside their price."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from stillrate.cli.options import Force, ReadOptions, refuse_taken
from stillrate.cli.problems import naming

if TYPE_CHECKING:
    from rich.table import Table

    from stillrate.comparing import Comparison
    from stillrate.io import Log

_NO_READING = ReadOptions()


def command(
    *sources: Annotated[Path, Parameter(name="IN", required=True)],
    method: Annotated[tuple[str, ...], Parameter(show_default=False)] = (),
    report: Path | None = None,
    force: Force = False,
    reading: ReadOptions = _NO_READING,
) -> int:
    """Run all methods on logs: noise suppression at rest beside lag, distortion, settling and cost.

    Parameters
    ----------
    sources
        The logs.
    method
        Only this method; may be repeated.
    report
        Write a page with pictures as well (HTML).
    """
    from rich.console import Console

    from stillrate.comparing import compare_with_stretches
    from stillrate.report.comparison import Compared, write_page

    refuse_taken([report] if report else [], force=force)
    console = Console()
    found = []
    for source in sources:
        log = reading.read(source)
        with console.status(f"comparing on {source.name}"), naming(source):
            rows, stretches = compare_with_stretches(log, method)
        console.print(_table(source.name, log, rows))
        if report is not None:
            found.append(Compared(source.name, log, rows, stretches))
    if report is not None:
        write_page(report, found, force=force)
        console.print(f"wrote {report}", highlight=False, markup=False, soft_wrap=True)
    return 0


def _table(name: str, log: Log, rows: list[Comparison]) -> Table:
    from stillrate.tables import plain_table

    table = plain_table(
        f"{name}: {len(log)} samples at {log.sample_rate_hz:.6g} Hz",
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
            _lag(row.lag_ms),
            _word(row.distortion, ".2f"),
            _word(row.settling_s, ".3f"),
            f"{row.cost_ns:.0f}",
        )
        last = row.channel
    return table


def _lag(value: float) -> str:
    from stillrate.comparing import LAG_REACH_S

    reach = 1e3 * LAG_REACH_S
    return f">{math.copysign(reach, value):+.0f}" if abs(value) >= reach else _word(round(value, 2) + 0.0, "+.2f")


def _word(value: float, form: str) -> str:
    if math.isnan(value):
        return "-"
    return "never" if math.isinf(value) else format(value, form)
