"""Speed of the recursive filters beside scipy, in one run: ratios count, not the clock of a busy machine.

Run with ``python benches/recursive_speed.py``; every figure is the best of several interleaved rounds.
"""

from __future__ import annotations

import numpy as np
import stillrate as sr
from scipy.signal import lfilter
from timing import best

ROUNDS = 15
SAMPLES = 400_000


def main() -> None:
    random = np.random.default_rng(0)
    x = random.normal(size=SAMPLES)
    wide = random.normal(size=(SAMPLES // 8, 8))
    noise = sr.GyroNoise(density_dps_sqrt_hz=0.05 / 200**0.5)
    lam = 0.9512

    def rls(channels: int) -> sr.Filter:
        return sr.Filter(
            sr.RecursiveLeastSquares(sample_rate_hz=200.0, noise=noise, forgetting_factor=lam), channels=channels
        )

    single, eight = rls(1), rls(8)
    kf = sr.Filter(sr.RandomWalkKf(sample_rate_hz=200.0, noise=noise, variance_ratio=0.0025))
    vff = sr.Filter(sr.VariableForgetting(sample_rate_hz=200.0, noise=noise))
    vff2 = sr.Filter(sr.VariableForgetting(sample_rate_hz=200.0, noise=noise, order=2))
    cusum = sr.Filter(sr.CusumForgetting(sample_rate_hz=200.0, noise=noise))
    rls2 = sr.Filter(sr.RecursiveLeastSquares(sample_rate_hz=200.0, noise=noise, order=2))
    fir = sr.Filter(sr.FirLowPass(sample_rate_hz=200.0, noise=noise))
    b, a = [1.0 - lam], [1.0, -lam]
    gyro = 0.3 * random.normal(size=(500, 3))
    fixes = np.tile(np.eye(3), (2, 1, 1))
    found = best(
        {
            "lfilter, 1 channel": lambda: lfilter(b, a, x, zi=[lam * x[0]]),
            "RLS, 1 channel": lambda: single.run(x),
            "lfilter, 8 channels": lambda: lfilter(b, a, wide, axis=0, zi=lam * wide[:1]),
            "RLS, 8 channels": lambda: eight.run(wide),
            "random-walk KF": lambda: kf.run(x),
            "RLS of order 2": lambda: rls2.run(x),
            "VFF": lambda: vff.run(x),
            "VFF of order 2": lambda: vff2.run(x),
            "CUSUM": lambda: cusum.run(x),
            "FIR, 40 taps": lambda: fir.run(x),
            "reference bias, 2.5 s at 200 Hz": lambda: sr.reference_bias(gyro, 0.005, [0, 500], fixes, 0.9),
        },
        ROUNDS,
    )
    for name, seconds in found.items():
        if name.startswith("reference"):
            print(f"{name:34s} {seconds * 1e3:8.3f} ms a call (goal <= 1 ms)")
        else:
            print(f"{name:34s} {seconds / SAMPLES * 1e9:8.2f} ns a sample")
    print(f"RLS over lfilter, 1 channel: {found['lfilter, 1 channel'] / found['RLS, 1 channel']:.2f} x (goal >= 1)")
    ratio = found["lfilter, 8 channels"] / found["RLS, 8 channels"]
    print(f"RLS over lfilter, 8 channels: {ratio:.2f} x (goal >= 3)")


if __name__ == "__main__":
    main()
