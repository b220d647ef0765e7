"""One log of a fleet: what a worker does with it, and the record that it leaves.

A record stands in ``OUT/records`` as JSON. Its fingerprint is of the log's bytes, the settings and this version: as long as it
matches, the log needs not be done again.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from stillrate import __version__
from stillrate.config import Config
from stillrate.errors import ConfigError, LogError
from stillrate.io.safely import write_text

_LARGEST_RECORD = 10_000_000


@dataclass(frozen=True)
class Task:
    """One log to clean.

    Attributes
    ----------
    name : str
        Path below the common folder, with slashes.
    source, clean, record : str
        Paths of the log, of the clean one, and of the record.
    config : Config, optional
        Settings; from the log's own noise when left out.
    method : str, optional
        Method by name, without settings.
    reading : dict
        Arguments of `stillrate.read`.
    """

    name: str
    source: str
    clean: str
    record: str
    config: Config | None = None
    method: str | None = None
    reading: Mapping[str, Any] = field(default_factory=dict)

    def fingerprint(self) -> str:
        """Return a digest of the log's bytes, the settings and the version of this library."""
        digest = hashlib.sha256()
        settings = None if self.config is None else self.config.to_toml()
        digest.update(json.dumps([__version__, settings, self.method, sorted(self.reading.items())]).encode())
        path = Path(self.source)
        for part in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if part.is_file():
                digest.update(part.name.encode() + b"\0")
                with part.open("rb") as file:
                    digest.update(hashlib.file_digest(file, "sha256").digest())
        return digest.hexdigest()


@dataclass(frozen=True)
class Record:
    """What became of a log.

    Attributes
    ----------
    name : str
        As in the task.
    fingerprint : str
        Of what it was done with; empty if doing it again may end otherwise.
    reason : str
        Why it is broken; empty if it is done.
    samples : int
    sample_rate_hz : float
    channels : list of dict
        A row of the summary for each channel.
    notes : list of str
        What a reader should know about the settings.

    Examples
    --------
    >>> Record("a.csv", reason="the file is empty").broken, Record("b.csv", samples=500).broken
    (True, False)
    """

    name: str
    fingerprint: str = ""
    reason: str = ""
    samples: int = 0
    sample_rate_hz: float = float("nan")
    channels: list[dict[str, Any]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    @property
    def broken(self) -> bool:
        """Whether the log could not be cleaned."""
        return bool(self.reason)


def version() -> str:
    """Return the version that a worker has."""
    return __version__


def work(task: Task, fingerprint: str) -> Record:
    """Clean one log, and say what became of it; never raises for what the log holds."""
    try:
        record = _clean(task, fingerprint)
    except (LogError, ConfigError) as error:
        record = Record(task.name, fingerprint, _words(error, task))
    except (OSError, MemoryError, EOFError) as error:
        record = Record(task.name, "", _words(error, task))
    except (KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # whatever a format's library makes of a damaged file, panics among it
        record = Record(task.name, "", f"{type(error).__name__}: {_words(error, task)}")
    path = Path(task.record)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, json.dumps(dataclasses.asdict(record)), force=True)
    return record


def _clean(task: Task, fingerprint: str) -> Record:
    from stillrate import io
    from stillrate.cleaning import clean, settings_for
    from stillrate.report.figures import axis_figures, remarks

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        log = io.read(task.source, **task.reading)
        configs, notes = settings_for(log, method=task.method, config=task.config)
        done = clean(log, configs, notes=tuple(notes))
        rows = []
        for figures in axis_figures(done):
            counts = done.counts[figures.channel]
            rows.append(
                {
                    "channel": figures.channel,
                    "method": done.configs[figures.channel].method,
                    "noise_density_dps_sqrt_hz": figures.density,
                    "quiet_before_dps": figures.before_dps,
                    "quiet_after_dps": figures.after_dps,
                    "removed_dps": figures.removed_dps,
                    "in_motion": figures.in_motion,
                    "missing": counts.get("MISSING", 0),
                    "saturated": counts.get("SATURATED", 0),
                    "bad_time": counts.get("BAD_TIME", 0),
                }
            )
        said = remarks(done)
    path = Path(task.clean)
    path.parent.mkdir(parents=True, exist_ok=True)
    meta = {**done.clean.meta, "fleet": {"fingerprint": fingerprint}}
    io.write(path, dataclasses.replace(done.clean, meta=meta), force=True)
    return Record(task.name, fingerprint, "", len(log), log.sample_rate_hz, rows, said)


def _words(error: BaseException, task: Task) -> str:
    """Return the reason in one line, without the log's own path."""
    if isinstance(error, OSError) and error.strerror:
        text = error.strerror.lower()
    else:
        text = str(error) or type(error).__name__
    return " ".join(text.removeprefix(f"{task.source}: ").split())[:500]


def read_record(path: Path) -> Record | None:
    """Read a record; None if there is none that can be read."""
    try:
        if path.stat().st_size > _LARGEST_RECORD:
            return None
        found = json.loads(path.read_text(encoding="utf-8"))
        record = Record(**found)
    except (OSError, ValueError, TypeError):
        return None
    fine = isinstance(record.channels, list) and all(isinstance(row, dict) for row in record.channels)
    return record if fine and isinstance(record.reason, str) else None


def would_replace(task: Task, fingerprint: str) -> bool:
    """Whether there is a result that this task would replace by another one."""
    if not Path(task.clean).exists():
        return False
    import polars

    from stillrate.io.parquet import KEY

    try:
        found = polars.read_parquet_metadata(task.clean).get(KEY, "")
    except Exception:  # not Parquet at all
        return True
    return f'"fingerprint": "{fingerprint}"' not in found
