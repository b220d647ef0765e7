"""Before a run: its bound, its trajectory, and the search for a better one."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.gimbal.head import NAMES, Floats, Head, rows
from stillrate.results import brief


@dataclass(frozen=True)
class Bound:
    """What a run can determine before it is made.

    Attributes
    ----------
    names : tuple of str
        The estimated coefficients.
    standard_deviation : ndarray, shape (n,)
        Cramer-Rao bound, SI.
    singular_values : ndarray, shape (n,)
        Of the sensitivity scaled by prior deviations and noise, largest first.
    directions : ndarray, shape (n, n)
        One direction a row, in the order of the singular values.
    kappa : float
        Bound of kappa, the mean of the three kgI, rad/s per g.
    weakest : tuple
        Weakest directions in words.
    unobservable : tuple of str
        Coefficients whose bound exceeds half their prior deviation.

    Examples
    --------
    >>> import numpy as np
    >>> import stillrate as sr
    >>> still = sr.gimbal.bound(np.zeros((400, 3)))
    >>> "ka0y" in still.unobservable, "ka1x" in still.unobservable  # at rest a bias and a scale error look alike
    (True, True)
    >>> bool(still.singular_values[-1] < 1e-6 * still.singular_values[0])
    True
    """

    names: tuple[str, ...]
    standard_deviation: Floats
    singular_values: Floats
    directions: Floats
    kappa: float
    weakest: tuple[tuple[float, str], ...]
    unobservable: tuple[str, ...]

    __repr__ = brief


def bound(
    command_rad_s: npt.ArrayLike,
    dt_s: float = 0.25,
    *,
    sigma_m_s2: float = 1e-6,
    half_window: int = 2,
    skip_jumps: bool = False,
    head: Head | None = None,
    **options: Any,
) -> Bound:
    """Return the Cramer-Rao bound of a run; `prior` of the head is where it is linearised.

    Parameters
    ----------
    command_rad_s : array_like, shape (n, 3)
        Commanded rates in rad/s.
    dt_s : float
        Time for which a command is held, s.
    sigma_m_s2 : float
        Noise of one accelerometer sample.
    half_window : int
        Samples to either side of an epoch that go into its line.
    skip_jumps : bool
        Leave out epochs at which the command jumps.

    Examples
    --------
    >>> import stillrate as sr
    >>> sr.gimbal.bound(sr.gimbal.trajectory()).unobservable
    ()
    """
    head = dataclasses.replace(head or Head(), **options)
    raw = _native.gimbal_bound(
        rows(command_rad_s), float(dt_s), float(sigma_m_s2), half_window, skip_jumps, head.settings()
    )
    return Bound(
        names=tuple(NAMES[i] for i in raw["indices"]),
        standard_deviation=raw["deviation"][raw["indices"]],
        singular_values=raw["singular_values"],
        directions=raw["directions"],
        kappa=raw["kappa_deviation"],
        weakest=tuple(raw["weakest"]),
        unobservable=tuple(NAMES[i] for i in raw["unobservable"]),
    )


def trajectory(
    segments_deg_s: npt.ArrayLike | None = None,
    *,
    segment_s: float = 75.0,
    slew_deg_s2: float = 0.5,
    dt_s: float = 0.25,
    head: Head | None = None,
) -> Floats:
    """Return the commands (rad/s) of a tumbling programme; by default twelve segments of 75 s at 1 deg/s.

    Parameters
    ----------
    segments_deg_s : array_like, shape (segments, 3), optional
        Rates about the platform axes.

    Examples
    --------
    >>> command = trajectory()
    >>> command.shape  # 900 s, held for 0.25 s each
    (3600, 3)
    """
    segments = None if segments_deg_s is None else rows(segments_deg_s)
    found: Floats = _native.gimbal_trajectory(segments, segment_s, slew_deg_s2, dt_s, (head or Head()).settings())
    return found


@dataclass(frozen=True)
class Plan:
    """Result of `plan`.

    Attributes
    ----------
    segments_deg_s : ndarray, shape (segments, 3)
        Rates about the platform axes, a row a segment.
    before, after : dict
        Worst bounds over a typical coefficient in per cent: drift, g_sensitive, kappa, mounting, accelerometer.

    Examples
    --------
    >>> import stillrate as sr
    >>> found = sr.gimbal.plan(segment_s=20.0, moves=0, climbs=1)  # no search: the standard programme, only faster
    >>> found.segments_deg_s.shape, found.before == found.after
    ((12, 3), True)
    >>> sorted(found.after)
    ['accelerometer', 'drift', 'g_sensitive', 'kappa', 'mounting']
    """

    segments_deg_s: Floats
    before: dict[str, float]
    after: dict[str, float]

    __repr__ = brief


def plan(
    segments_deg_s: npt.ArrayLike | None = None,
    *,
    rate_max_deg_s: float = 1.0,
    slew_deg_s2: float = 0.5,
    segment_s: float = 75.0,
    dt_s: float = 0.25,
    sigma_m_s2: float = 1e-6,
    half_window: int = 2,
    moves: int = 200,
    climbs: int = 2,
    kappa_weight: float = 0.1,
    seed: int = 1,
    head: Head | None = None,
) -> Plan:
    """Search a trajectory with lower bounds within the rate and slew limits.

    Parameters
    ----------
    segments_deg_s : array_like, shape (segments, 3), optional
        Where to start; by default the standard programme.
    rate_max_deg_s, slew_deg_s2 : float
        Limits about each axis.
    segment_s, dt_s : float
        Length of a segment and time for which a command is held, s.
    sigma_m_s2 : float
        Noise of one accelerometer sample.
    half_window : int
        Samples to either side of an epoch that go into its line.
    moves, climbs : int
        Moves of each climb; the first climb starts from the given table, the others from random ones.
    kappa_weight : float
        How much kappa counts against the worst other bound.
    seed : int
        Of the moves: the same seed finds the same trajectory.
    head : Head, optional
        Place, build and what to estimate.

    Raises
    ------
    ConfigError
        If the start cannot be driven.

    Examples
    --------
    >>> import stillrate as sr
    >>> found = sr.gimbal.plan(segment_s=20.0, moves=8, climbs=1, kappa_weight=0.0)
    >>> others = [name for name in found.after if name != "kappa"]
    >>> max(found.after[name] for name in others) <= max(found.before[name] for name in others)
    True
    """
    segments = None if segments_deg_s is None else rows(segments_deg_s)
    limits = (rate_max_deg_s, slew_deg_s2, segment_s, dt_s)
    found, before, after = _native.gimbal_plan(
        segments, limits, (moves, climbs, seed), kappa_weight, (half_window, sigma_m_s2), (head or Head()).settings()
    )
    keys = ("drift", "g_sensitive", "kappa", "mounting", "accelerometer")
    return Plan(np.asarray(found), dict(zip(keys, before, strict=True)), dict(zip(keys, after, strict=True)))
