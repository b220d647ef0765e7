"""The exceptions of the package, and the hint at a name that was meant."""

from __future__ import annotations

from collections.abc import Iterable


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


def nearest(name: str, known: Iterable[str], *, among: bool = False) -> str:
    """Return a hint at the known name that comes nearest; with `among`, all of them where none does.

    Examples
    --------
    >>> nearest("cutof_hz", ["cutoff_hz", "quality"])
    ": did you mean 'cutoff_hz'?"
    """
    import difflib

    names = sorted(known)
    near = difflib.get_close_matches(name, names, n=1) or [other for other in names if name and other.startswith(name)]
    if near:
        return f": did you mean {near[0]!r}?"
    return f" (one of {', '.join(names)})" if among else ""
