"""Continuous calibration of a gimballed sensor head from its commands and its accelerometers alone.

A platform with three gyros and three accelerometers tumbles under command; `calibrate` finds 30 coefficients (attitude, gyro
drift, g-sensitive terms, mountings, accelerometer bias, scale and mountings) and up to eight optional ones. All numbers are SI: rad, rad/s,
m/s^2. Source: a reconstruction of DOI 10.3873/j.issn.1000-1328.2017.06.009.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.results import brief

Floats = npt.NDArray[np.float64]

NAMES: tuple[str, ...] = tuple(_native.gimbal_names())
"""Names of all 41 coefficients in order; the last eight are optional."""

_BASIC = 33


@dataclass(frozen=True, kw_only=True)
class Head:
    """Where a head stands, how it is built, and what to estimate.

    Attributes
    ----------
    gravity_m_s2, latitude_rad, earth_rate_rad_s : float
        The place.
    gauge : {"accelerometer", "gyro", "none"}
        Which three mounting angles are zero by convention: a common turn of all axes cannot be seen.
    torquer, quadratic, latency, latitude : bool
        Estimate torquer scale errors (3), quadratic accelerometer terms (3), the latency of the accelerometers (1), the
        error of the latitude (1).
    scale : tuple of float, optional
        Prior standard deviations in the order of `NAMES` (the first ones, or all).
    prior : tuple of float, optional
        Prior mean.
    angle_random_walk_deg_sqrt_h : float
        Random walk the filters allow for.
    robust : bool
        Find spikes by a Theil-Sen line in every window.
    reference : {"model", "commanded"}
        What is subtracted inside the windows: the model output (recommended) or the commanded specific force.
    cut_off_rad : float
        Leave out epochs with an input axis nearer to the horizontal than this (loses information; off).
    second_order : float
        Weight of the second-order terms in the on-line filter.
    half_window : int, optional
        Samples to either side of an epoch, 0 for single samples.
    refined : bool
        Fourth-order step of the model.
    single : bool
        Square root in single precision.
    every : int
        History every so many epochs.
    gyro_triads, accelerometer_triads : tuple
        Platform axis (0, 1, 2) of each instrument's input, output, spin (input, pendulous, output) axis.
    """

    gravity_m_s2: float = 9.8
    latitude_rad: float = 0.6981317007977318
    earth_rate_rad_s: float = 7.292115e-5
    gauge: Literal["accelerometer", "gyro", "none"] = "accelerometer"
    torquer: bool = False
    quadratic: bool = False
    latency: bool = False
    latitude: bool = False
    scale: tuple[float, ...] | None = None
    prior: tuple[float, ...] | None = None
    angle_random_walk_deg_sqrt_h: float = 0.0
    robust: bool = True
    reference: Literal["model", "commanded"] = "model"
    cut_off_rad: float = 0.0
    second_order: float = 5.0
    half_window: int | None = None
    refined: bool = True
    single: bool = False
    every: int = 4
    gyro_triads: tuple[tuple[int, int, int], ...] | None = None
    accelerometer_triads: tuple[tuple[int, int, int], ...] | None = None

    def settings(self) -> dict[str, Any]:
        """Return what is set, for the compiled half."""
        found = {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}
        return {
            name: [list(row) if isinstance(row, tuple) else row for row in value] if isinstance(value, tuple) else value
            for name, value in found.items()
            if value is not None
        }


@dataclass(frozen=True)
class History:
    """How the estimate grew.

    Attributes
    ----------
    time_s : ndarray, shape (m,)
    coefficients, standard_deviation : ndarray, shape (m, n)
        In the order of `Calibration.names`.
    """

    time_s: Floats
    coefficients: Floats
    standard_deviation: Floats

    __repr__ = brief


@dataclass(frozen=True)
class Calibration:
    """Result of `calibrate`.

    Attributes
    ----------
    names : tuple of str
    coefficients, standard_deviation : ndarray, shape (n,)
        SI; a standard deviation of 0 says that the coefficient was not estimated (held by the gauge).
    history : History
    flags : dict
        Name of a coefficient, or "residuals", "diverged", "missing", ... -> what is wrong with it. Empty: nothing.
    bound : ndarray, shape (n,)
        Cramer-Rao bound without prior; NaN where not estimated.
    tests : dict
        Residual tests: ``mean_square`` (1 is right) and ``correlation`` of neighbours, each with its distance in standard
        deviations, ``skipped`` share.
    hidden : dict
        Optional coefficient -> (estimate, standard deviation, quotient), where asked for.
    weakest : tuple
        Weakest directions: singular value (prior deviations over noise) and the coefficients in it.
    details : dict
        ``sigma_m_s2`` of one sample, ``interval_s``, ``missing`` samples, batch ``steps``, ``cost``, ``observations``.
    """

    names: tuple[str, ...]
    coefficients: Floats
    standard_deviation: Floats
    history: History
    flags: dict[str, str]
    bound: Floats
    tests: dict[str, Any]
    hidden: dict[str, tuple[float, float, float]]
    weakest: tuple[tuple[float, str], ...]
    details: dict[str, Any]

    __repr__ = brief

    def __getitem__(self, name: str) -> float:
        """Return a coefficient by its name."""
        return float(self.coefficients[self.names.index(name)])


def _rows(values: npt.ArrayLike) -> Floats:
    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(np.float64), np.nan)
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 2:
        raise ValueError(f"expected an array of shape (n, 3), not {array.shape}")
    return array


def _shown(head: Head) -> list[int]:
    optional = [head.torquer] * 3 + [head.quadratic] * 3 + [head.latency, head.latitude]
    return [*range(_BASIC), *(_BASIC + i for i, on in enumerate(optional) if on)]


def calibrate(
    command_rad_s: npt.ArrayLike,
    specific_force_m_s2: npt.ArrayLike,
    dt_s: float,
    method: str = "relinearised",
    *,
    head: Head | None = None,
    sigma_m_s2: float | None = None,
    diagnose: bool = False,
    **options: Any,
) -> Calibration:
    """Find every coefficient of a gimballed head.

    Parameters
    ----------
    command_rad_s : array_like, shape (n, 3)
        Commanded rates in rad/s, each held for `dt_s`.
    specific_force_m_s2 : array_like, shape (n * m + 1, 3) or (n, 3)
        Accelerometer outputs in m/s^2, the first at time 0; missing ones NaN.
    dt_s : float
        Time for which a command is held, s.
    method : str
        "relinearised" (recommended), "on-line", "batch", "two-stage", "two-loop"; baselines "first-order" and "literal".
    head : Head, optional
        Place, build and what to estimate; `options` replace single attributes of it.
    sigma_m_s2 : float, optional
        Noise of one sample; found from the data otherwise.
    diagnose : bool
        Calibrate once more with all optional coefficients and say which stand out.

    Returns
    -------
    Calibration

    Raises
    ------
    ConfigError
        If a setting cannot be used.
    LogError
        If the data cannot be used.

    Examples
    --------
    >>> import stillrate as sr
    >>> command = sr.gimbal.trajectory()
    >>> truth = sr.gimbal.draw(seed=1)
    >>> samples = sr.gimbal.simulate(truth, command, 0.25, sigma_m_s2=1e-6, seed=2)
    >>> found = sr.gimbal.calibrate(command, samples, 0.25)
    >>> bool(abs(found["ka0x"] / truth[21] - 1) < 1e-3)
    True
    """
    head = dataclasses.replace(head or Head(), **options)
    settings = {**head.settings(), "diagnose": diagnose}
    raw = _native.gimbal_calibrate(
        _rows(command_rad_s), _rows(specific_force_m_s2), float(dt_s), sigma_m_s2, method, settings
    )
    shown = _shown(head)
    # A batch method has no history: shape (0, n).
    rows, spread = (raw[name].reshape(-1, len(NAMES))[:, shown] for name in ("history", "history_deviation"))
    history = History(raw["history_time_s"], rows, spread)
    return Calibration(
        names=tuple(NAMES[i] for i in shown),
        coefficients=raw["coefficients"][shown],
        standard_deviation=raw["deviation"][shown],
        history=history,
        flags=_flags(raw, shown),
        bound=raw["bound"][shown],
        tests=raw.get("tests", {}),
        hidden={name: (value, deviation, ratio) for name, value, deviation, ratio in raw["hidden"]},
        weakest=tuple(raw["weakest"]),
        details={name: raw[name] for name in ("sigma_m_s2", "interval_s", "missing", "steps", "cost", "observations")},
    )


def _flags(raw: dict[str, Any], shown: list[int]) -> dict[str, str]:
    """Put what went wrong into words."""
    flags = {NAMES[i]: "held at zero by the gauge" for i in shown if i not in raw["indices"]}
    for index in raw["unobservable"]:
        flags[NAMES[index]] = "not observable in this run: the bound exceeds half the prior deviation"
    if raw["diverged"]:
        flags["diverged"] = "the method lost itself: do not use the coefficients"
    if raw["missing"]:
        flags["missing"] = f"{raw['missing']} accelerometer values were missing or beyond twice gravity"
    tests = raw.get("tests")
    if tests and tests["alarm"]:
        flags["residuals"] = (
            f"the model does not explain the record: mean square {tests['mean_square']:.3g} "
            f"({tests['mean_square_sigma']:+.1f} sigma), correlation {tests['correlation_sigma']:.1f} sigma"
        )
    for name, value, deviation, ratio in raw["hidden"]:
        if abs(ratio) > 5.0:
            flags[f"hidden {name}"] = f"estimated as {value:.3g} +- {deviation:.2g}: switch this state on"
    return flags


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
    dt_s : float
        Time for which a command is held, s.
    sigma_m_s2 : float
        Noise of one sample.
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
        _rows(command_rad_s), float(dt_s), float(sigma_m_s2), half_window, skip_jumps, head.settings()
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
    """
    segments = None if segments_deg_s is None else _rows(segments_deg_s)
    found: Floats = _native.gimbal_trajectory(segments, segment_s, slew_deg_s2, dt_s, (head or Head()).settings())
    return found


def simulate(
    coefficients: npt.ArrayLike,
    command_rad_s: npt.ArrayLike,
    dt_s: float = 0.25,
    *,
    per_command: int = 5,
    seed: int = 0,
    head: Head | None = None,
    **disturbance: float,
) -> Floats:
    """Return the accelerometer samples (m/s^2) of a head with known coefficients, by a Runge-Kutta integration.

    Parameters
    ----------
    coefficients : array_like, shape (up to 41,)
        In the order of `NAMES`; the latency among them delays the samples.
    per_command : int
        Samples in each `dt_s`.
    **disturbance
        ``sigma_m_s2``, ``angle_random_walk_deg_sqrt_h``, ``quantisation_m_s2``, ``spike_probability``, ``spike_m_s2``,
        ``loss_probability``; all 0 by default (spikes 1e-3 m/s^2 where they occur).
    """
    values = np.asarray(coefficients, dtype=np.float64).tolist()
    found: Floats = _native.gimbal_simulate(
        values, _rows(command_rad_s), float(dt_s), per_command, dict(disturbance), seed, (head or Head()).settings()
    )
    return found


def draw(*, gyro_factor: float = 1.0, seed: int = 0) -> Floats:
    """Return true coefficients for a study: uniform 0.3 to 1 times the scale with random signs (drifts times `gyro_factor`)."""
    found: Floats = _native.gimbal_draw(gyro_factor, seed)
    return found


def score(
    estimates: npt.ArrayLike, truth: npt.ArrayLike, deviation: npt.ArrayLike, names: tuple[str, ...] = NAMES
) -> Floats:
    """Return per row of estimates: largest relative error but for kappa, error of kappa, of all, rms of error over `deviation`."""
    indices = [NAMES.index(name) for name in names]
    rows = np.atleast_2d(np.asarray(estimates, dtype=np.float64))
    found: Floats = _native.gimbal_score(
        rows, np.asarray(truth, dtype=np.float64).tolist(), np.asarray(deviation, dtype=np.float64), indices
    )
    return found


def to_gauge(
    coefficients: npt.ArrayLike, gauge: Literal["accelerometer", "gyro"], *, head: Head | None = None
) -> Floats:
    """Return the same head described in another gauge, exactly: the axes of all instruments are turned together."""
    values = np.asarray(coefficients, dtype=np.float64).tolist()
    return np.asarray(_native.gimbal_convert(values, gauge, (head or Head()).settings())[: len(values)])


@dataclass(frozen=True)
class Plan:
    """Result of `plan`.

    Attributes
    ----------
    segments_deg_s : ndarray, shape (segments, 3)
    before, after : dict
        Worst bounds over a typical coefficient in per cent: drift, g_sensitive, kappa, mounting, accelerometer.
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
    segments_deg_s : array_like, optional
        Where to start; by default the standard programme.
    moves, climbs : int
        Moves of each climb; the first climb starts from the given table, the others from random ones.
    kappa_weight : float
        How much kappa counts against the worst other bound.
    """
    segments = None if segments_deg_s is None else _rows(segments_deg_s)
    limits = (rate_max_deg_s, slew_deg_s2, segment_s, dt_s)
    found, before, after = _native.gimbal_plan(
        segments, limits, (moves, climbs, seed), kappa_weight, (half_window, sigma_m_s2), (head or Head()).settings()
    )
    keys = ("drift", "g_sensitive", "kappa", "mounting", "accelerometer")
    return Plan(np.asarray(found), dict(zip(keys, before, strict=True)), dict(zip(keys, after, strict=True)))
