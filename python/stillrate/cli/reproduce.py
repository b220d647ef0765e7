"""`stillrate reproduce`: published figures beside ours."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from stillrate.cli.options import Force, refuse_no_folder, refuse_taken
from stillrate.cli.problems import UsageError

if TYPE_CHECKING:
    from rich.console import Console

    from stillrate.reproduce.row import Row

PIPE_WIDTH = 132
"""Columns where the output is no terminal."""
EVERYTHING = "all"


def command(
    name: str | None = None,
    *,
    output: Annotated[Path | None, Parameter(name=("--output", "-o"))] = None,
    short: bool = False,
    quiet: bool = False,
    force: Force = False,
) -> None:
    """Compute published figures again and print them beside ours.

    Without any argument, the studies are listed. With a name alone, the tables of that study are printed. With `all`,
    `--output` or `--short`, every published figure is a row: reproduced, not reproduced or not reproducible, and why.

    Parameters
    ----------
    name
        Which study, or `all`.
    output
        A folder for the page `reproduced.html` and the file `reproduced.json`.
    short
        Fewer seeds and draws: seconds in place of minutes.
    quiet
        No progress bar.
    """
    from rich.console import Console

    from stillrate.reproduce.all import STUDIES

    # A pipe has no width of its own: tables keep theirs.
    console = Console() if sys.stdout.isatty() else Console(width=PIPE_WIDTH)
    if name is not None and name != EVERYTHING and name not in STUDIES:
        raise UsageError(f"no study {name!r} (one of {', '.join(STUDIES)}, {EVERYTHING})")
    if name == EVERYTHING or output is not None or short:
        wanted = list(STUDIES) if name in (None, EVERYTHING) else [name]
        _rows([study for study in wanted if study], console, output, short=short, quiet=quiet, force=force)
    elif name is None:
        for study, about in STUDIES.items():
            console.print(f"{study:<12} {about.summary}")
        console.print(f"{EVERYTHING:<12} All of them, a row each published figure; -o FOLDER writes a page and JSON.")
    else:
        _tables(STUDIES[name].find(STUDIES[name].tables)(), console)


def _tables(found: Any, console: Console) -> None:
    """Print what a study yields, as it comes."""
    if isinstance(found, (str, Path)):
        console.print(found, markup=False)
    elif isinstance(found, Iterable):
        for part in found:
            console.print(part, markup=False)


def _rows(names: list[str], console: Console, folder: Path | None, *, short: bool, quiet: bool, force: bool) -> None:
    """Run studies under a progress bar, print a table of rows and write the files."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from stillrate.reproduce.all import DATA, PAGE, counts, run, write

    if folder is not None:
        if not folder.absolute().parent.is_dir():
            raise UsageError(f"{folder}: there is no folder {folder.parent}")
        refuse_no_folder(folder)
        if not os.access(folder if folder.exists() else folder.absolute().parent, os.W_OK):
            raise UsageError(f"{folder}: may not be written")
        if folder.is_dir():
            refuse_taken([folder / PAGE, folder / DATA], force=force)
    errors = Console(stderr=True, quiet=quiet)
    columns = (TextColumn("{task.description:<11}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    rows: list[Row] = []
    with Progress(*columns, console=errors, transient=True) as progress:
        task = progress.add_task(names[0], total=len(names))
        for done, name in enumerate(names):
            progress.update(task, completed=done, description=name)

            def advance(part: float, done: int = done) -> None:
                progress.update(task, completed=done + part)

            for _, found in run([name], short=short, advance=advance):
                rows += found
    _print(rows, console)
    console.print(", ".join(f"{count} {verdict}" for verdict, count in counts(rows).items()), highlight=False)
    if folder is not None:
        for path in write(folder, rows, short=short, force=force):
            errors.print(f"wrote {path}", highlight=False, markup=False, soft_wrap=True)


def _print(rows: list[Row], console: Console) -> None:
    from rich import box
    from rich.table import Table

    from stillrate.reproduce.page import number
    from stillrate.reproduce.row import NOT_REPRODUCED, REPRODUCED

    colours = {REPRODUCED: "green", NOT_REPRODUCED: "red"}
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1))
    for head in ("study", "quantity", "published", "ours", "verdict"):
        table.add_column(head, overflow="fold", no_wrap=head == "study")
    for row in rows:
        ours = f"{number(row.ours)} {row.unit}".strip() if row.ours is not None else "–"
        colour = colours.get(row.verdict, "yellow")
        table.add_row(row.study, row.quantity, row.published, ours, f"[{colour}]{row.verdict}[/{colour}]")
    console.print(table)
