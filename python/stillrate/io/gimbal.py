"""Logs of a gimballed head: commands and accelerometers, in one npz or in two tables.

An npz holds ``command_rad_s`` (n, 3) and ``specific_force_m_s2`` (n m + 1, 3), and ``dt_s`` where it is known. A table has a
column ``t_s`` and three columns an axis: ``wx_rad_s wy_rad_s wz_rad_s`` (commands) or ``ax_m_s2 ay_m_s2 az_m_s2`` (accelerometers).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from stillrate.errors import LogError
from stillrate.io import delimited, npz
from stillrate.io.log import Floats
from stillrate.io.table import Table

_COMMAND = (("wx_rad_s", "wy_rad_s", "wz_rad_s"), ("wx", "wy", "wz"))
_FORCE = (("ax_m_s2", "ay_m_s2", "az_m_s2"), ("ax", "ay", "az"))
_LEAST_TIMES = 3
# Two time stamps may differ from a regular grid by this share of a step.
_JITTER = 0.01


@dataclass(frozen=True)
class GimbalLog:
    """Commands (n, 3), samples (n m + 1, 3), and the time for which a command is held."""

    command_rad_s: Floats
    specific_force_m_s2: Floats
    dt_s: float | None


def read(command: Path, force: Path | None) -> GimbalLog:
    """Read one npz, or a table of commands and one of accelerometers.

    Raises
    ------
    LogError
        If a file cannot be read or does not hold what is needed.
    """
    if force is None:
        if command.suffix.lower() != ".npz":
            raise LogError(f"{command}: commands and accelerometers in one file must be an npz (else give two tables)")
        return _from_npz(command)
    step, commands = _from_table(command, _COMMAND)
    _, samples = _from_table(force, _FORCE)
    return GimbalLog(commands, samples, step)


def _from_npz(path: Path) -> GimbalLog:
    try:
        arrays = npz.arrays(path)
    except LogError as error:
        raise LogError(f"{path}: {error}") from None
    missing = [name for name in ("command_rad_s", "specific_force_m_s2") if name not in arrays]
    if missing:
        raise LogError(f"{path}: no {missing[0]} (there are {', '.join(sorted(arrays)) or 'no arrays'})")
    for name in ("command_rad_s", "specific_force_m_s2"):
        if arrays[name].ndim != 2 or arrays[name].shape[1] != 3 or arrays[name].dtype.kind not in "fiu":
            raise LogError(f"{path}: {name} has shape {arrays[name].shape} (must be numbers, (n, 3))")
    step = arrays.get("dt_s")
    return GimbalLog(
        arrays["command_rad_s"].astype(np.float64),
        arrays["specific_force_m_s2"].astype(np.float64),
        None if step is None else float(np.ravel(step)[0]),
    )


def _from_table(path: Path, names: tuple[tuple[str, ...], ...]) -> tuple[float | None, Floats]:
    try:
        table: Table = npz.read(path) if path.suffix.lower() == ".npz" else delimited.read(path)
    except LogError as error:
        text = str(error)
        raise LogError(text if text.startswith(str(path)) else f"{path}: {text}") from None
    columns = table.columns
    for wanted in names:
        if all(name in columns for name in wanted):
            rows = np.column_stack([np.asarray(columns[name], dtype=np.float64) for name in wanted])
            return _step(path, columns.get("t_s")), rows
    raise LogError(f"{path}: no columns {', '.join(names[0])} (there are {', '.join(columns)})")


def _step(path: Path, time: npt.NDArray[np.float64] | None) -> float | None:
    """Step of a regular time column."""
    if time is None or len(time) < _LEAST_TIMES:
        return None
    steps = np.diff(np.asarray(time, dtype=np.float64))
    step = float(np.median(steps))
    wrong = np.flatnonzero(~(abs(steps - step) <= _JITTER * step))
    if step <= 0 or len(wrong):
        at = int(wrong[0]) + 1 if len(wrong) else 1
        raise LogError(
            f"{path}: row {at + 1}: t_s is not regular (a step of {steps[at - 1]:.6g} s among steps of {step:.6g} s)"
        )
    return step
