"""Allan deviation with confidence intervals and the noise figures that explain it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.arrays import as_column

Array = npt.NDArray[np.float64]


class Figure(NamedTuple):
    """A noise figure and its interval."""

    value: float
    lower: float
    upper: float


@dataclass(frozen=True, repr=False)
class Allan:
    """An Allan deviation curve; units follow the record (deg/s in, deg/s out).

    Attributes
    ----------
    tau_s : ndarray, shape (taus,)
        Averaging times in s.
    deviation, lower, upper : ndarray, shape (taus,)
        Allan deviation and its interval.
    fitted : ndarray, shape (taus,)
        Deviation that the fitted figures lead to.
    degrees_of_freedom : ndarray, shape (taus,)
        Equivalent degrees of freedom of each point.
    angle_random_walk : Figure
        N: two-sided density, unit/sqrt(Hz).
    bias_instability : Figure
        B: the flicker floor is 0.664 B.
    rate_random_walk : Figure
        K in unit/sqrt(s).
    misfit : float
        Largest log ratio of curve and fit beyond the intervals; above some 0.3 the record holds something
        else than these three noises (motion, vibration, a low-pass filter, coarse steps).

    Examples
    --------
    A flicker noise B shows as a floor of 0.664 B; the interval holds the figure that was simulated.

    >>> from stillrate import simulate
    >>> gyro = simulate.GyroModel(bias_instability_dps=0.01, bias_sigma_dps=0.0)
    >>> curve = allan(simulate.static(50.0, 1, duration_s=3600.0, noise=gyro).measured_dps, 50.0)
    >>> curve.bias_instability.lower < 0.01 < curve.bias_instability.upper
    True
    >>> bool(0.006 < curve.deviation.min() < 0.009), curve.misfit < 0.3
    (True, True)
    """

    tau_s: Array
    deviation: Array
    lower: Array
    upper: Array
    fitted: Array
    degrees_of_freedom: Array
    angle_random_walk: Figure
    bias_instability: Figure
    rate_random_walk: Figure
    misfit: float

    def __repr__(self) -> str:
        def show(figure: Figure) -> str:
            return f"{figure.value:.4g} [{figure.lower:.4g}, {figure.upper:.4g}]"

        return (
            f"Allan({len(self.tau_s)} taus, angle_random_walk={show(self.angle_random_walk)}, "
            f"bias_instability={show(self.bias_instability)}, rate_random_walk={show(self.rate_random_walk)})"
        )


def allan(
    z: Any,
    sample_rate_hz: float,
    *,
    taus: Literal["octave", "dense", "all"] = "octave",
    per_decade: int = 20,
    confidence: float = 0.9,
) -> Allan:
    """Return the overlapping Allan deviation of one channel, gaps allowed.

    Parameters
    ----------
    z : array_like, shape (n,)
        Regular samples; NaN, infinite or masked samples are gaps.
    sample_rate_hz : float
        Sample rate in Hz.
    taus : {"octave", "dense", "all"}, optional
        1, 2, 4, ... samples; `per_decade` of them a decade; or every one (at a cost that grows with n^2).
    confidence : float, optional
        Probability inside each interval.

    Raises
    ------
    LogError
        For fewer than 8 usable samples.
    ConfigError
        For a setting out of range.

    Notes
    -----
    IEEE Std 952-2020, annex C; intervals are chi-square with the equivalent degrees of freedom of the noise
    found in the record. The figures are a fit of N^2 / tau + (2 ln 2 / pi) B^2 + K^2 tau / 3; where white noise hides the
    flicker no record tells whether it goes on, which their intervals allow for.

    Examples
    --------
    >>> import numpy as np
    >>> curve = allan(np.random.default_rng(1).standard_normal(100_000), 100.0)
    >>> bool(abs(curve.angle_random_walk.value - 0.1) < 0.002)
    True
    """
    found = _native.allan_deviation(as_column(z), sample_rate_hz, taus, max(1, per_decade), confidence)
    for name in ("angle_random_walk", "bias_instability", "rate_random_walk"):
        found[name] = Figure(*found[name])
    return Allan(**found)
