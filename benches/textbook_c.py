"""The kernels of textbook/ at gcc -O3, called on arrays; and the two models that every contestant of the bench filters with."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import stillrate as sr

FOLDER = Path(__file__).parent / "textbook"
PERIOD_S = 0.001
ALPHA, ACCEL_MAX = (0.001, 0.01), (1.5, 30.0)
VARIANCE, START_ACCELERATION = 0.2, (1.0, 100.0)
TRANSITION, EVEN = np.array([[0.95, 0.05], [0.05, 0.95]]), np.array([0.5, 0.5])


def singer_matrices(model: int) -> tuple[np.ndarray, np.ndarray]:
    c = sr.singer_coefficients(ALPHA[model], PERIOD_S)
    intensity = 2.0 * ALPHA[model] * ACCEL_MAX[model] ** 2 / 3.0
    return np.array([[1.0, c.r], [0.0, c.s]]), intensity * np.array([[c.q11, c.q12], [c.q12, c.q22]])


class TextbookC:
    """The two files of kernels, compiled into a folder."""

    def __init__(self, folder: Path) -> None:
        library = folder / "kernels.so"
        sources = [FOLDER / "kernels.c", FOLDER / "any_size.c"]
        subprocess.run(["gcc", "-O3", "-shared", "-fPIC", "-o", library, *sources, "-lm"], check=True)
        self.library = ctypes.CDLL(str(library))
        self.f, self.q = (np.array(matrices) for matrices in zip(*map(singer_matrices, (0, 1)), strict=True))

    def imm(self, z: np.ndarray) -> np.ndarray:
        start = np.array([[VARIANCE, acceleration] for acceleration in START_ACCELERATION])
        return self._run(self.library.imm, z, *self._models(), start, EVEN)

    def imm_of_any_size(self, z: np.ndarray) -> np.ndarray:
        start = np.array([np.diag([VARIANCE, acceleration]) for acceleration in START_ACCELERATION])
        two = ctypes.c_int(2)
        return self._run(self.library.imm_of_any_size, z, *self._models(), start, EVEN, sizes=(two, two))

    def kalman(self, z: np.ndarray) -> np.ndarray:
        start = np.array([VARIANCE, START_ACCELERATION[1]])
        return self._run(self.library.kalman, z, self.f[1], self.q[1], ctypes.c_double(VARIANCE), start)

    def _models(self) -> tuple[np.ndarray, ...]:
        return self.f, self.q, np.array([VARIANCE, VARIANCE]), TRANSITION

    @staticmethod
    def _run(
        function: Callable[..., None], z: np.ndarray, *given: object, sizes: tuple[object, ...] = ()
    ) -> np.ndarray:
        out = np.empty_like(z)
        arrays = (ctypes.c_void_p(a.ctypes.data) if isinstance(a, np.ndarray) else a for a in (z, out, *given))
        function(*sizes, ctypes.c_long(len(z)), *arrays)
        return out
