"""Find the coefficients of a gimballed head: `calibrate` and what it returns."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy.typing as npt

from stillrate import _native
from stillrate.gimbal.head import NAMES, Floats, Head, rows, shown
from stillrate.results import brief


@dataclass(frozen=True)
class History:
    """How the estimate grew.

    Attributes
    ----------
    time_s : ndarray, shape (m,)
        Time since the start in s.
    coefficients, standard_deviation : ndarray, shape (m, n)
        In the order of `Calibration.names`, SI.

    Examples
    --------
    >>> import stillrate as sr
    >>> command = sr.gimbal.trajectory()[:400]
    >>> samples = sr.gimbal.simulate(sr.gimbal.draw(seed=1), command, sigma_m_s2=1e-6, seed=2)
    >>> history = sr.gimbal.calibrate(command, samples, 0.25, every=100, bounds=False).history
    >>> history.time_s.tolist(), history.coefficients.shape
    ([25.0, 50.0, 75.0, 100.0], (4, 33))
    >>> bool(history.standard_deviation[-1, 24] < 0.1 * history.standard_deviation[0, 24])  # ka1x, once gravity lies along it
    True
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
        The coefficients, in order.
    coefficients, standard_deviation : ndarray, shape (n,)
        SI; a standard deviation of 0 says that the coefficient was not estimated (held by the gauge).
    history : History
        How the estimate grew.
    flags : dict
        Name of a coefficient, or "residuals", "diverged", "missing", ... -> what is wrong with it. Empty: nothing.
    bound : ndarray, shape (n,)
        Cramer-Rao bound without prior; NaN where not estimated or not asked for.
    tests : dict
        Residual tests: ``mean_square`` (1 is right) and ``correlation`` of neighbours, each with its distance in standard
        deviations, ``skipped`` share.
    hidden : dict
        Optional coefficient -> (estimate, standard deviation, quotient), where asked for.
    weakest : tuple
        Weakest directions: singular value (prior deviations over noise) and the coefficients in it.
    details : dict
        ``sigma_m_s2`` of one sample, ``interval_s``, ``missing`` samples, batch ``steps``, ``cost``, ``observations``.

    Examples
    --------
    >>> import stillrate as sr
    >>> command = sr.gimbal.trajectory()
    >>> samples = sr.gimbal.simulate(sr.gimbal.draw(seed=1), command, sigma_m_s2=1e-6, seed=2)
    >>> samples[1000, 0] = float("nan")
    >>> found = sr.gimbal.calibrate(command, samples, 0.25)
    >>> sorted(found.flags)
    ['missing', 'tho_x', 'tho_y', 'thp_x']
    >>> found.flags["thp_x"], found["thp_x"]
    ('held at zero by the gauge', 0.0)
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


def calibrate(
    command_rad_s: npt.ArrayLike,
    specific_force_m_s2: npt.ArrayLike,
    dt_s: float,
    method: str = "relinearised",
    *,
    head: Head | None = None,
    sigma_m_s2: float | None = None,
    diagnose: bool = False,
    bounds: bool = True,
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
    bounds : bool
        Work out `Calibration.bound` and the weakest directions too; without them nothing is flagged as unobservable.

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
    settings = {**head.settings(), "diagnose": diagnose, "bounds": bounds}
    raw = _native.gimbal_calibrate(
        rows(command_rad_s), rows(specific_force_m_s2), float(dt_s), sigma_m_s2, method, settings
    )
    places = shown(head)
    # A batch method has no history: shape (0, n).
    grown, spread = (raw[name].reshape(-1, len(NAMES))[:, places] for name in ("history", "history_deviation"))
    history = History(raw["history_time_s"], grown, spread)
    return Calibration(
        names=tuple(NAMES[i] for i in places),
        coefficients=raw["coefficients"][places],
        standard_deviation=raw["deviation"][places],
        history=history,
        flags=_flags(raw, places),
        bound=raw["bound"][places],
        tests=raw.get("tests", {}),
        hidden={name: (value, deviation, ratio) for name, value, deviation, ratio in raw["hidden"]},
        weakest=tuple(raw["weakest"]),
        details={name: raw[name] for name in ("sigma_m_s2", "interval_s", "missing", "steps", "cost", "observations")},
    )


_STANDS_OUT_SIGMA = 5.0
"""An optional coefficient this many deviations from zero is no accident: as the residual tests raise their alarm."""


def _flags(raw: dict[str, Any], places: list[int]) -> dict[str, str]:
    """Put what went wrong into words."""
    flags = {NAMES[i]: "held at zero by the gauge" for i in places if i not in raw["indices"]}
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
        if abs(ratio) > _STANDS_OUT_SIGMA:
            flags[f"hidden {name}"] = f"estimated as {value:.3g} +- {deviation:.2g}: switch this state on"
    return flags
