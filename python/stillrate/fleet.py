"""A folder of logs through Dask: one worker call a log, restartable, a summary of all as Parquet.

``OUT/clean`` holds the clean logs as Parquet, ``OUT/records`` what became of each log, ``OUT/summary.parquet`` one row
a channel and one for each broken log.
"""

from __future__ import annotations

import glob
import logging
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stillrate import __version__
from stillrate.config import Config
from stillrate.errors import LogError
from stillrate.fleet_summary import write_summary
from stillrate.fleet_work import Record, Task, read_record, version, work, would_replace
from stillrate.io import readable
from stillrate.io.safely import first_line, needs

__all__ = ["Fleet", "Progress", "Record", "find_logs", "run"]

SUMMARY = "summary.parquet"
RECORDS = "records"
_PATIENCE_S = 15
_MAGIC = frozenset("*?[")

Progress = Callable[[int, int], None]
"""Is told how many logs are finished, and of how many."""


@dataclass(frozen=True)
class Fleet:
    """What became of the logs.

    Attributes
    ----------
    records : tuple of Record
        One a log, in the order of their names.
    done : int
        Logs that this run worked on; the others were finished before.
    summary : Path
        The table.

    Examples
    --------
    >>> found = Fleet((Record("a.csv", samples=500), Record("b.csv", reason="the file is empty")), 2, Path("summary.parquet"))
    >>> [record.name for record in found.broken]
    ['b.csv']
    """

    records: tuple[Record, ...]
    done: int
    summary: Path

    @property
    def broken(self) -> tuple[Record, ...]:
        """The logs that could not be cleaned, with their reasons."""
        return tuple(record for record in self.records if record.broken)


def find_logs(sources: Sequence[str | Path], out: Path) -> tuple[list[Path], Path]:
    """Return the logs that folders, globs and paths stand for, and the folder that they have in common.

    Results of a fleet are no logs: `out`, and folders below the sources that hold those of another run, are left out.

    Raises
    ------
    LogError
        If there are none.

    Examples
    --------
    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> for name in ("a.csv", "b.ulg", "notes.pdf"):
    ...     (folder / name).touch()
    >>> logs, base = find_logs([folder], folder / "out")
    >>> [log.name for log in logs], base == folder
    (['a.csv', 'b.ulg'], True)
    """
    found: set[Path] = set()
    for source in sources:
        path = Path(source)
        if path.is_dir() and not (path / "metadata.yaml").is_file():
            found.update(_in_folder(path, out))
        elif path.exists() or not _MAGIC & set(str(source)):
            found.add(path)
        else:
            found.update(Path(name) for name in glob.glob(str(source), recursive=True) if not _is_plain_folder(name))
    logs = sorted(Path(os.path.abspath(path)) for path in found)
    if not logs:
        raise LogError(f"no logs in {', '.join(str(source) for source in sources)} (endings: {', '.join(readable())})")
    base = Path(os.path.commonpath([path.parent for path in logs]))
    return logs, base


def _in_folder(folder: Path, out: Path) -> Iterator[Path]:
    """Walk a folder; a ROS 2 bag is a folder itself, results of this run or of another are none of it."""
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or path.resolve() == out.resolve() or _holds_results(path):
            continue
        if path.is_dir() and not (path / "metadata.yaml").is_file():
            yield from _in_folder(path, out)
        elif path.is_dir() or path.suffix.lower() in readable():
            yield path


def _holds_results(path: Path) -> bool:
    return (path / RECORDS).is_dir() and (path / SUMMARY).is_file()


def _is_plain_folder(name: str) -> bool:
    return Path(name).is_dir() and not (Path(name) / "metadata.yaml").is_file()


def run(
    sources: Sequence[str | Path],
    out: str | Path,
    *,
    config: Config | None = None,
    method: str | None = None,
    reading: Mapping[str, Any] | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    retry: bool = False,
    force: bool = False,
    progress: Progress | None = None,
) -> Fleet:
    """Clean many logs; those that were finished with the same content and settings are left alone.

    Parameters
    ----------
    sources : sequence of str or Path
        Folders, globs or logs.
    out : str or Path
        Folder of the results.
    config, method : optional
        Settings or a method by name for all logs; each log's own noise and the recommended method when left out.
    reading : dict, optional
        Arguments of `stillrate.read` for all logs.
    scheduler : str, optional
        Address of a Dask scheduler whose workers see the same folders; a cluster of this machine's cores when left out.
    workers : int, optional
        How many of them.
    retry : bool
        Try broken logs again though nothing changed.
    force : bool
        Replace results of other content or settings.
    progress : callable, optional
        Is told how many logs are finished, and of how many.

    Raises
    ------
    LogError
        If there are no logs, a library is missing, or the scheduler cannot be reached.
    FileExistsError
        If results of other content or settings would be replaced and `force` is not set.

    Examples
    --------
    Here with one worker process; a second run finds everything done.

    >>> import tempfile
    >>> import stillrate as sr
    >>> from stillrate import demo
    >>> folder = Path(tempfile.mkdtemp())
    >>> sr.write(folder / "flight.csv", demo.wave_log(demo.runs()))
    >>> (folder / "empty.csv").touch()
    >>> found = run([folder], folder / "out", method="pt1", workers=1)
    >>> found.done, [(record.name, record.reason) for record in found.broken]
    (2, [('empty.csv', 'the file is empty')])
    >>> run([folder], folder / "out", method="pt1", workers=1).done
    0
    """
    needs("polars", "fleet", "fleet")
    needs("distributed", "fleet", "fleet")
    out = Path(os.path.abspath(out))
    if out.is_dir() and any(out.iterdir()) and not (out / RECORDS).is_dir() and not force:
        raise FileExistsError(f"{out} is not empty and holds no fleet results: name another folder, or --force")
    tasks = _tasks(sources, out, config, method, dict(reading or {}))
    with ThreadPoolExecutor() as pool:
        fingerprints = dict(zip(tasks, pool.map(_fingerprint, tasks.values()), strict=True))
    known = {name: read_record(Path(task.record)) for name, task in tasks.items()}
    finished: dict[str, Record] = {}
    for name, record in known.items():
        if record is not None and record.fingerprint == fingerprints[name] != "":
            if retry if record.broken else not Path(tasks[name].clean).exists():
                continue
            finished[name] = record
    todo = [name for name in tasks if name not in finished]
    stale = [name for name in todo if would_replace(tasks[name], fingerprints[name])]
    if stale and not force:
        raise FileExistsError(
            f"{out} holds results of {len(stale)} logs with other content or settings, such as {stale[0]}:"
            " name another folder, or --force"
        )
    (out / RECORDS).mkdir(parents=True, exist_ok=True)
    if progress is not None:
        progress(len(finished), len(tasks))
    try:
        if todo:
            with _client(scheduler, min(workers or os.cpu_count() or 1, len(todo))) as client:
                for record in _work_all(client, [(tasks[name], fingerprints[name]) for name in todo]):
                    finished[record.name] = record
                    if progress is not None:
                        progress(len(finished), len(tasks))
    finally:
        records = tuple(finished[name] for name in tasks if name in finished)
        write_summary(out / SUMMARY, records)
    return Fleet(records, len(todo), out / SUMMARY)


def _tasks(
    sources: Sequence[str | Path], out: Path, config: Config | None, method: str | None, reading: dict[str, Any]
) -> dict[str, Task]:
    """Return a task for each log by its name."""
    logs, base = find_logs(sources, out)
    tasks = {}
    for path in logs:
        name = path.relative_to(base).as_posix()
        clean, record = out / "clean" / f"{name}.parquet", out / RECORDS / f"{name}.json"
        tasks[name] = Task(name, str(path), str(clean), str(record), config, method, reading)
    return tasks


def _fingerprint(task: Task) -> str:
    """Return a task's fingerprint; empty if the log cannot be read, which the worker will put into words."""
    try:
        return task.fingerprint()
    except OSError:
        return ""


@contextmanager
def _client(scheduler: str | None, workers: int) -> Iterator[Any]:
    """Connect to a scheduler, or start a cluster on this machine for as long as the block runs."""
    distributed = needs("distributed", "fleet", "fleet")
    if scheduler is None:
        # Every worker is one process with one thread: the cores are busy with logs already.
        single = {"POLARS_MAX_THREADS": "1", "RAYON_NUM_THREADS": "1"}
        with (
            distributed.LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                host="127.0.0.1",
                dashboard_address=None,
                # The scheduler opens a port for figures all the same: any free one, lest it complain of a taken one.
                scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
                silence_logs=logging.CRITICAL,
                env=single,
            ) as cluster,
            distributed.Client(cluster) as client,
        ):
            yield client
        return
    try:
        client = distributed.Client(scheduler, timeout=_PATIENCE_S)
    except (OSError, ValueError, ImportError) as error:
        raise LogError(f"{scheduler}: cannot reach the scheduler ({first_line(error)})") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=_PATIENCE_S)
            versions = set(client.run(version).values())
        except TimeoutError:
            raise LogError(f"{scheduler}: the scheduler has no workers") from None
        except Exception as error:  # what a worker without the package raises
            raise LogError(f"{scheduler}: the workers need stillrate {__version__} ({first_line(error)})") from None
        if versions != {__version__}:
            raise LogError(f"{scheduler}: the workers have stillrate {', '.join(sorted(versions))}, not {__version__}")
        yield client


def _work_all(client: Any, jobs: list[tuple[Task, str]]) -> Iterator[Record]:
    """Have the workers do every log, one call each, in whatever order they finish."""
    distributed = needs("distributed", "fleet", "fleet")
    futures = {client.submit(work, task, fingerprint, pure=False): task for task, fingerprint in jobs}
    for future in distributed.as_completed(futures):
        try:
            record: Record = future.result()
        except Exception as error:  # the worker died, or cannot see the folder
            record = Record(futures[future].name, "", f"{type(error).__name__}: {first_line(error)}")
        yield record
