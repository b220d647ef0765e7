"""``stillrate demo``: the main job on a simulated log, beside what else one could use."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from stillrate.cli.options import refuse_no_folder

if TYPE_CHECKING:
    from rich.table import Table

    from stillrate.cleaning import Cleaned
    from stillrate.demo import Row


def command(
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])] = Path("demo-output"),
    rate: float = 50.0,
    seed: int | None = None,
) -> int:
    """Clean a simulated log by several methods and show why to trust the result.

    Parameters
    ----------
    output
        Folder for the page, the log and the picture; files of an earlier demo are replaced.
    rate
        Sample rate in Hz.
    seed
        Seed of the simulation.
    """
    from rich.console import Console

    from stillrate import demo, io
    from stillrate.cleaning import clean
    from stillrate.report import write_page

    refuse_no_folder(output)
    console = Console()
    found = demo.runs(rate, demo.SEED if seed is None else seed)
    with console.status("filtering"):
        rows = demo.score(found)
    console.print(_table(rows, rate))
    log = demo.wave_log(found)
    config = demo.contestants(found)["MS-IMM-IKF (default)"]
    assert config is not None
    done = clean(log, {"gx_dps": config}, views=True)
    output.mkdir(parents=True, exist_ok=True)
    page, raw = output / "report.html", output / "waves.csv"
    write_page(page, done, force=True)
    io.write(raw, log, force=True)
    _picture(output / "before-after.png", done)
    console.print(f"The page: [bold]{page}[/]  (open it in a browser)", soft_wrap=True)
    console.print(f"The log:  {raw}", soft_wrap=True)
    console.print(f"Yours:    stillrate filter {raw} -o clean.csv --report page.html", soft_wrap=True, markup=False)
    return 0


def _picture(path: Path, done: Cleaned) -> None:
    """Write the picture, if matplotlib is there."""
    import importlib.util

    if importlib.util.find_spec("matplotlib") is None:
        return
    from stillrate.report.picture import write_picture

    log = done.raw
    rate = log.sample_rate_hz
    write_picture(
        path,
        log.t_s,
        log.rate_dps[:, 0],
        done.clean.rate_dps[:, 0],
        log.columns["gx_true_dps"],
        title="Simulated gyro in waves that die down",
        closeups=(
            ("in the waves", slice(round(60 * rate), round(61.5 * rate))),
            ("in the calm after", slice(round(150 * rate), round(156 * rate))),
        ),
        force=True,
    )


def _table(rows: list[Row], rate: float) -> Table:
    from stillrate.tables import plain_table

    table = plain_table(
        f"At rest for 60 s; 2 Hz waves that die down; steps. {rate:g} Hz, noise and seed the same for all.",
        ("filter", "at rest\ndeg/s", "in waves\ndeg/s", "calm after\ndeg/s", "lag\nms", "settling\ns"),
        words=("filter",),
        caption="RMS errors against the true rate of the sensor. Calm: from 12 s after the waves. The last row knows"
        " the wave model and its parameters beforehand; the others do not.",
    )
    for row in rows:
        bold = "bold" if "default" in row.name else ""
        settling = {math.isnan(row.settling_s): "-", math.isinf(row.settling_s): "never"}.get(
            True, f"{row.settling_s:.2f}"
        )
        table.add_row(
            row.name,
            f"{row.static_dps:.4f}",
            f"{row.waves_dps:.4f}",
            f"{row.calm_dps:.4f}",
            f"{round(row.lag_ms, 2) + 0.0:+.2f}",
            settling,
            style=bold,
        )
    return table
