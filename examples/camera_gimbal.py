"""A camera gimbal's rate loop, sample by sample.

This is the shape of a live program: a sample comes in with its time, goes through the filter, and the answer goes to the motor before
the next one. The filter never fails; what happened to a sample stands in its flags. For a sensor on UDP or a serial port,
``stillrate live`` does the same without a program. Usage: python camera_gimbal.py
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import stillrate as sr

RATE_HZ = 500.0
NOISE = sr.GyroNoise.from_datasheet(density_one_sided_dps_sqrt_hz=0.015)


def sensor(seconds: float, seed: int) -> Iterator[tuple[float, float, float]]:
    """Yield time, rate and true rate: held still, panned by hand, held still; a few samples get lost or come late."""
    t = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    panned = (t > 4.0) & (t < 8.0)
    motion = np.where(panned, 25.0 * np.sin(np.pi * (t - 4.0) / 4.0) ** 2 * np.sin(2 * np.pi * 0.8 * t), 0.0)
    gyro = sr.simulate.GyroModel(density_dps_sqrt_hz=NOISE.density_dps_sqrt_hz, missing_probability=0.002)
    reading = sr.simulate.gyro(motion, RATE_HZ, seed, gyro)
    jitter = 2e-4 * np.sin(0.37 * np.arange(t.size))
    yield from zip((t + jitter).tolist(), reading.measured_dps.tolist(), reading.truth_dps.tolist(), strict=True)


def main() -> dict[str, float]:
    """Run the loop for twelve seconds; return what it did."""
    flt = sr.Filter(sr.MsImmIkf(sample_rate_hz=RATE_HZ, noise=NOISE))
    last_s: float | None = None
    coasted = 0
    raw, clean, truth = [], [], []
    for time_s, rate_dps, true_dps in sensor(12.0, seed=3):
        dt_s = None if last_s is None else time_s - last_s
        last_s = time_s
        rate = flt.update(rate_dps, dt_s=dt_s)
        if flt.estimate.flags & sr.Flags.MISSING:
            coasted += 1  # the output is a prediction: fine for a few samples, not for a second
        # motor.command(-gain * rate) would stand here
        raw.append(rate_dps)
        clean.append(rate)
        truth.append(true_dps)

    still, moving = slice(500, 1950), slice(2000, 4000)
    found = {
        "still": sr.metrics.rmse(clean[still], truth[still]) / sr.metrics.rmse(raw[still], truth[still]),
        "moving": sr.metrics.rmse(clean[moving], truth[moving]) / sr.metrics.rmse(raw[moving], truth[moving]),
        "lag_ms": sr.metrics.lag_ms(clean, truth, RATE_HZ),
        "coasted": coasted,
    }
    print(
        f"held still: {found['still']:.2f} of the raw error; panned: {found['moving']:.2f}; lag {found['lag_ms']:+.2f} ms"
    )
    print(f"coasted over {coasted} lost samples; every answer finite: {bool(np.isfinite(clean).all())}")
    return found


if __name__ == "__main__":
    main()
