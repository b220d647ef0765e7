"""How a line of text is laid out: which fields are rates, which one is time, what is passed on as it came.

Fields are separated by commas, semicolons, tabs or blanks. A first line of names is a header; blank lines and those that
begin with ``#`` are passed on. An empty field, or one that says nan or NA, is a missing sample.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from stillrate.errors import LogError
from stillrate.io import names as known

_MISSING = frozenset((b"", b"nan", b"NaN", b"NAN", b"NA", b"null", b"None", b"-"))


@dataclass(frozen=True, slots=True)
class Row:
    """A line taken apart: its fields, rates in deg/s, and the time stamp as it stands."""

    fields: list[bytes]
    values: list[float]
    stamp: bytes | None


class LineFormat:
    """Layout of the lines, from what the caller says, a header, or the first line of numbers.

    Parameters
    ----------
    columns : sequence of str, optional
        The rates, by position from 1 or by name; all fields with numbers, or those that a header calls a gyro, when left
        out.
    time : str, optional
        The time stamp, by position or name.
    unit : str, optional
        Unit of the rates, deg/s, rad/s or mdps; from the header or deg/s when left out.
    time_unit : str, optional
        Unit of the stamps, s, ms, us or ns; from the header or the rate when left out.

    Attributes
    ----------
    names : list of str
        The channels, once the layout is known.
    time_unit_s : float or None
        Seconds per unit of the stamps, where it was said.

    Raises
    ------
    LogError
        For a unit that is not known, and from `parse` or `passes` for columns that are not there.

    Examples
    --------
    >>> layout = LineFormat(columns=["2"])
    >>> row = layout.parse(b"17;0.25;ok")
    >>> row.values, layout.format(row, [0.2])
    ([0.25], b'17;0.2;ok')

    A header says it all; it is passed on, and after it the layout is ready.

    >>> layout = LineFormat()
    >>> layout.passes(b"time_ms,gz_rad_s"), layout.ready, layout.has_time, layout.names
    (True, True, True, ['gz_rad_s'])
    >>> layout.passes(b"20,0.5"), round(layout.parse(b"20,0.5").values[0], 3)
    (False, 28.648)
    """

    def __init__(
        self,
        columns: Sequence[str] | None = None,
        time: str | None = None,
        unit: str | None = None,
        time_unit: str | None = None,
    ) -> None:
        self._wanted = list(columns) if columns else None
        self._wanted_time = time
        known.check_units(unit, time_unit)
        self._unit = None if unit is None else known.RATE_UNITS[unit]
        self.time_unit_s = None if time_unit is None else known.TIME_UNITS[time_unit]
        self._positions: list[int] = []
        self._factors: list[float] = []
        self._width = 0
        self._time: int | None = None
        self._separator = b","
        self._fresh = True
        self._sure = False
        self.names: list[str] = []

    @property
    def ready(self) -> bool:
        """Whether the layout is known."""
        return self._width > 0

    @property
    def has_time(self) -> bool:
        """Whether a field is a time stamp."""
        return self._time is not None

    def passes(self, line: bytes) -> bool:
        """Whether a line holds no sample: blank, a comment, or the header (which is then taken in)."""
        if not line.strip() or line.lstrip().startswith(b"#"):
            return True
        if not self._fresh:
            return False
        self._fresh = False
        return self._header(line)

    def parse(self, line: bytes) -> Row | None:
        """Take a line apart; None if it is malformed."""
        separator, fields = _split(line)
        # A layout that only one line has shown may be that of a scrap: a longer line says otherwise.
        if not self._sure and len(fields) > self._width:
            numeric = [index for index, field in enumerate(fields) if _number(field) is not None]
            if not numeric:
                return None
            self._settle(separator, [], len(fields), numeric)
        elif len(fields) != self._width:
            return None
        else:
            self._sure = True
        values = []
        for position, factor in zip(self._positions, self._factors, strict=True):
            value = _number(fields[position])
            if value is None:
                return None
            values.append(value if factor == 1.0 else value * factor)
        return Row(fields, values, None if self._time is None else fields[self._time])

    def format(self, row: Row | None, rates: Sequence[float]) -> bytes:
        """Return a line with the rates in their places and all other fields as they came (empty if there was no row)."""
        fields = [b""] * self._width if row is None else list(row.fields)
        for position, factor, rate in zip(self._positions, self._factors, rates, strict=True):
            fields[position] = repr(rate if factor == 1.0 else rate / factor).encode()
        if self._separator == b" " and row is None:
            fields = [field or b"nan" for field in fields]
        return self._separator.join(fields)

    def _header(self, line: bytes) -> bool:
        separator, fields = _split(line)
        try:
            names = [field.decode().strip().strip('"') for field in fields]
        except UnicodeDecodeError:
            return False
        if any(_number(field) is not None for field in fields) or not all(name[:1].isalpha() for name in names):
            return False
        recognised = known.best_axes(names) or known.lone_rate(names) or known.time_column(names)
        if not recognised and not any(name in names for name in [*(self._wanted or ()), self._wanted_time]):
            return False
        self._settle(separator, names, len(names), range(len(names)))
        self._sure = True
        return True

    def _settle(self, separator: bytes, names: list[str], width: int, numeric: Iterable[int]) -> None:
        """Decide which field is what; `numeric` are those that may be rates."""
        time = self._wanted_time
        if time is None and names:
            time = known.time_column(names)
        self._time = None if time is None else _position(time, names, width)
        if self._time is not None and names and self.time_unit_s is None:
            self.time_unit_s = known.time_unit(names[self._time])
        if self._wanted is not None:
            positions = [_position(name, names, width) for name in self._wanted]
        elif axes := known.best_axes(names):
            positions = [names.index(axis.name) for axis in axes]
        elif lone := known.lone_rate(names):
            positions = [names.index(lone)]
        else:
            positions = [index for index in numeric if index != self._time]
        if not positions or len(set(positions)) < len(positions) or self._time in positions:
            raise LogError("no field is left for the rates (--columns names them, each once, without the time)")
        self._positions, self._width, self._separator = positions, width, separator
        self.names = [names[index] if names else f"column {index + 1}" for index in positions]
        units = [known.rate_unit(names[index])[1] if names else None for index in positions]
        self._factors = [self._unit or unit or 1.0 for unit in units]


def _split(line: bytes) -> tuple[bytes, list[bytes]]:
    for separator in (b",", b";", b"\t"):
        if separator in line:
            return separator, [field.strip() for field in line.split(separator)]
    return b" ", line.split()


def _number(field: bytes) -> float | None:
    """Return a field's number, NaN if it says that there is none, None if it is neither."""
    try:
        if b"_" not in field:
            return float(field)
    except ValueError:
        pass
    return math.nan if field in _MISSING else None


def _position(name: str, names: list[str], width: int) -> int:
    """Find a column by name or by its place from 1."""
    if name in names:
        return names.index(name)
    if name.isdecimal() and 1 <= int(name) <= width:
        return int(name) - 1
    if name.isdecimal():
        raise LogError(f"no column {name}: the lines have {width}")
    if not names:
        raise LogError(f"no column {name!r}: the lines have no header, give positions from 1 to {width}")
    raise known.no_column(name, names)
