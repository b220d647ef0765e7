"""Options that several commands share."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from stillrate.cli.problems import UsageError

if TYPE_CHECKING:
    from stillrate.config import Config
    from stillrate.io import Log


@Parameter(name="*", group="Reading the log")
@dataclass(frozen=True, kw_only=True)
class ReadOptions:
    """How to read a log where its names do not say.

    Attributes
    ----------
    rate: float
        Nominal sample rate in Hz; needed if there is no time column.
    columns: str
        The columns to filter, separated by commas.
    time: str
        The time column.
    unit: str
        Unit of the rates: deg/s, rad/s or mdps.
    time_unit: str
        Unit of the time column: s, ms, us or ns.
    """

    rate: float | None = None
    columns: str | None = None
    time: str | None = None
    unit: str | None = None
    time_unit: str | None = None

    def read(self, path: Path) -> Log:
        """Read a log with these options."""
        from stillrate.io import read

        return read(path, **self.arguments())

    def arguments(self) -> dict[str, Any]:
        """Return the options as arguments of `stillrate.read`."""
        columns = [name.strip() for name in self.columns.split(",")] if self.columns else None
        return {
            "rate_hz": self.rate,
            "columns": columns,
            "time": self.time,
            "unit": self.unit,
            "time_unit": self.time_unit,
        }


Force = Annotated[bool, Parameter(help="Overwrite existing files.")]
"""An option of every command that writes."""


def refuse_taken(paths: list[Path], *, force: bool) -> None:
    """Say before the work begins that an output cannot be written."""
    from stillrate.io.safely import refuse_existing

    for index, path in enumerate(paths):
        if any(path == other for other in paths[:index]):
            raise UsageError(f"{path}: named twice as an output")
        if not path.parent.is_dir():
            raise UsageError(f"{path}: there is no folder {path.parent}")
        refuse_existing(path, force=force)


def refuse_no_folder(path: Path) -> None:
    """Say before the work begins that an output cannot be the folder that it must be."""
    if path.exists() and not path.is_dir():
        raise UsageError(f"{path} is a file (must be a folder)")


def latitude_rad(latitude_deg: float) -> float:
    """Return a latitude that was given in degrees; what is wrong with it is said in degrees."""
    if not -90.0 <= latitude_deg <= 90.0:
        raise UsageError(f"--latitude-deg {latitude_deg:g} (must be from -90 to 90)")
    return math.radians(latitude_deg)


def load_settings(path: Path) -> Config:
    """Read a configuration; what is wrong with it names the file."""
    from stillrate.config import load_config
    from stillrate.errors import ConfigError

    try:
        return load_config(path)
    except ConfigError as error:
        text = str(error)
        raise ConfigError(text if text.startswith(str(path)) else f"{path}: {text}") from None
