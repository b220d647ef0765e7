"""``stillrate live``: samples cleaned as they come."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from stillrate.cli.options import load_settings
from stillrate.cli.problems import UsageError

if TYPE_CHECKING:
    from rich.console import Console

    from stillrate.config import Config
    from stillrate.live import Loop


def command(
    source: Annotated[str, Parameter(name="SOURCE", allow_leading_hyphen=True)],
    /,
    *,
    output: Annotated[str, Parameter(name=["--output", "-o"], allow_leading_hyphen=True)] = "-",
    config: Path | None = None,
    method: str | None = None,
    rate: float | None = None,
    density: float | None = None,
    columns: str | None = None,
    time: str | None = None,
    unit: str | None = None,
    time_unit: str | None = None,
    baud: int = 115200,
    rerun: bool = False,
    quiet: bool = False,
) -> int:
    """Clean samples as they come, line by line: n lines in, n lines out; ctrl-C ends it with a summary.

    A line holds one number a channel, or more fields of which `--columns` names the rates; the others are passed on
    as they are. A malformed line counts as a missing sample and is answered by the filter's estimate.
    On a busy machine give it real-time priority: `chrt -f 10 stillrate live ...`.

    Parameters
    ----------
    source
        `-` for stdin, udp://[HOST]:PORT, or a serial port such as /dev/ttyUSB0.
    output
        `-` for stdout (the default), or udp://HOST:PORT.
    config
        Settings as TOML, such as `stillrate tune` writes.
    method
        Method by name, where there is no TOML; default ms-imm-ikf. Needs --rate and --density.
    rate
        Sample rate in Hz; with --config only where it differs.
    density
        Two-sided noise density of the gyro in deg/s/sqrt(Hz).
    columns
        The fields to filter, by position from 1 or by the header's names, separated by commas.
    time
        The field with the time stamp, by position or name; without one the rate is taken as regular.
    unit
        Unit of the rates: deg/s, rad/s or mdps.
    time_unit
        Unit of the time stamps: s, ms, us or ns.
    baud
        Baud rate of the serial port.
    rerun
        Show the curves in the rerun viewer.
    quiet
        No view and no summary.
    """
    from rich.console import Console

    from stillrate.live import LineFormat, Loop, open_sink, open_source, stop_on_signals
    from stillrate.live.viewer import Rerun

    settings, notes = _settings(config, method, rate, density)
    wanted = [name.strip() for name in columns.split(",")] if columns else None
    lines = LineFormat(wanted, time, unit, time_unit)
    tap = Rerun() if rerun else None
    with ExitStack() as stack:
        stopped = stack.enter_context(stop_on_signals())
        sink = open_sink(output)
        stack.callback(sink.close)
        origin = open_source(source, baud=baud)
        stack.callback(origin.close)
        if tap is not None:
            stack.enter_context(tap)
        loop = Loop(settings, origin, sink, lines, tap)
        console = Console(stderr=True, soft_wrap=True)
        for note in notes if not quiet else ():
            console.print(note, highlight=False, markup=False)
        try:
            _run(loop, stopped, console if not quiet else None)
        finally:
            if not quiet:
                _summarise(loop, console)
    return 0


def _run(loop: Loop, stopped: Callable[[], bool], console: Console | None) -> None:
    """Run with a view where stderr is a terminal that the clean lines do not go to."""
    import gc
    import sys

    from stillrate.live.view import shown

    mixed = loop.sink.name == "stdout" and sys.stdout.isatty()
    # What was loaded so far stays: the collector need not look through it while samples wait.
    gc.collect()
    gc.freeze()
    try:
        with shown(loop, console) if console is not None and console.is_terminal and not mixed else nullcontext():
            loop.run(stopped)
    finally:
        gc.unfreeze()


def _summarise(loop: Loop, console: Console) -> None:
    from stillrate.live.view import estimates, in_force, remark, troubles

    counts = loop.statistics
    said = [f"{loop.source.name} to {loop.sink.name}{troubles(loop)}", *counts.summary()]
    for name, estimate in zip(loop.lines.names, estimates(loop), strict=False):
        said.append(f"{name}: model in force {in_force(loop, estimate)}")
    if warning := remark(loop):
        said.append(warning.strip(" ()"))
    for line in said:
        console.print(f"live: {line}", highlight=False, markup=False)


def _settings(
    path: Path | None, method: str | None, rate: float | None, density: float | None
) -> tuple[Config, list[str]]:
    """Return the settings, and a note if they had to be rebuilt for another rate."""
    from stillrate.cleaning import DEFAULT_METHOD, at_rate
    from stillrate.config import config_from_settings

    if path is None:
        if rate is None or density is None:
            raise UsageError(
                "live needs --config F.toml (stillrate tune writes it from a log at rest), or --rate and --density"
            )
        settings = {"sample_rate_hz": rate, "noise.density_dps_sqrt_hz": density}
        return config_from_settings(method or DEFAULT_METHOD, settings), []
    if method is not None or density is not None:
        raise UsageError("--config excludes --method and --density: both stand in the settings")
    config = load_settings(path)
    return (config, []) if rate is None else at_rate(config, rate)
