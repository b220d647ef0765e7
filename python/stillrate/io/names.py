"""Which column is what: time, gyro axes, their units, from the names that loggers give them."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from dataclasses import dataclass

from stillrate.errors import ConfigError, LogError

RAD_S = 57.29577951308232
"""deg/s in one rad/s."""
RATE_UNITS = {"deg/s": 1.0, "dps": 1.0, "rad/s": RAD_S, "rad_s": RAD_S, "mdps": 1e-3}
"""deg/s in one of each unit that a caller may name."""
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
"""Seconds in one of each unit of time that a caller may name."""
_LISTED = 12

_RATE_UNIT_WORDS = (
    (r"m(illi)?dps|mdeg/s(ec)?", 1e-3),
    (r"dps|deg(ree)?s?[ _./]*(/|per|p)?[ _]*s(ec(ond)?)?(\^?-1)?|°/s(ec)?|º/s(ec)?|deg_s", 1.0),
    (r"rad(ian)?s?[ _./]*(/|per|p)?[ _]*s(ec(ond)?)?(\^?-1)?|rad_s", RAD_S),
)
_GYRO = (
    r"g|gyr|gyro|gyros|gyroscope|gyroscopes|gyro_?rad|gyroadc|gyrounfilt|gyro_?data|gyro_?rotation|gyrorotation"
    r"|angular_?velocity|angular_?rate|ang_?vel|angvel|rotation_?rate|rot_?rate|omega|w|rate"
)
_AXIS = re.compile(
    rf"(?:^|_)(?P<family>{_GYRO})_?(?P<axis>[xyz012])(?:_(?P<kind>meas|measured|raw|cal|calibrated|filt))?$"
)
_AXIS_FIRST = re.compile(r"(?:^|_)(?P<axis>[xyz])_?(?P<family>gyro|gyr|gyroscope|angular_?velocity|angular_?rate)$")
_NAMED_AXES = {
    "roll_rate": "x",
    "pitch_rate": "y",
    "yaw_rate": "z",
    "rollspeed": "x",
    "pitchspeed": "y",
    "yawspeed": "z",
}
_ALONE = re.compile(r"(?:^|_)(rate|gyro|gyr|gyroscope|omega|angular_?rate|angular_?velocity|value|signal)$")
_ROS = re.compile(r"angular_?velocity")
_ACCELERATION = re.compile(
    r"(?:^|_)(?:a|acc|accel|accelerometer|acceleration|linear_?acceleration)_?([xyz])(?:_(?:meas|raw))?$"
)
_TIME = re.compile(
    r"^(?:.*_)?(?:t|ts|time|timestamp|stamp|datetime|date_?time|utc|clock|elapsed|time_?stamp|epoch|sampletime"
    r"|time_since_start|gyrotimestamp.*|loggingtime.*|seconds_elapsed|secs|seconds)$"
)
_TIME_UNIT_WORDS = (
    (r"(?:_|^|\b)(?:ns|nsec|nanos|nanosec|nanoseconds)$", 1e-9),
    (r"(?:_|^|\b)(?:us|usec|micros|microsec|microseconds|µs|μs)$", 1e-6),
    (r"(?:_|^|\b)(?:ms|msec|millis|millisec|milliseconds)$", 1e-3),
    (r"(?:_|^|\b)(?:s|sec|secs|second|seconds)$", 1.0),
)


@dataclass(frozen=True)
class Axis:
    """A column that looks like a gyro axis."""

    name: str
    group: str
    axis: str
    kind: str
    factor: float | None
    ros: bool


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", name.lower().replace("[", "_").replace("(", "_")).strip("_")


def rate_unit(name: str) -> tuple[str, float | None]:
    """Return the name without its unit, and deg/s per unit (None if the name has none)."""
    lower = name.lower()
    for pattern, factor in _RATE_UNIT_WORDS:
        found = re.search(rf"[\[(_ ,./]+(?:{pattern})[\])]*$", lower)
        if found:
            return name[: found.start()], factor
    return name, None


def gyro_axis(name: str) -> Axis | None:
    """Recognise a gyro axis by its column name."""
    stem, factor = rate_unit(name)
    plain = _plain(stem)
    if re.search(r"(?:^|_)(true|truth|ref|reference|bias|offset)(?:_|$)", plain):
        return None
    found = _AXIS.search(plain) or _AXIS_FIRST.search(plain)
    if found is None:
        short = re.sub(r"^(imu\d*|sensor|vehicle|attitude)_", "", plain)
        if short not in _NAMED_AXES:
            return None
        return Axis(name, "named", _NAMED_AXES[short], "", factor, False)
    axis = {"0": "x", "1": "y", "2": "z"}.get(found["axis"], found["axis"])
    kind = found.groupdict().get("kind") or ""
    group = plain[: found.start("family")] + found["family"]
    return Axis(name, group, axis, kind, factor, bool(_ROS.search(plain)))


def best_axes(names: list[str]) -> list[Axis]:
    """Choose the columns of one gyro: complete, with a unit, measured rather than nameless, first in the file."""
    groups: dict[tuple[str, str, float | None], dict[str, Axis]] = {}
    for name in names:
        axis = gyro_axis(name)
        if axis is not None:
            groups.setdefault((axis.group, axis.kind, axis.factor), {}).setdefault(axis.axis, axis)
    order = {"": 1, "meas": 2, "measured": 2, "cal": 2, "calibrated": 2, "filt": 0, "raw": 0}
    vague = {"w", "rate", "g"}

    def merit(item: tuple[tuple[str, str, float | None], dict[str, Axis]]) -> tuple[int, int, int, int]:
        (group, kind, factor), axes = item
        return len(axes), int(factor is not None), order.get(kind, 1), int(group not in vague)

    if not groups:
        return []
    _, axes = max(groups.items(), key=merit)
    return sorted(axes.values(), key=lambda axis: names.index(axis.name))


def lone_rate(names: list[str]) -> str | None:
    """Return the only column that is called rate, gyro or the like."""
    found = [name for name in names if _ALONE.search(_plain(rate_unit(name)[0]))]
    return found[0] if len(found) == 1 else None


def acceleration_columns(names: list[str]) -> list[str]:
    """Return the columns of an accelerometer, by name."""
    found: dict[str, str] = {}
    for name in names:
        match = _ACCELERATION.search(_plain(re.sub(r"[\[(].*$", "", name)))
        if match:
            found.setdefault(match[1], name)
    return list(found.values()) if len(found) == 3 else []


def time_unit(name: str) -> float | None:
    """Return seconds per unit of a time column, None if its name does not say."""
    lower = name.lower().strip().rstrip(")]} ")
    for pattern, factor in _TIME_UNIT_WORDS:
        if re.search(pattern, re.sub(r"[\[(\s]+", "_", lower)):
            return factor
    return None


def time_column(names: list[str]) -> str | None:
    """Return the time column by name: the first that says it is one, with a unit rather than without."""
    found = [name for name in names if is_time(name)]
    with_unit = [name for name in found if time_unit(name) is not None]
    return next(iter([*with_unit, *found]), None)


def is_time(name: str) -> bool:
    """Whether a column's name says that it is time."""
    plain = re.sub(r"[\[(].*$", "", name.lower()).strip().strip("%#").strip()
    plain = re.sub(r"[^a-zµμ0-9]+", "_", plain).strip("_")
    if _TIME.match(plain):
        return True
    stem = re.sub(r"_(ns|us|ms|s|nsec|usec|msec|sec|secs|seconds|millis|micros|nanos)$", "", plain)
    return stem != plain and bool(_TIME.match(stem))


def check_units(unit: str | None, time_unit: str | None) -> None:
    """Raise ConfigError if a unit that a caller named is none that is known."""
    if unit is not None and unit not in RATE_UNITS:
        raise ConfigError(f"unit = {unit!r} (must be one of {', '.join(RATE_UNITS)})")
    if time_unit is not None and time_unit not in TIME_UNITS:
        raise ConfigError(f"time_unit = {time_unit!r} (must be one of {', '.join(TIME_UNITS)})")


def listed(columns: Iterable[str]) -> str:
    """Return the names of columns in a line, the first dozen of many.

    Examples
    --------
    >>> listed(f"gyro{k}" for k in range(14))[-17:]
    'gyro11 and 2 more'
    """
    found = list(columns)
    return ", ".join(found[:_LISTED]) + (f" and {len(found) - _LISTED} more" if len(found) > _LISTED else "")


def no_column(name: str, columns: Iterable[str]) -> LogError:
    """Return the error for a name that no column has: the one that comes nearest, or all there are.

    Examples
    --------
    >>> no_column("gyroz", ["t_s", "gyro_z"])
    LogError("no column 'gyroz': did you mean 'gyro_z'?")
    """
    known = list(columns)
    near = difflib.get_close_matches(name, known, n=1)
    return LogError(
        f"no column {name!r}" + (f": did you mean {near[0]!r}?" if near else f" (there are {listed(known)})")
    )
