"""Single steps of the gimbal model, for those who build their own estimator or check ours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.gimbal.head import Floats, Head


def rotation_exponential(v: npt.ArrayLike) -> Floats:
    """Return exp(+[v x]) of a rotation vector in rad, shape (3, 3)."""
    return np.asarray(_native.gimbal_rotation(np.asarray(v, dtype=np.float64)))


def _values(coefficients: npt.ArrayLike) -> list[float]:
    found: list[float] = np.asarray(coefficients, dtype=np.float64).tolist()
    return found


def axes(coefficients: npt.ArrayLike, head: Head | None = None) -> tuple[Floats, Floats]:
    """Return gyro axes (gyro, [I, O, S], 3) and accelerometer axes (accelerometer, [a, da/dthp, da/dtho], 3)."""
    gyros, forces = _native.gimbal_axes(_values(coefficients), (head or Head()).settings())
    return np.asarray(gyros), np.asarray(forces)


@dataclass(frozen=True)
class Step:
    """One step of the platform: attitude after it, rate and specific force at its middle, d(rate)/d(coefficients)."""

    rotation: Floats
    rate_rad_s: Floats
    force_m_s2: Floats
    rate_sensitivity: Floats


def step(
    coefficients: npt.ArrayLike,
    rotation: npt.ArrayLike,
    command_rad_s: npt.ArrayLike,
    dt_s: float,
    head: Head | None = None,
) -> Step:
    """Carry an attitude C_np (3, 3) over one command."""
    rotation = np.asarray(rotation, dtype=np.float64)
    command = np.asarray(command_rad_s, dtype=np.float64)
    found = _native.gimbal_step(_values(coefficients), rotation, command, dt_s, (head or Head()).settings())
    return Step(*(np.asarray(part) for part in found))


def output(
    coefficients: npt.ArrayLike, rotation: npt.ArrayLike, head: Head | None = None
) -> tuple[Floats, Floats, Floats]:
    """Return specific force (3,), accelerometer outputs (3,) and their Jacobian (3, 41) in an attitude."""
    rotation = np.asarray(rotation, dtype=np.float64)
    found = _native.gimbal_output(_values(coefficients), rotation, (head or Head()).settings())
    force, value, jacobian = (np.asarray(part) for part in found)
    return force, value, jacobian


def sensitivity(
    coefficients: npt.ArrayLike,
    command_rad_s: npt.ArrayLike,
    dt_s: float,
    epochs: list[int],
    head: Head | None = None,
) -> list[tuple[Floats, Floats]]:
    """Return outputs (3,) and their derivatives (3, 41) by attitude at the start and coefficients at each epoch."""
    command = np.asarray(command_rad_s, dtype=np.float64)
    found = _native.gimbal_sensitivity(_values(coefficients), command, dt_s, list(epochs), (head or Head()).settings())
    return [(np.asarray(value), np.asarray(jacobian)) for value, jacobian in found]
