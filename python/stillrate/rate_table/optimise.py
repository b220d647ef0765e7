"""One interface to the optimisers: Brent, quantum-behaved particle swarm, scipy's differential evolution."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.errors import LogError
from stillrate.rate_table.parts import Floats, refusals

Objective = Callable[[Floats], npt.ArrayLike]
Progress = Callable[[int, int, float], bool | None]


@dataclass(frozen=True, kw_only=True)
class Minimum:
    """The best point found, its value, and how many points were valued.

    Examples
    --------
    >>> best = minimise(lambda p: np.abs(p[:, 0] - 1.25), [-12.0], [4.0], "brent")
    >>> bool(abs(best.point[0] - 1.25) < 1e-3), best.evaluations < 40, best.value < 1e-3
    (True, True, True)
    """

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
        Called with iteration, evaluations and best value; returning False stops, with a LogError.
    **options
        brent: grid, tolerance, iterations. qpso: particles, iterations, seed, target, attractor, bound,
        last_contraction, first_contraction, own_weight, swarm_weight. de: particles, iterations, seed, tolerance.

    Raises
    ------
    LogError
        If bounds or options are out of range, `progress` stopped the search, or no value was finite.

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
    from stillrate.io.safely import needs

    known = {"particles", "iterations", "seed", "tolerance"}
    if unknown := sorted(set(options) - known):
        raise LogError(f"method 'de' has no option {unknown[0]!r} (one of {', '.join(sorted(known))})")
    _check_box(low, high)
    scipy = needs("scipy.optimize", "logs", "differential evolution")
    best = [np.inf, 0, 0]
    stopped = False

    def values(columns: Floats) -> Floats:
        found = np.asarray(objective(np.ascontiguousarray(np.atleast_2d(columns.T))), dtype=np.float64)
        found = np.where(np.isnan(found), np.inf, found)
        best[0] = min(float(best[0]), float(found.min(initial=np.inf)))
        best[1] += found.size
        return found

    def report(*_: Any) -> bool:
        nonlocal stopped
        best[2] += 1
        stopped = progress is not None and progress(int(best[2]), int(best[1]), float(best[0])) is False
        return stopped

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
    if stopped:
        raise LogError("stopped by the caller")
    if not np.isfinite(done.fun):
        raise LogError(f"the objective gave no finite value at any of {best[1]} points")
    return Minimum(point=np.asarray(done.x), value=float(done.fun), evaluations=int(best[1]))


def _check_box(low: list[float], high: list[float]) -> None:
    """Refuse what the native optimisers refuse."""
    if len(low) != len(high) or not low:
        raise LogError(f"{len(low)} lower and {len(high)} upper bounds (must be equally many, at least one)")
    for i, (a, b) in enumerate(zip(low, high, strict=True)):
        if not (np.isfinite(a) and np.isfinite(b) and a <= b):
            raise LogError(f"bounds[{i}] = {a:g}..{b:g} (must be finite, lower <= upper)")


def qpso_trace(
    objective: Objective, lower: Sequence[float], upper: Sequence[float], uniform: Sequence[float], **options: Any
) -> list[dict[str, Any]]:
    """Run the swarm on given uniform numbers and return its state after the start and after each iteration.

    Parameters
    ----------
    objective, lower, upper, **options
        As in `minimise` with "qpso".
    uniform : sequence of float
        Numbers in 0 <= u < 1: one a particle and dimension for the start, then four (r1, r2, u, s) each iteration.

    Returns
    -------
    list of dict
        iteration, contraction, mean_best, position, value, best, swarm_best, swarm_value.

    Raises
    ------
    LogError
        If the numbers do not suffice or an option is out of range.

    Examples
    --------
    >>> start, after = qpso_trace(lambda p: p[:, 0] ** 2, [-1], [1], uniforms(1, 10), particles=2, iterations=1)
    >>> start["position"] == [2 * u - 1 for u in uniforms(1, 2)]
    True
    >>> after["swarm_value"] <= start["swarm_value"]
    True
    """
    trace: list[dict[str, Any]] = refusals(
        _native.qpso_trace, objective, list(lower), list(upper), options, [float(u) for u in uniform]
    )
    return trace


def uniforms(seed: int, count: int) -> Floats:
    """Return the first numbers of the SplitMix64 generator, uniform in 0 <= u < 1.

    Examples
    --------
    >>> uniforms(12345, 1).tolist()
    [0.1330796686614273]
    """
    numbers: Floats = _native.uniforms(seed, count)
    return numbers
