"""Known truth: simulated heads, scores against it, and the same head in another gauge."""

from __future__ import annotations

from typing import Literal

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.gimbal.head import NAMES, Floats, Head, rows


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

    Examples
    --------
    >>> import stillrate as sr
    >>> command = sr.gimbal.trajectory()
    >>> samples = simulate(draw(seed=1), command, 0.25, sigma_m_s2=1e-6, seed=2)
    >>> len(samples) == 5 * len(command) + 1, round(float(np.linalg.norm(samples[0])), 2)  # gravity
    (True, 9.81)
    """
    values = np.asarray(coefficients, dtype=np.float64).tolist()
    found: Floats = _native.gimbal_simulate(
        values, rows(command_rad_s), float(dt_s), per_command, dict(disturbance), seed, (head or Head()).settings()
    )
    return found


def draw(*, gyro_factor: float = 1.0, seed: int = 0) -> Floats:
    """Return true coefficients for a study: uniform 0.3 to 1 times the scale with random signs (drifts times `gyro_factor`).

    Examples
    --------
    >>> bool((draw(seed=1) == draw(seed=1)).all()), bool((draw(seed=1) == draw(seed=2)).all())
    (True, False)
    """
    found: Floats = _native.gimbal_draw(gyro_factor, seed)
    return found


def score(
    estimates: npt.ArrayLike, truth: npt.ArrayLike, deviation: npt.ArrayLike, names: tuple[str, ...] = NAMES
) -> Floats:
    """Return per row of estimates: largest relative error but for kappa, error of kappa, of all, rms of error over `deviation`.

    Examples
    --------
    >>> truth = draw(seed=1)
    >>> other, kappa, *_ = score(truth, truth, np.ones(len(NAMES)))[0]
    >>> float(other), float(kappa)
    (0.0, 0.0)
    """
    indices = [NAMES.index(name) for name in names]
    table = np.atleast_2d(np.asarray(estimates, dtype=np.float64))
    found: Floats = _native.gimbal_score(
        table, np.asarray(truth, dtype=np.float64).tolist(), np.asarray(deviation, dtype=np.float64), indices
    )
    return found


def to_gauge(
    coefficients: npt.ArrayLike, gauge: Literal["accelerometer", "gyro"], *, head: Head | None = None
) -> Floats:
    """Return the same head described in another gauge, exactly: the axes of all instruments are turned together.

    Examples
    --------
    >>> truth = draw(seed=1)
    >>> back = to_gauge(to_gauge(truth, "gyro"), "accelerometer")
    >>> bool(abs(back - truth).max() < 1e-12)
    True
    """
    values = np.asarray(coefficients, dtype=np.float64).tolist()
    return np.asarray(_native.gimbal_convert(values, gauge, (head or Head()).settings())[: len(values)])
