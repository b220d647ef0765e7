"""Recursive least squares of several weights, forgetting only where the data has something new."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.results import brief

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class VectorRlsTrace:
    """A run of `VectorRls`: weights (n, order) after each sample, prediction and innovation (n,), flags (n,)."""

    weights: Array
    prediction: Array
    innovation: Array
    flags: npt.NDArray[np.uint32]

    __repr__ = brief


class VectorRls:
    """Recursive least squares of y = phi' w: UD factors, directional forgetting.

    Factors stay positive and the trace capped, whatever the excitation: constant, zero or collinear. The conventional
    form breaks there within some thousand samples.

    Parameters
    ----------
    order : int
        Number of weights, 1 to 16.
    forgetting_factor : float
        In (0, 1]. One direction is forgotten a sample: where the data excites n of them, use lambda^n.
    initial_covariance : float
        P before the first sample, on the diagonal.
    trace_max : float
        Trace that forgetting never lets P exceed.
    dtype : {"float64", "float32"}
        Number type it computes in.

    Raises
    ------
    ConfigError
        If a setting is out of range.

    Examples
    --------
    >>> rls = VectorRls(2, forgetting_factor=0.99)
    >>> for k in range(50):
    ...     _ = rls.update([1.0, k % 3], 2.0 + 3.0 * (k % 3))
    >>> [round(float(w), 2) for w in rls.weights]
    [2.0, 3.0]
    >>> float(rls.covariance.trace()) < 200.0  # of order 2 it began with 100 on the diagonal
    True
    >>> rls.reset()
    >>> trace = rls.run([[1.0, k % 3] for k in range(50)], [2.0 + 3.0 * (k % 3) for k in range(50)])
    >>> trace.weights.shape == (50, rls.order), [round(float(w), 2) for w in trace.weights[-1]]
    (True, [2.0, 3.0])
    """

    def __init__(
        self,
        order: int,
        *,
        forgetting_factor: float = 0.999,
        initial_covariance: float = 100.0,
        trace_max: float = 1e4,
        dtype: str = "float64",
    ) -> None:
        name = np.dtype(dtype).name
        if name not in ("float32", "float64"):
            raise ValueError(f"dtype = {dtype} (must be float32 or float64)")
        self._native = _native.NativeVectorRls(
            order, float(forgetting_factor), float(initial_covariance), float(trace_max), name == "float32"
        )
        self._settings = (
            f"forgetting_factor={forgetting_factor:g}, initial_covariance={initial_covariance:g},"
            f" trace_max={trace_max:g}, dtype={name!r}"
        )

    def __repr__(self) -> str:
        return f"VectorRls({self.order}, {self._settings})"

    @property
    def order(self) -> int:
        """Number of weights."""
        return int(self._native.order)

    @property
    def weights(self) -> Array:
        """Present weights."""
        found: Array = self._native.weights()
        return found

    @property
    def covariance(self) -> Array:
        """Present P, in units of the noise variance of y."""
        found: Array = self._native.covariance()
        return found

    def update(self, phi: Any, y: float) -> float:
        """Take one sample and return the prediction phi' w made before it; what is not finite changes nothing."""
        prediction, _, _ = self._native.update([float(x) for x in phi], float(y))
        return float(prediction)

    def run(self, phi: Any, y: Any) -> VectorRlsTrace:
        """Take many samples: `phi` of shape (n, order), `y` of shape (n,)."""
        rows = np.ascontiguousarray(phi, dtype=np.float64)
        values = np.ascontiguousarray(y, dtype=np.float64)
        return VectorRlsTrace(*self._native.run(rows, values))

    def reset(self) -> None:
        """Go back to the state before the first sample."""
        self._native.reset()
