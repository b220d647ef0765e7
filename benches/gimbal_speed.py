"""Speed of the gimbal filters beside a numba port of the same filters, in one run: 900 s, 3600 commands, 18001 samples.

Run with ``python benches/gimbal_speed.py``. Outputs are compared before anything is timed; every figure is the best of several interleaved
rounds, and ratios count, not the clock of a busy machine. "whole call" is `stillrate.gimbal.calibrate` with everything it reports: noise
of the samples, residual tests, Cramer-Rao bound, weak directions.
"""

from __future__ import annotations

import os
from collections.abc import Callable

# One core for everybody.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import gimbal_numba as port
import numpy as np
import stillrate as sr
from timing import best

ROUNDS = 25
SIGMA = 1e-6
HEAD = sr.gimbal.Head(refined=False, robust=False, every=10**6)


def agree(name: str, ours: np.ndarray, theirs: np.ndarray, scale: np.ndarray) -> None:
    """Stop where the outputs differ by more than 1e-6 of a prior deviation."""
    worst = float((abs(ours[3:33] - theirs[3:33]) / scale[3:]).max())
    print(f"{name}: outputs agree to {worst:.1e} of a prior deviation")
    if not worst < 1e-6:
        raise SystemExit(f"{name}: the port is not the same filter")


def main() -> None:
    command = sr.gimbal.trajectory()
    truth = sr.gimbal.draw(seed=1)
    samples = sr.gimbal.simulate(truth, command, 0.25, sigma_m_s2=SIGMA, seed=2)
    scale = np.concatenate(
        [[5e-4] * 3, [np.deg2rad(0.1) / 3600.0] * 12, [5e-4] * 6, [9.8e-4] * 3, [1e-3] * 3, [5e-4] * 6]
    )
    earth = HEAD.earth_rate_rad_s * np.array([np.cos(HEAD.latitude_rad), np.sin(HEAD.latitude_rad), 0.0])
    common = (command, samples, 0.25, SIGMA, HEAD.gravity_m_s2, earth, scale)

    def numba_on_line(dense: bool) -> np.ndarray:
        return port.on_line(*common, port.FREE, HEAD.second_order, 2, dense)

    def ours(method: str, **options: object) -> sr.gimbal.Calibration:
        return sr.gimbal.calibrate(command, samples, 0.25, method, head=HEAD, sigma_m_s2=SIGMA, bounds=False, **options)

    for dense in (False, True):
        words = "dense" if dense else "tight"
        agree(f"on-line, {words} port", ours("on-line").coefficients, numba_on_line(dense), scale)
        agree(f"recursive Gauss-Newton, {words} port", ours("relinearised").coefficients, port.relinearised(*common, dense), scale)  # fmt: skip
    methods = ("on-line", "relinearised", "two-stage", "two-loop", "first-order")
    functions: dict[str, Callable[[], object]] = {}
    for method in methods:
        functions[f"{method}, f64"] = lambda m=method: ours(m)
        functions[f"{method}, f32 square root"] = lambda m=method: ours(m, single=True)
        functions[f"{method}, whole call, defaults"] = lambda m=method: sr.gimbal.calibrate(command, samples, 0.25, m)
    functions |= {
        "numba on-line, tight": lambda: numba_on_line(False),
        "numba on-line, dense": lambda: numba_on_line(True),
        "numba relinearised, tight": lambda: port.relinearised(*common, False),
        "numba relinearised, dense": lambda: port.relinearised(*common, True),
    }
    found = {name: 1e3 * seconds for name, seconds in best(functions, ROUNDS).items()}
    for name, ms in found.items():
        print(f"{name:42s} {ms:8.2f} ms")
    print(f"single pass: {found['on-line, f64']:.2f} ms (goal <= 12)")
    print(f"recommended filter: {found['relinearised, f64']:.2f} ms (goal <= 60)")
    for method in ("on-line", "relinearised"):
        for words in ("tight", "dense"):
            ratio = found[f"numba {method}, {words}"] / found[f"{method}, f64"]
            print(f"{method}: {ratio:.2f} x the speed of the {words} numba port (goal >= 5)")


if __name__ == "__main__":
    main()
