"""A table of columns into a log: which column is time, which are rates, in which unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate.errors import ConfigError, LogError
from stillrate.io import names as known
from stillrate.io.log import Floats, Layout, Log


@dataclass(frozen=True)
class Table:
    """Columns of one length, as a file holds them."""

    columns: dict[str, npt.NDArray[Any]]
    meta: dict[str, Any] = field(default_factory=dict)
    extras: dict[str, Any] = field(default_factory=dict)
    style: dict[str, Any] = field(default_factory=dict)
    first_line: int | None = None


@dataclass(frozen=True)
class Wishes:
    """What a caller says about a file, against what its names say.

    Attributes
    ----------
    rate_hz : float, optional
        Nominal sample rate; needed when there is no time column.
    columns : sequence of str, optional
        The columns to take as rates.
    time : str, optional
        The time column.
    unit : str, optional
        Unit of the rates: "deg/s", "rad/s" or "mdps".
    time_unit : str, optional
        Unit of the time column: "s", "ms", "us" or "ns".
    """

    rate_hz: float | None = None
    columns: Sequence[str] | None = None
    time: str | None = None
    unit: str | None = None
    time_unit: str | None = None

    def check(self) -> None:
        """Raise ConfigError if a wish has no meaning."""
        known.check_units(self.unit, self.time_unit)
        if self.rate_hz is not None and not (np.isfinite(self.rate_hz) and self.rate_hz > 0):
            raise ConfigError(f"rate_hz = {self.rate_hz:g} (must be finite and > 0 Hz)")


def to_log(table: Table, wishes: Wishes) -> Log:
    """Find time and rates in a table.

    Raises
    ------
    LogError
        If there is no rate column, no time base, or a value is no number; the text says what was found.
    """
    wishes.check()
    columns = table.columns
    count = len(next(iter(columns.values()))) if columns else 0
    if count == 0:
        raise LogError("no samples in it")
    notes: list[str] = []
    time = _time_column(table, wishes)
    chosen = _rate_columns(columns, time, wishes)
    factors = _factors(columns, chosen, wishes, notes)
    rates = np.empty((count, len(chosen)))
    for index, name in enumerate(chosen):
        rates[:, index] = _numbers(table, name)
        if factors[name] != 1.0:
            rates[:, index] *= factors[name]
    if not np.isfinite(rates).any():
        raise LogError(f"no number in {', '.join(chosen)}: every sample is missing")
    meta = dict(table.meta)
    t_s, start = _time(table, time, count, wishes, notes)
    if start is not None:
        meta["start_s"] = start
    if notes:
        meta["notes"] = [*meta.get("notes", []), *notes]
    layout = Layout(
        order=tuple(columns),
        time=time,
        stamps=None if time is None else columns[time],
        factors=factors,
        original={name: columns[name] for name in chosen},
        extras=table.extras,
        style=table.style,
    )
    return Log(
        t_s=t_s,
        rate_dps=rates,
        channels=tuple(chosen),
        sample_rate_hz=wishes.rate_hz or float("nan"),
        columns={name: values for name, values in columns.items() if name not in chosen and name != time},
        meta=meta,
        layout=layout,
    )


def _present(columns: Mapping[str, Any], name: str) -> str:
    if name in columns:
        return name
    raise known.no_column(name, columns)


def _time_column(table: Table, wishes: Wishes) -> str | None:
    if wishes.time is not None:
        return _present(table.columns, wishes.time)
    taken = set(wishes.columns or ())
    candidates = [name for name, values in table.columns.items() if name not in taken and values.ndim == 1]
    found = known.time_column(candidates)
    if found is None and table.style.get("named") is False and len(candidates) > 1:
        # Without names: a first column that only ever increases is time.
        values = table.columns[candidates[0]]
        if _is_numeric(values) and len(values) > 2 and bool(np.all(np.diff(values) > 0)):
            return candidates[0]
    return found


def _rate_columns(columns: Mapping[str, npt.NDArray[Any]], time: str | None, wishes: Wishes) -> list[str]:
    if wishes.columns:
        if again := [name for index, name in enumerate(wishes.columns) if name in wishes.columns[:index]]:
            raise LogError(f"column {again[0]!r} named twice")
        return [_present(columns, name) for name in wishes.columns]
    rest = [name for name, values in columns.items() if name != time and values.ndim == 1]
    axes = known.best_axes(rest)
    if axes:
        return [axis.name for axis in axes]
    lone = known.lone_rate(rest)
    if lone is not None:
        return [lone]
    numeric = [name for name in rest if _is_numeric(columns[name])]
    unnamed = all(name.startswith("column_") for name in rest)
    if len(numeric) == 1 or (unnamed and len(numeric) <= 3 and numeric):
        return numeric
    raise LogError(f"no gyro column among {known.listed(columns)}: name them (--columns a,b,c)")


def _factors(
    columns: Mapping[str, npt.NDArray[Any]], chosen: Sequence[str], wishes: Wishes, notes: list[str]
) -> dict[str, float]:
    if wishes.unit is not None:
        return dict.fromkeys(chosen, known.RATE_UNITS[wishes.unit])
    named = {name: known.rate_unit(name)[1] for name in chosen}
    if all(factor is not None for factor in named.values()):
        return {name: factor for name, factor in named.items() if factor is not None}
    guess, reason = 1.0, "deg/s, the unit is not in the name"
    axes = [known.gyro_axis(name) for name in chosen]
    if any(axis is not None and axis.ros for axis in axes):
        guess, reason = known.RAD_S, "rad/s, as ROS has angular velocities"
    elif _si_accelerometer(columns):
        guess, reason = known.RAD_S, "rad/s, since the accelerometer is in m/s^2"
    notes.append(f"rates taken as {reason} (--unit says otherwise)")
    return {name: guess if factor is None else factor for name, factor in named.items()}


def _si_accelerometer(columns: Mapping[str, npt.NDArray[Any]]) -> bool:
    """Whether an accelerometer shows about 9.8 (m/s^2) rather than 1 (g)."""
    found = known.acceleration_columns(list(columns))
    if not found or not all(_is_numeric(columns[name]) for name in found):
        return False
    norm = np.sqrt(np.sum(np.square([np.asarray(columns[name], float) for name in found]), axis=0))
    return 7.0 < float(np.nanmedian(norm)) < 13.0


def _is_numeric(values: npt.NDArray[Any]) -> bool:
    return values.dtype.kind in "iuf"


def _numbers(table: Table, name: str) -> Floats:
    values = table.columns[name]
    if _is_numeric(values) or values.dtype.kind == "b":
        return values.astype(np.float64)
    for index, word in enumerate(values):
        try:
            float(str(word).strip().replace(",", ".") or "nan")
        except ValueError:
            where = f"line {table.first_line + index}" if table.first_line else f"sample {index}"
            advice = "correct or delete that row, or choose other columns (--columns)"
            raise LogError(f"{where}: {str(word)[:40]!r} in {name} is no number: {advice}") from None
    return np.array([float(str(word).strip().replace(",", ".") or "nan") for word in values])


def _time(table: Table, time: str | None, count: int, wishes: Wishes, notes: list[str]) -> tuple[Floats, float | None]:
    if time is None:
        if wishes.rate_hz is None:
            raise LogError(
                f"no time column among {known.listed(table.columns)}: give the rate (--rate HZ) or name it (--time)"
            )
        return np.arange(count) / wishes.rate_hz, None
    stamps = table.columns[time]
    if stamps.dtype.kind in "USO":
        stamps = _dates(table, time)
    if stamps.dtype.kind == "M":
        whole = stamps.astype("datetime64[ns]").astype(np.int64)
        unit = 1e-9
        missing = np.isnat(stamps)
    else:
        whole = stamps
        missing = ~np.isfinite(stamps)
        unit = _time_unit(time, stamps, wishes, notes)
    if missing.all():
        raise LogError(f"no number in the time column {time}")
    first = whole[np.argmin(missing)]
    # The difference first: stamps in ns since 1970 do not fit a float.
    t_s = (whole - first).astype(np.float64) * unit if unit != 1.0 else (whole - first).astype(np.float64)
    if missing.any():
        t_s[missing] = np.nan
    return t_s, float(first) * unit


def _dates(table: Table, time: str) -> npt.NDArray[Any]:
    words = [str(word).strip().removesuffix("Z") for word in table.columns[time]]
    try:
        return np.array(words, dtype="datetime64[ns]")
    except ValueError:
        return _numbers(table, time)


def _time_unit(name: str, stamps: npt.NDArray[Any], wishes: Wishes, notes: list[str]) -> float:
    if wishes.time_unit is not None:
        return known.TIME_UNITS[wishes.time_unit]
    named = known.time_unit(name)
    if named is not None:
        return named
    steps = np.diff(stamps)
    steps = steps[steps > 0]
    step = float(np.median(steps)) if len(steps) else 1.0
    rate = wishes.rate_hz
    if rate is not None:
        # The unit that comes nearest to the rate that was said.
        unit = min(known.TIME_UNITS.values(), key=lambda unit: float(abs(np.log(step * unit * rate))))
    else:
        # Gyro logs lie between 2 Hz and 20 kHz, most of them above 10 Hz.
        unit = next(u for limit, u in ((0.6, 1.0), (100.0, 1e-3), (1e5, 1e-6), (np.inf, 1e-9)) if step <= limit)
    if unit != 1.0:
        word = next(word for word, value in known.TIME_UNITS.items() if value == unit)
        notes.append(f"time taken as {word} (median step {step:g}; --time-unit says otherwise)")
    return unit
