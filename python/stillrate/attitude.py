"""Rotations as users have them: vectors, matrices, quaternions, Euler angles, and the turning Earth.

Conventions: navigation frame north-east-down, body frame forward-right-down, ``c_b_n`` takes body coordinates to
navigation coordinates; rotation vectors in rad; quaternions scalar first. Everything is computed in the core.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate import _native

Array = npt.NDArray[np.float64]


def _matrix(values: Any) -> list[list[float]]:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (3, 3):
        raise ValueError(f"a rotation matrix must have shape (3, 3), not {array.shape}")
    return [[float(entry) for entry in row] for row in array]


def _vector(values: Any, length: int = 3) -> list[float]:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (length,):
        raise ValueError(f"a vector must have shape ({length},), not {array.shape}")
    return [float(entry) for entry in array]


def exp(rotation_vector: Any) -> Array:
    """Return the rotation matrix of a rotation vector (rad).

    Examples
    --------
    >>> exp([0.0, 0.0, 0.0]).trace()
    np.float64(3.0)
    """
    return _native.rotation_exp(_vector(rotation_vector))


def log(matrix: Any) -> Array:
    """Return the rotation vector (rad, at most pi long) of a rotation matrix, accurate to and past pi.

    Raises
    ------
    ConfigError
        If the matrix is no rotation: not finite, not orthonormal to 1e-6, or a reflection.

    Examples
    --------
    >>> log(exp([0.1, 0.2, 0.3])).round(12).tolist()
    [0.1, 0.2, 0.3]
    """
    return _native.rotation_log(_matrix(matrix))


def right_jacobian(rotation_vector: Any) -> Array:
    """Return Jr(v): Exp(v + d) = Exp(v) Exp(Jr(v) d) to first order in d.

    Examples
    --------
    >>> right_jacobian([0.0, 0.0, 0.0]).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    return _native.right_jacobian(_vector(rotation_vector))


def from_euler(roll_rad: float, pitch_rad: float, yaw_rad: float) -> Array:
    """Return Rz(yaw) Ry(pitch) Rx(roll): C_b_n of a vehicle.

    Examples
    --------
    >>> log(from_euler(0.0, 0.0, 0.5)).round(12).tolist()  # yaw is about "down"
    [0.0, 0.0, 0.5]
    """
    return _native.rotation_from_euler([float(roll_rad), float(pitch_rad), float(yaw_rad)])


def from_quaternion(wxyz: Any) -> Array:
    """Return the rotation matrix of a unit quaternion, scalar first.

    Raises
    ------
    ConfigError
        If its length is not within 0.001 of 1.

    Examples
    --------
    >>> from_quaternion([0.0, 0.0, 0.0, 1.0]).diagonal().tolist()  # half a turn about z
    [-1.0, -1.0, 1.0]
    """
    return _native.rotation_from_quaternion(_vector(wxyz, 4))


def check(matrix: Any, *, project: bool = False) -> Array:
    """Return the matrix if it is a rotation; with `project`, the nearest rotation to a rounded one.

    Raises
    ------
    ConfigError
        If the matrix is not finite, not orthonormal to 1e-6 (with `project`: 0.01), or a reflection.

    Examples
    --------
    >>> rounded = [[0.94, -0.342, 0.0], [0.342, 0.94, 0.0], [0.0, 0.0, 1.0]]
    >>> round(float(log(check(rounded, project=True))[2]), 4)
    0.3489
    """
    return _native.rotation_check(_matrix(matrix), project)


def position(latitude_rad: float, longitude_rad: float) -> Array:
    """Return C_n_e: where north, east and down point in Earth-fixed axes; safe at the poles.

    Examples
    --------
    >>> (position(0.0, 0.0) @ [0.0, 0.0, 1.0]).tolist()  # on the equator, down is towards the axis
    [-1.0, 0.0, 0.0]
    """
    return _native.position_matrix(float(latitude_rad), float(longitude_rad))


def inertial(latitude_rad: float, longitude_rad: float, c_b_n: Any, elapsed_s: float = 0.0) -> Array:
    """Return C_b_i: the attitude in Earth-fixed axes as they stood `elapsed_s` seconds ago, not turning since.

    Examples
    --------
    >>> start, later = (inertial(0.9, 0.1, np.eye(3), elapsed_s=t) for t in (0.0, 10.0))
    >>> round(float(np.linalg.norm(log(relative(start, later)))) / 10.0, 9)  # the rate of the Earth
    7.2921e-05
    """
    return _native.inertial_attitude(float(latitude_rad), float(longitude_rad), _matrix(c_b_n), float(elapsed_s))


def relative(first: Any, second: Any) -> Array:
    """Return first' second: the rotation from one attitude to another.

    Examples
    --------
    >>> log(relative(exp([0.0, 0.0, 0.1]), exp([0.0, 0.0, 0.3]))).round(12).tolist()
    [0.0, 0.0, 0.2]
    """
    return _native.relative_rotation(_matrix(first), _matrix(second))


def preintegrate(rate_rad_s: Any, dt_s: Any, bias_rad_s: Any = (0.0, 0.0, 0.0)) -> tuple[Array, Array]:
    """Integrate body rates, each constant over its time step, with a bias taken off.

    Parameters
    ----------
    rate_rad_s : array_like, shape (n, 3)
        Body rates in rad/s.
    dt_s : float or array_like, shape (n,)
        Time steps in s.
    bias_rad_s : array_like, shape (3,)
        Bias in rad/s.

    Returns
    -------
    rotation : ndarray, shape (3, 3)
        From the body at the end to the body at the start.
    jacobian_s : ndarray, shape (3, 3)
        J in C(b + db) = C(b) Exp(-J db), in s.

    Examples
    --------
    >>> rotation, jacobian_s = preintegrate([[0.0, 0.0, 0.1]] * 100, 0.01)
    >>> log(rotation).round(12).tolist()
    [0.0, 0.0, 0.1]
    """
    rates = np.asarray(rate_rad_s, dtype=np.float64)
    steps = np.broadcast_to(np.asarray(dt_s, dtype=np.float64), rates.shape[:1])
    rotation, jacobian = _native.preintegrate(rates.tolist(), steps.tolist(), _vector(bias_rad_s))
    return rotation, jacobian
