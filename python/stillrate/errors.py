"""The exceptions of the package."""

from __future__ import annotations


class ConfigError(ValueError):
    """A setting cannot be used; the text names field, value, unit and allowed range.

    Examples
    --------
    >>> from stillrate import Pt1
    >>> try:
    ...     Pt1(sample_rate_hz=-50.0)
    ... except ConfigError as error:
    ...     print(error)
    sample_rate_hz = -50 (must be from 1e-3 to 1e6 Hz)
    """


class LogError(ValueError):
    r"""A log cannot be used; one sentence says which file, which sample, what to do.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from stillrate import read
    >>> path = Path(tempfile.mkdtemp()) / "log.csv"
    >>> _ = path.write_text("gz_dps\n0.1\n0.2\n")
    >>> try:
    ...     read(path)
    ... except LogError as error:
    ...     print(str(error).replace(str(path.parent), "logs"))
    logs/log.csv: no time column among gz_dps: give the rate (--rate HZ) or name it (--time)
    """
