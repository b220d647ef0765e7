"""One interface to the optimisers: Brent, quantum-behaved particle swarm, scipy's differential evolution."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.rate_table.parts import Floats, refusals

Objective = Callable[[Floats], npt.ArrayLike]
Progress = Callable[[int, int, float], bool | None]


@dataclass(frozen=True, kw_only=True)
class Minimum:
    """The best point found, its value, and how many points were valued."""

    point: Floats
    value: float
    evaluations: int


def minimise(
    objective: Objective,
    lower: Sequence[float],
    upper: Sequence[float],
    method: str = "qpso",
    *,
    progress: Progress | None = None,
    **options: Any,
) -> Minimum:
    """Find a point of a box where an objective is small.

    Parameters
    ----------
    objective : callable
        Takes an array of points, shape (n, dimensions), and returns n values; NaN counts as worst.
    lower, upper : sequence of float
        Corners of the box.
    method : {"brent", "qpso", "de"}
        "brent" is for one dimension; "de" is `scipy.optimize.differential_evolution`.
    progress : callable, optional
        Called with iteration, evaluations and best value; returning False stops.
    **options
        brent: grid, tolerance, iterations. qpso: particles, iterations, seed, target, attractor, bound,
        last_contraction, first_contraction, own_weight, swarm_weight. de: particles, iterations, seed, tolerance.

    Raises
    ------
    LogError
        If bounds or options are out of range or no value was finite.

    Examples
    --------
    >>> bowl = lambda p: ((p - 0.7) ** 2).sum(axis=1)
    >>> best = minimise(bowl, [-5.0, -5.0], [5.0, 5.0], "qpso", particles=30, iterations=60)
    >>> bool(abs(best.point - 0.7).max() < 0.02)
    True
    """
    low, high = [float(v) for v in lower], [float(v) for v in upper]
    if method == "de":
        return _differential_evolution(objective, low, high, progress, options)
    point, value, evaluations = refusals(_native.minimise_callable, objective, low, high, method, options, progress)
    return Minimum(point=np.asarray(point), value=value, evaluations=evaluations)


def _differential_evolution(
    objective: Objective, low: list[float], high: list[float], progress: Progress | None, options: dict[str, Any]
) -> Minimum:
    from stillrate.errors import LogError
    from stillrate.io.safely import needs

    known = {"particles", "iterations", "seed", "tolerance"}
    if unknown := sorted(set(options) - known):
        raise LogError(f"method 'de' has no option {unknown[0]!r} (one of {', '.join(sorted(known))})")
    scipy = needs("scipy.optimize", "logs", "differential evolution")
    best = [np.inf, 0, 0]

    def values(columns: Floats) -> Floats:
        found = np.asarray(objective(np.ascontiguousarray(np.atleast_2d(columns.T))), dtype=np.float64)
        found = np.where(np.isnan(found), np.inf, found)
        best[0] = min(float(best[0]), float(found.min(initial=np.inf)))
        best[1] += found.size
        return found

    def report(*_: Any) -> bool:
        best[2] += 1
        return progress is not None and progress(int(best[2]), int(best[1]), float(best[0])) is False

    dimensions = len(low)
    population = max(5, int(options.get("particles", 40)))
    done = scipy.differential_evolution(
        values,
        list(zip(low, high, strict=True)),
        maxiter=int(options.get("iterations", 100)),
        popsize=max(1, round(population / dimensions)),
        tol=float(options.get("tolerance", 1e-6)),
        rng=int(options.get("seed", 1)),
        polish=False,
        vectorized=True,
        updating="deferred",
        callback=report,
    )
    if not np.isfinite(done.fun):
        raise LogError(f"the objective gave no finite value at any of {best[1]} points")
    return Minimum(point=np.asarray(done.x), value=float(done.fun), evaluations=int(best[1]))


def qpso_trace(
    objective: Objective, lower: Sequence[float], upper: Sequence[float], uniform: Sequence[float], **options: Any
) -> list[dict[str, Any]]:
    """Run the swarm on given uniform numbers and return its state after the start and after each iteration."""
    trace: list[dict[str, Any]] = refusals(
        _native.qpso_trace, objective, list(lower), list(upper), options, [float(u) for u in uniform]
    )
    return trace


def uniforms(seed: int, count: int) -> Floats:
    """Return the first numbers of the SplitMix64 generator, uniform in 0 <= u < 1."""
    numbers: Floats = _native.uniforms(seed, count)
    return numbers
