"""A vessel in swell: roll, pitch and yaw rate at once, and the period of the swell found on line.

The boat rolls with a period of four seconds. The motion is slow and strong and the interesting part is small, which is where a
low-pass does harm: it is late by a constant time. Usage: python vessel.py
"""

from __future__ import annotations

import numpy as np
import stillrate as sr

RATE_HZ = 20.0
SWELL_HZ = 0.25
AXES = ("roll", "pitch", "yaw")


def voyage(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return measured and true rates (n, 3) of ten minutes: harbour, swell in groups, harbour."""
    t = np.arange(round(600 * RATE_HZ)) / RATE_HZ
    at_sea = 1.0 / (1.0 + np.exp(-(t - 120.0) / 5.0)) / (1.0 + np.exp((t - 480.0) / 5.0))
    groups = at_sea * (0.7 + 0.3 * np.sin(2 * np.pi * t / 75.0))
    measured, truth = [], []
    for axis, (amplitude, phase) in enumerate(((6.0, 0.0), (2.5, 0.9), (0.8, 2.0))):
        motion = amplitude * groups * np.sin(2 * np.pi * SWELL_HZ * t + phase + 0.4 * np.sin(2 * np.pi * t / 40.0))
        reading = sr.simulate.gyro(motion, RATE_HZ, seed + axis)
        measured.append(reading.measured_dps)
        truth.append(reading.truth_dps)
    return np.column_stack(measured), np.column_stack(truth)


def main() -> dict[str, float]:
    """Clean all three axes; return errors over raw errors, the lag in ms and the period in s."""
    measured, truth = voyage(seed=40)
    noise = sr.GyroNoise.from_log(measured[: round(100 * RATE_HZ)], sample_rate_hz=RATE_HZ)
    config = sr.MsImmIkf(sample_rate_hz=RATE_HZ, noise=noise)
    trace = sr.Filter(config, channels=3).run(measured, trace=True)

    sea, found = slice(round(150 * RATE_HZ), round(450 * RATE_HZ)), {}
    for axis, name in enumerate(AXES):
        before = sr.metrics.rmse(measured[sea, axis], truth[sea, axis])
        after = sr.metrics.rmse(trace.rate[sea, axis], truth[sea, axis])
        found[name] = after / before
        print(f"{name:6s} at sea {before:.4f} -> {after:.4f} deg/s RMS error")
    found["lag_ms"] = sr.metrics.lag_ms(trace.rate[sea, 0], truth[sea, 0], RATE_HZ, max_lag_s=1.0)
    found["period_s"] = float(1.0 / np.median(trace.frequency_hz[sea, 0]))
    low_pass = sr.Filter(sr.Pt1(sample_rate_hz=RATE_HZ, cutoff_hz=0.5), channels=3).run(measured)
    found["low_pass_lag_ms"] = sr.metrics.lag_ms(low_pass[sea, 0], truth[sea, 0], RATE_HZ, max_lag_s=1.0)
    print(f"lag of the roll rate {found['lag_ms']:+.1f} ms (PT1 at 0.5 Hz: {found['low_pass_lag_ms']:+.0f} ms)")
    print(f"period of the swell: found {found['period_s']:.2f} s, true {1 / SWELL_HZ:.2f} s")
    return found


if __name__ == "__main__":
    main()
