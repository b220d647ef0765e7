"""``stillrate tune``: settings from a log."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from stillrate.cli.options import Force, ReadOptions, refuse_taken
from stillrate.cli.problems import UsageError

_NO_READING = ReadOptions()


def command(
    source: Annotated[Path, Parameter(name="IN")],
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    method: str = "ms-imm-ikf",
    rest: str | None = None,
    force: Force = False,
    reading: ReadOptions = _NO_READING,
) -> int:
    """Measure a gyro's noise in a log and write settings for `filter`.

    Parameters
    ----------
    source
        The log; a few minutes at rest are best.
    output
        Where the settings go (TOML).
    method
        Method by name.
    rest
        The part at rest, FROM:TO in s; found by itself when left out.
    """
    from rich.console import Console

    from stillrate.io.safely import atomic
    from stillrate.tuning import tune_with_reasons

    refuse_taken([output], force=force)
    span = None if rest is None else _span(rest)
    log = reading.read(source)
    part = None if span is None else slice(*log.t_s.searchsorted(span).tolist())
    tuned = tune_with_reasons(log, method, rest=part)
    with atomic(output, force=force) as temporary:
        temporary.write_text(tuned.to_toml(), encoding="utf-8")
    console = Console(stderr=True)
    for name, found in tuned.axes.items():
        remark = "" if found.at_rest else " (in motion: an upper bound)"
        density = f"{found.density_dps_sqrt_hz:.4g} (deg/s)/√Hz = {found.density_dps_sqrt_hz * 60:.3g} deg/√h"
        console.print(f"{name}: {density}{remark}", highlight=False, markup=False)
    console.print(f"wrote {output}", highlight=False, markup=False, soft_wrap=True)
    return 0


def _span(text: str) -> tuple[float, float]:
    try:
        begin, end = (float(part) for part in text.split(":"))
    except ValueError:
        raise UsageError(f"--rest {text} (must be FROM:TO in s, such as 0:30)") from None
    if not begin < end:
        raise UsageError(f"--rest {text} (FROM must be less than TO)")
    return begin, end
