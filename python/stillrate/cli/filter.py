"""``stillrate filter``: a log in, the same log out with its rates filtered."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from stillrate.cli.options import Force, ReadOptions, load_settings, refuse_taken
from stillrate.cli.problems import UsageError, naming

if TYPE_CHECKING:
    from rich.table import Table

    from stillrate.cleaning import Cleaned
    from stillrate.config import Config
    from stillrate.io import Log

_NO_READING = ReadOptions()


def command(
    source: Annotated[Path, Parameter(name="IN")],
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    config: Path | None = None,
    method: str | None = None,
    report: Path | None = None,
    keep_raw: bool = False,
    quiet: bool = False,
    force: Force = False,
    reading: ReadOptions = _NO_READING,
) -> int:
    """Clean a gyro log: same rows and columns, the rates filtered under their own names.

    Without settings the noise of each axis is estimated from the log itself.

    Parameters
    ----------
    source
        The log: CSV, TSV, Parquet, npz, ...; found by the name's ending.
    output
        Where the clean log goes; the name's ending says in which format.
    config
        Settings as TOML, such as `stillrate tune` writes.
    method
        Method by name, with settings from the log; default ms-imm-ikf. `stillrate compare` shows all of them.
    report
        Write a page with pictures as well (HTML).
    keep_raw
        Keep each raw column as NAME_raw.
    quiet
        No progress bar and no table.
    """
    from rich.console import Console

    from stillrate import io
    from stillrate.cleaning import settings_for

    if config is not None and method is not None:
        raise UsageError("--config and --method exclude each other: the method stands in the settings")
    if output.suffix.lower() not in io.writable():
        raise UsageError(f"{output}: cannot write {output.suffix or 'it'} (endings: {', '.join(io.writable())})")
    refuse_taken([output, *([report] if report else [])], force=force)
    if source.exists() and source.resolve() == output.resolve():
        raise UsageError(f"{output}: is the input itself")
    given = load_settings(config) if config is not None else None
    log = reading.read(source)
    with naming(source):
        configs, notes = settings_for(log, method=method, config=given)
        done = _run(log, configs, tuple(notes), views=report is not None, quiet=quiet)
        clean = _with_raw(done) if keep_raw else done.clean
    io.write(output, clean, force=force)
    if report is not None:
        from stillrate.report import write_page

        write_page(report, done, force=force)
    if not quiet:
        from stillrate.report.figures import remarks

        console = Console(stderr=True)
        console.print(_summary(done))
        for remark in remarks(done):
            console.print(f"  {remark}", highlight=False, markup=False)
        console.print(
            f"wrote {output}" + (f" and {report}" if report else ""),
            highlight=False,
            markup=False,
            soft_wrap=True,
        )
    return 0


def _run(log: Log, configs: dict[str, Config], notes: tuple[str, ...], *, views: bool, quiet: bool) -> Cleaned:
    """Filter with a progress bar that shows up only when the work is long."""
    from rich.console import Console
    from rich.progress import Progress

    from stillrate.cleaning import clean

    work = len(log) * len(log.channels)
    with Progress(console=Console(stderr=True), transient=True, disable=quiet or work < 200_000) as bar:
        task = bar.add_task("filtering", total=work)
        return clean(log, configs, notes=notes, views=views, progress=lambda count: bar.advance(task, count))


def _with_raw(done: Cleaned) -> Log:
    """Add each raw column as NAME_raw beside the clean one."""
    from stillrate.errors import LogError

    log = done.clean
    original = done.raw.layout.original
    raw = {f"{name}_raw": original.get(name, done.raw.rate_dps[:, i]) for i, name in enumerate(log.channels)}
    if taken := sorted(set(raw) & {*log.columns, *log.channels}):
        raise LogError(f"there is a column {taken[0]} already: leave out --keep-raw")
    order = []
    for name in log.layout.order or log.channels:
        order += [name, f"{name}_raw"] if name in log.channels else [name]
    layout = dataclasses.replace(log.layout, order=tuple(order))
    return dataclasses.replace(log, columns={**log.columns, **raw}, layout=layout)


def _summary(done: Cleaned) -> Table:
    """Return one row a channel: what the noise was, what was taken away."""
    from stillrate.report.figures import axis_figures
    from stillrate.tables import plain_table

    method = next(iter(done.configs.values())).method
    title = (
        f"{done.raw.meta.get('source', 'log')}: {len(done.raw)} samples at {done.raw.sample_rate_hz:.6g} Hz, {method}"
    )
    heads = (
        "channel",
        "noise density\n(deg/s)/√Hz",
        "quiet noise before\ndeg/s",
        "after\ndeg/s",
        "ratio",
        "taken away\ndeg/s RMS",
    )
    table = plain_table(title, heads, words=("channel",))
    for figures in axis_figures(done):
        table.add_row(*figures.cells())
    return table
