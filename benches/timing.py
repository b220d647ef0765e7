"""Things timed against each other: interleaved rounds in one process, of which the shortest counts."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

import numpy as np
from others import Filter

ROUNDS = 9
AGREEMENT = 1e-9
Result = TypeVar("Result")


def best(functions: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, float]:
    """Return the shortest time of each function over interleaved rounds, s."""
    shortest = dict.fromkeys(functions, math.inf)
    for _ in range(rounds):
        for name, function in functions.items():
            start = time.perf_counter_ns()
            function()
            shortest[name] = min(shortest[name], (time.perf_counter_ns() - start) * 1e-9)
    return shortest


class Table:
    """Things to be timed against each other, each with the number of samples it handles in a call."""

    def __init__(self) -> None:
        self.cases: dict[str, tuple[Callable[[], object], int]] = {}
        self.missing: dict[str, str] = {}

    def add(self, name: str, call: Callable[[], object], samples: int) -> None:
        self.cases[name] = (call, samples)

    def add_checked(
        self, name: str, call: Callable[[], np.ndarray], expected: np.ndarray, agreement: float = AGREEMENT
    ) -> None:
        """Adds a case whose output must agree with the expected one; records why if it cannot."""
        found = self.tried(name, call)
        if found is None:
            return
        found = np.asarray(found, dtype=float)
        off = float(np.max(np.abs(found.ravel() - expected.ravel()))) if found.size == expected.size else math.inf
        # Written so that an output of NaN is no agreement.
        if not off <= agreement * max(1.0, float(np.max(np.abs(expected)))):
            self.missing[name] = f"outputs differ by {off:.2g}"
            return
        self.add(name, call, expected.size)

    def add_peer(self, name: str, make: Callable[[], Filter], z: np.ndarray, expected: np.ndarray) -> None:
        """Adds what `make` sets up to filter `z`; records why if it cannot be set up, as where its package is missing."""
        call = self.tried(name, make)
        if call is not None:
            self.add_checked(name, lambda: call(z), expected)

    def add_call(self, name: str, make: Callable[[], Callable[[float], object]], values: Sequence[float]) -> None:
        """Adds a loop over values that calls what `make` sets up with each; records why if it cannot be set up."""
        function = self.tried(name, make)
        if function is None:
            return

        def loop() -> None:
            for value in values:
                function(value)

        self.add(name, loop, len(values))

    def tried(self, name: str, make: Callable[[], Result]) -> Result | None:
        """Return what `make` gives; where it raises, record why and return nothing."""
        try:
            return make()
        except Exception as problem:
            self.missing[name] = f"{type(problem).__name__}: {problem}"[:160]
            return None

    def run(self) -> dict[str, float]:
        """Nanoseconds a sample."""
        shortest = best({name: call for name, (call, _) in self.cases.items()}, ROUNDS)
        return {name: 1e9 * shortest[name] / samples for name, (_, samples) in self.cases.items()}
