"""What a motion lets a filter see: observability of a piecewise constant linear system."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.errors import ConfigError
from stillrate.results import brief

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class WeakDirection:
    """A direction in state space that the measurements leave uncertain.

    Attributes
    ----------
    over_prior : float
        Standard deviation after over before, along it.
    components : dict of str to float
        Its largest components in units of the prior standard deviations, by state.
    """

    over_prior: float
    components: dict[str, float]


@dataclass(frozen=True)
class Observability:
    """What a motion lets a filter see. `riccati_over_prior` is the answer; ranks are a side note.

    Attributes
    ----------
    states : tuple of str
        Names of the states.
    local_ranks, stacked_ranks : tuple of int
        Rank of each segment's matrix, and of the stack (SOM) after each segment, prior-scaled.
    total_rank : int
        Rank of the stack propagated through the segments (TOM).
    singular_values, singular_values_scaled : ndarray
        Of the SOM in the units of the states (they depend on the units), and prior-scaled; descending.
    total_singular_values_scaled : ndarray
        Of the TOM, prior-scaled.
    gramian : ndarray, shape (n, n)
        Sum of F' H' R^-1 H F, referred to the start.
    gramian_eigenvalues : ndarray
        Of the prior-scaled Gramian, ascending; above 1 the data says more than the prior.
    posterior_sigma, posterior_over_prior : ndarray
        Standard deviation of each state from prior and Gramian, without process noise: over-optimistic.
    riccati_over_prior : ndarray
        Standard deviation at the end over the prior, with process noise.
    tenth_of_prior_s : ndarray
        When each state first fell to a tenth of its prior, s; NaN for never.
    weak_directions : tuple of WeakDirection
        Directions that keep more than half their prior, weakest first.

    Examples
    --------
    Of two biases only the sum is measured:

    >>> times = {"duration_s": 10, "interval_s": 0.1}
    >>> found = observability(np.zeros((2, 2)), [[1, 1]], **times, measurement_sigma=0.01, prior_sigma=1, states=("a", "b"))
    >>> found.total_rank, found.riccati_over_prior.round(3).tolist()
    (1, [0.707, 0.707])
    >>> [sorted(weak.components) for weak in found.weak_directions]  # their difference
    [['a', 'b']]
    """

    states: tuple[str, ...]
    local_ranks: tuple[int, ...]
    stacked_ranks: tuple[int, ...]
    total_rank: int
    singular_values: Array
    singular_values_scaled: Array
    total_singular_values_scaled: Array
    gramian: Array
    gramian_eigenvalues: Array
    posterior_sigma: Array
    posterior_over_prior: Array
    riccati_over_prior: Array
    tenth_of_prior_s: Array
    weak_directions: tuple[WeakDirection, ...]

    __repr__ = brief


def observability(
    A: Any,
    H: Any,
    *,
    duration_s: Any,
    interval_s: float,
    measurement_sigma: Any,
    prior_sigma: Any,
    process_density: Any = 0.0,
    states: Sequence[str] | None = None,
) -> Observability:
    """Ranks, singular values, Gramian, and standard deviation over prior of x' = A x, z = H x.

    Parameters
    ----------
    A : array_like, shape (n, n) or (segments, n, n)
        Dynamics in 1/s, constant within each segment.
    H : array_like, shape (m, n) or (segments, m, n)
        Measurement matrix.
    duration_s : float or array_like, shape (segments,)
        Length of each segment in s.
    interval_s : float
        Time between measurements in s; the first comes one interval after the start.
    measurement_sigma : float or array_like, shape (m,)
        Standard deviation of each measured quantity.
    prior_sigma : float or array_like, shape (n,)
        Standard deviation of each state beforehand.
    process_density : float or array_like, shape (n,)
        Process noise density of each state, unit of the state per sqrt(s). Without it the answer is over-optimistic.
    states : sequence of str, optional
        Names of the states.

    Raises
    ------
    ConfigError
        If shapes do not fit or a number has the wrong sign.

    Examples
    --------
    >>> times = {"duration_s": 10, "interval_s": 0.1}
    >>> found = observability([[0, 1], [0, 0]], [[1, 0]], **times, measurement_sigma=0.01, prior_sigma=1)
    >>> found.stacked_ranks, found.weak_directions
    ((2,), ())
    """
    dynamics = np.asarray(A, dtype=np.float64)
    measurement = np.asarray(H, dtype=np.float64)
    if dynamics.ndim not in (2, 3) or measurement.ndim not in (2, 3):
        raise ConfigError(f"A has shape {dynamics.shape} and H {measurement.shape} (must have 2 or 3 dimensions)")
    segments = max(a.shape[0] if a.ndim == 3 else 1 for a in (dynamics, measurement))
    n, m = dynamics.shape[-1], measurement.shape[-2]

    def each(name: str, value: Any, count: int) -> list[float]:
        array = np.asarray(value, dtype=np.float64)
        if array.ndim > 1 or (array.ndim == 1 and array.size != count):
            raise ConfigError(f"{name} has shape {array.shape} (must be a number or ({count},))")
        return [float(x) for x in np.broadcast_to(array, (count,))]

    def stacked(name: str, array: Array) -> Any:
        if array.ndim == 3 and array.shape[0] != segments:
            raise ConfigError(f"{name} has {array.shape[0]} segments where the other has {segments}")
        return np.broadcast_to(array, (segments, *array.shape[-2:])).tolist()

    names = tuple(states) if states is not None else tuple(f"x{k}" for k in range(n))
    if len(names) != n:
        raise ConfigError(f"{len(names)} names for {n} states")
    found = _native.analyse_observability(
        stacked("A", dynamics),
        stacked("H", measurement),
        each("duration_s", duration_s, segments),
        float(interval_s),
        each("measurement_sigma", measurement_sigma, m),
        each("prior_sigma", prior_sigma, n),
        each("process_density", process_density, n),
    )
    weak = tuple(WeakDirection(ratio, _named(names, components)) for ratio, components in found.pop("weak_directions"))
    known = {item.name for item in fields(Observability)}
    values: dict[str, Any] = {n: tuple(v) if isinstance(v, list) else v for n, v in found.items() if n in known}
    return Observability(states=names, weak_directions=weak, **values)


_SHOWN = 0.1
"""Components of a direction smaller than this are not worth a reader's time."""


def _named(names: tuple[str, ...], components: Sequence[float]) -> dict[str, float]:
    pairs = sorted(zip(names, components, strict=True), key=lambda pair: -abs(pair[1]))
    return {name: value for name, value in pairs if abs(value) >= _SHOWN}


def bench_imu(
    roll_rad: float = 0.0,
    pitch_rad: float = 0.0,
    yaw_rad: float = 0.0,
    *,
    latitude_rad: float,
    gravity_m_s2: float = 9.81,
) -> tuple[Array, Array, tuple[str, ...]]:
    """Return A, H and the state names of an IMU at rest on the bench with zero-velocity updates.

    Twelve error states: velocity (m/s) and attitude (rad) in north-east-down, gyro bias (rad/s), accelerometer bias
    (m/s^2).

    Examples
    --------
    >>> A, H, names = bench_imu(latitude_rad=0.8)
    >>> A.shape, H.shape, names[-1]
    ((12, 12), (3, 12), 'baz')
    """
    euler = [float(roll_rad), float(pitch_rad), float(yaw_rad)]
    dynamics, measurement, names = _native.bench_imu_model(euler, float(latitude_rad), float(gravity_m_s2))
    return dynamics, measurement, tuple(names)
