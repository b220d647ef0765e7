"""Singer's motion model in closed form."""

from __future__ import annotations

from typing import NamedTuple

from stillrate import _native


class SingerCoefficients(NamedTuple):
    """Transition [[1, r], [0, s]] and process noise [[q11, q12], [q12, q22]] for unit driving noise density.

    States are rate and acceleration; r, q22 are in s, s is pure, q12 in s^2, q11 in s^3.

    Examples
    --------
    >>> step = singer_coefficients(0.0, 3.0)  # constant acceleration: T, 1; T^3/3, T^2/2, T
    >>> (step.r, step.s), (step.q11, step.q12, step.q22)
    ((3.0, 1.0), (9.0, 4.5, 3.0))
    """

    r: float
    s: float
    q11: float
    q12: float
    q22: float


def singer_coefficients(alpha_per_s: float, dt_s: float, dtype: str = "float64") -> SingerCoefficients:
    """Return the Singer model's coefficients for one step, accurate for any alpha * dt.

    Parameters
    ----------
    alpha_per_s : float
        Reciprocal manoeuvre time constant in 1/s; 0 is constant acceleration.
    dt_s : float
        Step in s.
    dtype : {"float64", "float32"}
        Precision they are computed in.

    Examples
    --------
    >>> singer_coefficients(0.0, 2.0).q12
    2.0
    """
    return SingerCoefficients(*_native.singer_coefficients(alpha_per_s, dt_s, dtype == "float32"))
