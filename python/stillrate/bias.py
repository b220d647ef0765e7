"""Gyro bias from a reference attitude: rate table, motion capture, dual-antenna GNSS/INS, camera."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.errors import ConfigError
from stillrate.results import brief

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Iteration:
    """One iteration of the exact method, on its first interval.

    Attributes
    ----------
    bias_rad_s : ndarray, shape (3,)
        Bias before the step.
    rotation : ndarray, shape (3, 3)
        Gyro rotation with that bias taken off.
    jacobian_s : ndarray, shape (3, 3)
        Its Jacobian.
    residual_rad : ndarray, shape (3,)
        Log(reference' rotation).
    """

    bias_rad_s: Array
    rotation: Array
    jacobian_s: Array
    residual_rad: Array

    __repr__ = brief


_KEPT = 0.7
"""Share of its prior deviation above which something counts as not seen: the data then says less than the prior (half the variance)."""


@dataclass(frozen=True)
class ReferenceBias:
    """A gyro bias found from a reference attitude.

    Attributes
    ----------
    bias_rad_s : ndarray, shape (3,)
        The bias: measured = true + bias.
    covariance : ndarray, shape (k, k)
        Of all that was estimated, in the order of `names`. Directions that the motion does not show keep their prior.
        NaN for shortcuts.
    names : tuple of str
        bias_x, ..., and mounting_x, ..., lag, scale_x, ... where asked for.
    mounting_rad : ndarray, shape (3,)
        Rotation vector from the reference body's axes to the sensor's.
    lag_s : float
        By how much the gyro's time lies behind the reference's.
    scale : ndarray, shape (3,)
        Scale factor errors: measured = (1 + scale) true + bias.
    singular_values : ndarray, shape (k,)
        How much better than the prior the data knows each direction, descending; below 1 the motion does not show it.
    directions : ndarray, shape (k, k)
        The directions in columns, in units of the priors.
    posterior_over_prior : ndarray, shape (k,)
        Standard deviation after over before.
    condition : float
        Largest over smallest singular value.
    chi_square, degrees_of_freedom : float, int
        Weighted sum of squared residuals, and what it should be near.
    rank : int
        Directions that the data determines.
    observable : bool
        Whether the motion separates everything that was asked for.
    iterations : int
        Iterations made.
    converged : bool
        Whether the iteration settled, clear of the ambiguity where bias times time is pi.
    history : tuple of Iteration
        Every iteration.

    Examples
    --------
    >>> import numpy as np
    >>> import stillrate as sr
    >>> still = np.tile(np.eye(3), (2, 1, 1))
    >>> rates = np.full((100, 3), 1e-3)
    >>> found = sr.reference_bias(rates, 0.01, [0, 100], still, earth_rate=False, estimate_mounting=True)
    >>> found.observable, found.unobservable  # at rest every mounting explains the record
    (False, ('mounting_x', 'mounting_y', 'mounting_z'))
    """

    bias_rad_s: Array
    covariance: Array
    names: tuple[str, ...]
    mounting_rad: Array
    lag_s: float
    scale: Array
    singular_values: Array
    directions: Array
    posterior_over_prior: Array
    condition: float
    chi_square: float
    degrees_of_freedom: int
    rank: int
    observable: bool
    iterations: int
    converged: bool
    history: tuple[Iteration, ...] = field(repr=False)

    __repr__ = brief

    @property
    def unobservable(self) -> tuple[str, ...]:
        """Names of what the motion tells less about than was known before."""
        return tuple(name for name, ratio in zip(self.names, self.posterior_over_prior, strict=True) if ratio > _KEPT)


def reference_bias(
    rate_rad_s: Any,
    dt_s: Any,
    fix_index: Any,
    c_b_n: Any,
    latitude_rad: Any = 0.0,
    longitude_rad: Any = 0.0,
    estimate_mounting: bool = False,
    *,
    estimate_lag: bool = False,
    estimate_scale: bool = False,
    method: str = "exact",
    angle_random_walk_rad_sqrt_s: float | None = None,
    reference_sigma_rad: float = 0.0,
    mounting: Any = None,
    lag_s: float = 0.0,
    earth_rate: bool = True,
    instantaneous: bool = False,
    project: bool = False,
    use_prior: bool = False,
    prior_bias_rad_s: float | None = None,
    prior_mounting_rad: float | None = None,
    prior_lag_s: float | None = None,
    prior_scale: float | None = None,
    max_iterations: int | None = None,
    tolerance: float | None = None,
) -> ReferenceBias:
    """Find the gyro bias with which the integrated rates meet a reference attitude.

    Parameters
    ----------
    rate_rad_s : array_like, shape (n, 3)
        Body rates in rad/s, means over their time step (delta angles over time); see `instantaneous`.
    dt_s : float or array_like, shape (n,)
        Time steps in s.
    fix_index : array_like of int, shape (m,)
        Sample at whose start each fix was taken, ascending; n is the end of the record. At least two.
    c_b_n : array_like, shape (m, 3, 3) or (m, 4)
        Reference attitudes, body to north-east-down, as matrices or quaternions (scalar first).
    latitude_rad, longitude_rad : float or array_like, shape (m,)
        Where each fix was taken; Earth and transport rate follow exactly, also at the poles.
    estimate_mounting : bool
        Also estimate the rotation between reference body and sensor.
    estimate_lag : bool
        Also estimate the lag of the gyro.
    estimate_scale : bool
        Also estimate the scale factors.
    method : {"exact", "small-angle", "small-angle-jacobian", "mean-rate"}
        Gauss-Newton over all fixes, or a classical shortcut over the first and the last.
    angle_random_walk_rad_sqrt_s : float
        Angle random walk of the gyro in rad/sqrt(s); default 0.3 deg/sqrt(h).
    reference_sigma_rad : float
        White error of each fix, rad an axis.
    mounting : array_like, shape (3, 3), optional
        Known rotation from reference body to sensor; the start and the prior's centre if it is estimated.
    lag_s : float
        Known lag of the gyro's time behind the reference's, likewise.
    earth_rate : bool
        Whether the Earth turns under the reference.
    instantaneous : bool
        Whether rates are samples at the start of their time step rather than means over it.
    project : bool
        Whether rounded matrices are projected onto the nearest rotation instead of refused.
    use_prior : bool
        Whether the priors count as data; otherwise they only say what is observable.
    prior_bias_rad_s : float, optional
        Standard deviation of the bias, known before; default 200 deg/h.
    prior_mounting_rad : float, optional
        Likewise of the mounting; default 1 deg.
    prior_lag_s : float, optional
        Likewise of the lag; default 10 ms.
    prior_scale : float, optional
        Likewise of the scale factors; default 1 %.
    max_iterations : int, optional
        Default 20.
    tolerance : float, optional
        Step at which the iteration has settled; default 1e-12 of the priors.

    Raises
    ------
    ConfigError
        If fewer than two fixes are given, time does not move forward, a number is not finite, a matrix is no rotation.

    Examples
    --------
    >>> import numpy as np
    >>> found = reference_bias(np.full((100, 3), 1e-3), 0.01, [0, 100], np.tile(np.eye(3), (2, 1, 1)), earth_rate=False)
    >>> bool(np.allclose(found.bias_rad_s, 1e-3)), found.observable
    (True, True)
    """
    rates = np.asarray(rate_rad_s, dtype=np.float64)
    if rates.ndim != 2 or rates.shape[1] != 3:
        raise ValueError(f"rate_rad_s must have shape (n, 3), not {rates.shape}")
    steps = _one_each("dt_s", dt_s, rates.shape[0])
    index = np.asarray(fix_index)
    if index.ndim != 1 or (index.size and not np.array_equal(index, index.astype(np.int64))) or (index < 0).any():
        raise ConfigError("fix_index must be whole numbers >= 0, one a fix")
    matrices = _matrices(c_b_n, index.size)
    options: dict[str, Any] = {
        "estimate_mounting": estimate_mounting,
        "estimate_lag": estimate_lag,
        "estimate_scale": estimate_scale,
        "angle_random_walk_rad_sqrt_s": angle_random_walk_rad_sqrt_s,
        "reference_sigma_rad": reference_sigma_rad,
        "mounting": None if mounting is None else np.asarray(mounting, dtype=np.float64).tolist(),
        "lag_s": lag_s,
        "earth_rate": earth_rate,
        "instantaneous": instantaneous,
        "project": project,
        "use_prior": use_prior,
        "prior_bias_rad_s": prior_bias_rad_s,
        "prior_mounting_rad": prior_mounting_rad,
        "prior_lag_s": prior_lag_s,
        "prior_scale": prior_scale,
        "max_iterations": max_iterations,
        "tolerance": tolerance,
    }
    found = _native.find_reference_bias(
        rates.tolist(),
        steps.tolist(),
        index.astype(np.int64).tolist(),
        matrices,
        _one_each("latitude_rad", latitude_rad, index.size).tolist(),
        _one_each("longitude_rad", longitude_rad, index.size).tolist(),
        method,
        {name: value for name, value in options.items() if value is not None},
    )
    return _result(found)


def _one_each(name: str, value: Any, count: int) -> Array:
    array = np.asarray(value, dtype=np.float64)
    if array.ndim > 1 or (array.ndim == 1 and array.size != count):
        raise ConfigError(f"{name} has shape {array.shape} (must be a number or one number each, {count})")
    return np.broadcast_to(array, (count,))


def _matrices(values: Any, count: int) -> list[Any]:
    array = np.asarray(values, dtype=np.float64)
    if array.shape == (count, 4):
        return [_native.rotation_from_quaternion(row.tolist()).tolist() for row in array]
    if array.shape != (count, 3, 3):
        raise ConfigError(f"c_b_n has shape {array.shape} (must be ({count}, 3, 3) or, as quaternions, ({count}, 4))")
    matrices: list[Any] = array.tolist()
    return matrices


def _result(found: dict[str, Any]) -> ReferenceBias:
    if "covariance" in found:
        history = tuple(Iteration(**step) for step in found.pop("history"))
        return ReferenceBias(history=history, **{**found, "names": tuple(found["names"])})
    nothing = np.full(3, np.nan)
    return ReferenceBias(
        bias_rad_s=found["bias_rad_s"],
        covariance=np.full((3, 3), np.nan),
        names=("bias_x", "bias_y", "bias_z"),
        mounting_rad=np.zeros(3),
        lag_s=0.0,
        scale=np.zeros(3),
        singular_values=nothing,
        directions=np.full((3, 3), np.nan),
        posterior_over_prior=nothing,
        condition=float("nan"),
        chi_square=float("nan"),
        degrees_of_freedom=0,
        rank=0,
        observable=False,
        iterations=0,
        converged=False,
        history=(),
    )
