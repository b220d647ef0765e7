"""From a drone's log to a header for its firmware.

The drone stands on the ground for twenty seconds, flies, and hovers. Its propellers shake the gyro, so the noise is measured in
the log of this airframe and not taken from a datasheet. Usage: python drone_to_firmware.py [FOLDER]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
import stillrate as sr
from stillrate.cli import main as stillrate

RATE_HZ = 1000.0
SENSOR = sr.simulate.GyroModel(density_dps_sqrt_hz=0.012, lsb_dps=0.061, saturation_dps=2000.0)


def fly(seed: int) -> sr.Log:
    """Simulate one axis: ground, manoeuvres with sharp starts, hovering with small corrections."""
    t = np.arange(60_000) / RATE_HZ
    flying = (t > 20.0) & (t < 45.0)
    commands = np.where(flying, 120.0 * np.sign(np.sin(2 * np.pi * 0.2 * t)) * (np.sin(2 * np.pi * 1.1 * t) > 0.6), 0.0)
    lag = np.exp(-np.arange(400) / 25.0)
    motion = np.convolve(commands, lag / lag.sum())[: t.size] + np.where(
        t >= 45.0, 0.6 * np.sin(2 * np.pi * 0.7 * t), 0.0
    )
    reading = sr.simulate.gyro(motion, RATE_HZ, seed, SENSOR)
    return sr.Log(
        t_s=t,
        rate_dps=reading.measured_dps,
        channels=("gx_dps",),
        sample_rate_hz=RATE_HZ,
        columns={"gx_true_dps": reading.truth_dps},
    )


def main(folder: Path) -> dict[str, float]:
    """Tune on one flight, check on another, export; return the errors."""
    folder.mkdir(parents=True, exist_ok=True)
    learn, check = fly(seed=1), fly(seed=2)
    sr.write(folder / "flight.csv", learn)

    # The same two commands would do on a shell.
    settings = folder / "filter.toml"
    if stillrate(["tune", str(folder / "flight.csv"), "-o", str(settings), "--rest", "0:20"]) != 0:
        raise SystemExit("tune failed")

    # Never judge on the log you tuned on. Single precision, as the firmware will compute.
    config = sr.load_config(settings)
    raw, truth = check.rate_dps[:, 0], check.columns["gx_true_dps"]
    clean = sr.Filter(config, dtype="float32").run(raw)
    found = {}
    for name, part in (
        ("ground", slice(1000, 19_500)),
        ("flight", slice(20_000, 45_000)),
        ("hover", slice(46_000, None)),
    ):
        before, after = sr.metrics.rmse(raw[part], truth[part]), sr.metrics.rmse(clean[part], truth[part])
        found[name] = after / before
        print(f"{name:8s} {before:.3f} -> {after:.3f} deg/s RMS error")
    found["lag_ms"] = sr.metrics.lag_ms(clean, truth, RATE_HZ)
    print(f"lag      {found['lag_ms']:+.3f} ms")

    if stillrate(["export-c", str(settings), "-o", str(folder / "firmware"), "--dtype", "float32"]) != 0:
        raise SystemExit("export failed")
    print("put these into the firmware:", ", ".join(sorted(path.name for path in (folder / "firmware").iterdir())))
    return found


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(tempfile.mkdtemp()))
