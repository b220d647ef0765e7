"""``stillrate fleet``: many logs at once."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from stillrate.cli.options import Force, ReadOptions, load_settings, refuse_no_folder
from stillrate.cli.problems import UsageError

if TYPE_CHECKING:
    from rich.console import Console

    from stillrate.fleet import Fleet

_NO_READING = ReadOptions()


def command(
    *sources: Annotated[str, Parameter(name="FOLDER_OR_GLOB", required=True)],
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    config: Path | None = None,
    method: str | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    retry: bool = False,
    quiet: bool = False,
    force: Force = False,
    reading: ReadOptions = _NO_READING,
) -> int:
    """Clean a folder of logs on all cores, or on a cluster; a second run continues where the first stopped.

    OUT/clean holds the clean logs as Parquet, OUT/summary.parquet one row a channel and one for each broken log. A log
    whose content and settings have not changed is not done again. The exit code is 1 if a log is broken.

    Parameters
    ----------
    sources
        Folders (with all folders in them), globs, or logs.
    output
        Folder of the results, OUT above; made if missing.
    config
        Settings as TOML, such as `stillrate tune` writes; each log's own noise when left out.
    method
        Method by name, with settings from each log; default ms-imm-ikf.
    scheduler
        Address of a Dask scheduler, such as tcp://10.0.0.1:8786; its workers must see the same folders.
    workers
        How many worker processes on this machine; default one a core.
    retry
        Try broken logs again though nothing changed.
    quiet
        No progress bar and no figures; broken logs are still named.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from stillrate.config import method_class
    from stillrate.fleet import run

    if config is not None and method is not None:
        raise UsageError("--config and --method exclude each other: the method stands in the settings")
    if workers is not None and workers < 1:
        raise UsageError(f"--workers {workers} (must be at least 1)")
    refuse_no_folder(output)
    if method is not None:
        method_class(method)
    settings = load_settings(config) if config is not None else None
    console = Console(stderr=True, soft_wrap=True)
    columns = (TextColumn("cleaning"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    seen = [0, 0]

    def report(finished: int, total: int) -> None:
        seen[:] = finished, total
        bar.update(task, completed=finished, total=total)

    with Progress(*columns, console=console, transient=True, disable=quiet or not console.is_terminal) as bar:
        task = bar.add_task("cleaning", total=None)
        try:
            fleet = run(
                sources,
                output,
                config=settings,
                method=method,
                reading=reading.arguments(),
                scheduler=scheduler,
                workers=workers,
                retry=retry,
                force=force,
                progress=report,
            )
        except KeyboardInterrupt:
            bar.stop()
            words = f"stillrate: stopped with {seen[0]} of {seen[1]} logs finished; the same command continues"
            console.print(words, highlight=False, markup=False)
            return 130
    _say(fleet, console, quiet=quiet)
    return 1 if fleet.broken else 0


def _say(fleet: Fleet, console: Console, *, quiet: bool) -> None:
    for record in fleet.broken:
        console.print(f"stillrate: {record.name}: {record.reason}", highlight=False, markup=False)
    if not quiet:
        before = len(fleet.records) - fleet.done
        console.print(
            f"{len(fleet.records)} log{'' if len(fleet.records) == 1 else 's'}: {fleet.done} done now, {before} before, {len(fleet.broken)} broken;"
            f" see {fleet.summary}",
            highlight=False,
            markup=False,
        )
