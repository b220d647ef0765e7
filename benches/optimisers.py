"""QPSO beside scipy's differential evolution and CMA-ES on shifted functions: evaluations to reach 1e-5.

Run with `python benches/optimisers.py [--seeds 5] [--json FILE]`; needs scipy and cma.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from statistics import mean

import numpy as np
import stillrate as sr

TARGET = 1e-5
BUDGET = {2: 10_000, 10: 60_000}
"""Most evaluations by dimension."""
BOX = 10.0


def sphere(x: np.ndarray) -> np.ndarray:
    return (x**2).sum(axis=1)


def rosenbrock(x: np.ndarray) -> np.ndarray:
    y = x + 1.0
    return (100.0 * (y[:, 1:] - y[:, :-1] ** 2) ** 2 + (1.0 - y[:, :-1]) ** 2).sum(axis=1)


def rastrigin(x: np.ndarray) -> np.ndarray:
    return (x**2 - 10.0 * np.cos(2.0 * np.pi * x) + 10.0).sum(axis=1)


def ackley(x: np.ndarray) -> np.ndarray:
    first = -20.0 * np.exp(-0.2 * np.sqrt((x**2).mean(axis=1)))
    return first - np.exp(np.cos(2.0 * np.pi * x).mean(axis=1)) + 20.0 + np.e


class Counted:
    """A function moved away from the origin that counts its points and notes when the target was reached."""

    def __init__(self, function: Callable[[np.ndarray], np.ndarray], dimensions: int, seed: int) -> None:
        self.function = function
        # The minimum lies anywhere but at the origin or on a bound.
        self.centre = np.random.default_rng(1000 + seed).uniform(1.0, 4.0, dimensions)
        self.count = 0
        self.reached: int | None = None

    def __call__(self, points: np.ndarray) -> np.ndarray:
        values = self.function(np.atleast_2d(points) - self.centre)
        below = np.flatnonzero(values <= TARGET)
        if below.size and self.reached is None:
            self.reached = self.count + int(below[0]) + 1
        self.count += values.size
        return values


def run_qpso(problem: Counted, dimensions: int, budget: int, seed: int) -> None:
    sr.rate_table.minimise(
        problem,
        [-BOX] * dimensions,
        [BOX] * dimensions,
        "qpso",
        particles=40,
        iterations=budget // 40 - 1,
        seed=seed,
        target=TARGET,
    )


def run_de(problem: Counted, dimensions: int, budget: int, seed: int) -> None:
    sr.rate_table.minimise(
        problem,
        [-BOX] * dimensions,
        [BOX] * dimensions,
        "de",
        particles=40,
        iterations=budget // 40,
        seed=seed,
        progress=lambda *_: problem.reached is None,
        tolerance=0.0,
    )


def run_cma(problem: Counted, dimensions: int, budget: int, seed: int) -> None:
    import cma

    start = np.random.default_rng(seed).uniform(-BOX, BOX, dimensions)
    search = cma.CMAEvolutionStrategy(
        start,
        BOX / 2,
        {"bounds": [-BOX, BOX], "seed": seed, "verbose": -9, "maxfevals": budget, "tolfun": 0, "tolx": 0},
    )
    while not search.stop() and problem.reached is None:
        points = search.ask()
        search.tell(points, problem(np.array(points)).tolist())


METHODS = {"QPSO": run_qpso, "DE (scipy)": run_de, "CMA-ES": run_cma}
FUNCTIONS = {"sphere": sphere, "rosenbrock": rosenbrock, "rastrigin": rastrigin, "ackley": ackley}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    rows = []
    for dimensions, budget in BUDGET.items():
        for name, function in FUNCTIONS.items():
            row: dict[str, object] = {"dimensions": dimensions, "function": name}
            for method, run in METHODS.items():
                reached = []
                for seed in range(1, arguments.seeds + 1):
                    problem = Counted(function, dimensions, seed)
                    run(problem, dimensions, budget, seed)
                    if problem.reached is not None and problem.reached <= budget:
                        reached.append(problem.reached)
                row[method] = {"solved": len(reached), "evaluations": mean(reached) if reached else None}
            rows.append(row)
            cells = [
                f"{r['evaluations']:.0f} ({r['solved']}/{arguments.seeds})" if r["solved"] else f"0/{arguments.seeds}"
                for r in (row[m] for m in METHODS)
            ]
            print(f"| {dimensions} {name} | " + " | ".join(cells) + " |", flush=True)
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
