"""One small picture a method, drawn while the site is built: the same simulated gyro, cleaned by each with its defaults."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from stillrate import Filter, GyroNoise, methods, simulate
from stillrate.config import Config
from stillrate.config import methods as all_methods

RATE_HZ = 100.0
SEED = 7
GYRO = simulate.GyroModel()
NOISE = GyroNoise(
    density_dps_sqrt_hz=GYRO.density_dps_sqrt_hz, rate_random_walk_dps_sqrt_s=0.0033
)
REST_S, WAVES_S, STEP_S, END_S = 3.0, 6.0, 8.0, 10.0


def motion() -> np.ndarray[Any, Any]:
    """Return a rest, three seconds of swelling and fading waves, a rest, and a step with the lag of a real airframe, in deg/s."""
    t = np.arange(round(END_S * RATE_HZ)) / RATE_HZ
    inside = (t >= REST_S) & (t < WAVES_S)
    envelope = np.sin(np.pi * (t - REST_S) / (WAVES_S - REST_S)) * inside
    waves = 12.0 * envelope * np.sin(2 * np.pi * 1.5 * (t - REST_S))
    return waves + np.where(t >= STEP_S, 5.0 * (1.0 - np.exp(-(t - STEP_S) / 0.02)), 0.0)


def draw(config: Config, path: Path) -> None:
    """Draw the three views of one method."""
    reading = simulate.gyro(motion(), RATE_HZ, SEED, GYRO)
    clean = Filter(config).run(reading.measured_dps)
    t = np.arange(len(clean)) / RATE_HZ
    views = (("at rest", 1.0, 3.0), ("in waves", 3.0, 6.0), ("at a step", 7.9, 8.4))
    with matplotlib.rc_context({"svg.hashsalt": "stillrate", "font.size": 8.5}):
        figure = Figure(figsize=(8.6, 2.5), layout="constrained")
        for axes, (title, begin, end) in zip(figure.subplots(1, 3), views, strict=True):
            seen = (t >= begin) & (t <= end)
            axes.plot(
                t[seen],
                reading.measured_dps[seen],
                color="#b9bec6",
                linewidth=0.9,
                label="gyro",
            )
            axes.plot(
                t[seen],
                reading.truth_dps[seen],
                color="#111111",
                linewidth=0.9,
                linestyle=(0, (4, 2)),
                label="truth",
            )
            axes.plot(
                t[seen], clean[seen], color="#0969da", linewidth=1.5, label=config.method
            )
            axes.set(title=title, xlabel="time, s")
            axes.grid(visible=True, alpha=0.25, linewidth=0.5)
            axes.spines[["top", "right"]].set_visible(False)
        figure.axes[0].set_ylabel("rate, deg/s")
        figure.axes[0].set_ylim(-0.6, 0.6)
        figure.axes[0].legend(frameon=False, fontsize=7, ncols=3, loc="upper left")
        figure.savefig(path, metadata={"Date": None})


def draw_all(folder: Path) -> None:
    """Draw every method into a folder, by the method's name."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, cls in all_methods().items():
        draw(cls(sample_rate_hz=RATE_HZ, noise=NOISE), folder / f"{name}.svg")
    light = methods.MsImmIkf(sample_rate_hz=RATE_HZ, noise=NOISE, oscillators=())
    draw(light, folder / "ms-imm-ikf-light.svg")
