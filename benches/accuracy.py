"""Accuracy beside speed: what each filter leaves at rest, what it costs in motion, and how late it is.

    python benches/accuracy.py           # writes accuracy.json, accuracy.svg and the page accuracy.md

All filters run with their default settings for the sensor's noise figures (the low-passes also over a sweep of cut-offs), none was tuned on
these seeds. Static: standard deviation of the error at rest over that of the raw samples. Waves: error in rough waves over the raw
one. Both from 4 s on, root mean square over the seeds.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import stillrate as sr
from stillrate import metrics, simulate
from stillrate.config import methods

HERE = Path(__file__).parent
SEEDS = range(7000, 7006)
RATES_HZ = (50.0, 1000.0)
CUTOFFS_HZ = (1.0, 2.0, 5.0, 10.0, 20.0)
START_S = 4.0
Run = Callable[[np.ndarray], np.ndarray]


def noise() -> sr.GyroNoise:
    return sr.GyroNoise(density_dps_sqrt_hz=0.0151 * math.sqrt(2.0), rate_random_walk_dps_sqrt_s=0.003)


def ours(rate_hz: float) -> dict[str, Run]:
    def run_of(config: sr.Config) -> Run:
        return lambda z: sr.Filter(config).run(z)

    found = {name: run_of(kind(sample_rate_hz=rate_hz, noise=noise())) for name, kind in methods().items()}
    found["raw"] = lambda z: z
    found["ms-imm-ikf, light"] = run_of(sr.MsImmIkf(sample_rate_hz=rate_hz, noise=noise(), oscillators=()))
    for cutoff in CUTOFFS_HZ:
        if cutoff < 0.45 * rate_hz:
            found[f"pt1, {cutoff:g} Hz"] = run_of(sr.Pt1(sample_rate_hz=rate_hz, noise=noise(), cutoff_hz=cutoff))
    return found


def theirs(rate_hz: float) -> dict[str, Run]:
    """What people reach for elsewhere: low-passes of scipy, pandas' moving mean, padasip's adaptive predictor."""
    found: dict[str, Run] = {}
    from scipy import signal

    def butterworth(order: int, cutoff: float) -> Run:
        sections = signal.butter(order, cutoff, fs=rate_hz, output="sos")
        return lambda z: signal.sosfilt(sections, z, zi=signal.sosfilt_zi(sections) * z[0])[0]

    for cutoff in CUTOFFS_HZ:
        found[f"scipy Butterworth 2, {cutoff:g} Hz"] = butterworth(2, cutoff)
    found["scipy Butterworth 4, 10 Hz"] = butterworth(4, 10.0)
    taps = signal.firwin(21, min(10.0, 0.2 * rate_hz), fs=rate_hz)
    found["scipy FIR 21, 10 Hz"] = lambda z: signal.lfilter(taps, 1.0, z)
    try:
        import pandas

        found["pandas ewm, 0.1 s"] = lambda z: (
            pandas.Series(z).ewm(alpha=1.0 - math.exp(-1.0 / (0.1 * rate_hz))).mean().to_numpy()
        )
    except ImportError:
        pass
    try:
        import padasip

        found["padasip RLS predictor"] = lambda z: predictor(padasip, z)
    except ImportError:
        pass
    return found


def predictor(padasip: Any, z: np.ndarray, order: int = 8) -> np.ndarray:
    """One-step prediction from the last samples by recursive least squares, halfway to the sample itself."""
    rows = padasip.input_from_history(z, order)[:-1]
    predicted, _, _ = padasip.filters.FilterRLS(n=order, mu=0.999, w="zeros").run(z[order:], rows)
    return np.r_[z[:order], 0.5 * (predicted + z[order:])]


def scored(run: Run, rate_hz: float) -> dict[str, float]:
    start = round(START_S * rate_hz)
    rest, rest_raw, waves, waves_raw, lags = [], [], [], [], []
    for seed in SEEDS:
        still = simulate.static(rate_hz, seed)
        rest.append(metrics.rmse(run(still.measured_dps)[start:], still.truth_dps[start:]))
        rest_raw.append(metrics.rmse(still.measured_dps[start:], still.truth_dps[start:]))
        sea = simulate.rough_waves(rate_hz, seed, duration_s=60.0, waves_end_s=59.0)
        estimate = run(sea.measured_dps)
        waves.append(metrics.rmse(estimate[sea.scored], sea.truth_dps[sea.scored]))
        waves_raw.append(metrics.rmse(sea.measured_dps[sea.scored], sea.truth_dps[sea.scored]))
        lags.append(metrics.lag_ms(estimate[sea.scored], sea.truth_dps[sea.scored], rate_hz))
    size = lambda values: float(np.sqrt(np.mean(np.square(values))))  # noqa: E731
    return {
        "static_over_raw": size(rest) / size(rest_raw),
        "waves_over_raw": size(waves) / size(waves_raw),
        "lag_ms": float(np.mean(lags)),
    }


def front(found: dict[str, dict[str, float]]) -> set[str]:
    """Those that no other beats at rest and in waves together."""

    def beaten(name: str) -> bool:
        mine = found[name]
        keys = ("static_over_raw", "waves_over_raw")
        return any(
            all(other[key] <= mine[key] for key in keys) and any(other[key] < mine[key] for key in keys)
            for other in found.values()
        )

    return {name for name in found if not beaten(name)}


def picture(results: dict[str, dict[str, dict[str, float]]]) -> None:
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    from matplotlib.ticker import NullFormatter

    plt.rcParams["svg.hashsalt"] = "stillrate"
    figure, axes = plt.subplots(1, len(results), figsize=(13, 6.5), layout="constrained")
    for axis, (rate, found) in zip(np.atleast_1d(axes), results.items(), strict=True):
        best = front(found)
        sweeps: dict[str, list[tuple[float, float]]] = {}
        for name, row in found.items():
            other = name.startswith(("scipy", "pandas", "padasip"))
            colour = "black" if name == "raw" else "tab:orange" if other else "tab:blue"
            at = (row["static_over_raw"], row["waves_over_raw"])
            family, swept, cutoff = name.partition(", ")
            label = name
            if swept and cutoff.endswith("Hz") and family in ("pt1", "scipy Butterworth 2"):
                label = family if family not in sweeps else ""
                sweeps.setdefault(family, []).append(at)
            axis.loglog(*at, "s" if other else "o", color=colour, markersize=8 if name in best else 5)
            axis.annotate(label, at, xytext=(5, 4), textcoords="offset points", fontsize=7, color=colour)
        for line in sweeps.values():
            axis.plot(*zip(*line, strict=True), color="grey", linewidth=0.8, zorder=0)
        axis.axhline(1.0, color="grey", linewidth=0.8)
        axis.set(title=f"{rate} Hz", xlabel="error at rest / raw", ylabel="error in rough waves / raw")
        axis.set_xlim(right=2.0)
        axis.xaxis.set_minor_formatter(NullFormatter())
        axis.grid(True, which="both", linewidth=0.3)
    figure.savefig(HERE / "accuracy.svg", metadata={"Date": None})


def page(results: dict[str, dict[str, dict[str, float]]]) -> str:
    parts = [HEADER]
    for rate, found in results.items():
        best = front(found)
        parts += [
            f"## {rate} Hz\n",
            "| filter | at rest / raw | rough waves / raw | lag, ms | |",
            "|---|---|---|---|---|",
        ]
        for name, row in sorted(found.items(), key=lambda item: item[1]["static_over_raw"]):
            numbers = f"{row['static_over_raw']:.3f} | {row['waves_over_raw']:.3g} | {row['lag_ms']:.2f}"
            parts.append(f"| {name} | {numbers} | {'on the front' if name in best else ''} |")
        parts.append("")
    return "\n".join(parts)


HEADER = """# Accuracy of all filters, ours and others

Written by `python benches/accuracy.py`; do not edit. Simulated records, six seeds that no setting was chosen on: 60 s at rest (white
noise, a slow bias, rate random walk) and 55 s of waves driven by white noise. Every filter has its default settings for the same noise figures; the low-passes
are swept over their cut-off. Errors are root mean squares from 4 s on, over that of the raw samples. A filter is "on the front" if no other
in the table is at least as good in both and better in one; grey lines join the cut-offs of one low-pass. Lag: the shift that fits the truth best.

![Error in rough waves against error at rest](accuracy.svg)
"""


def main() -> None:
    results = {
        f"{rate:g}": {name: scored(run, rate) for name, run in (ours(rate) | theirs(rate)).items()} for rate in RATES_HZ
    }
    (HERE / "accuracy.json").write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    (HERE / "accuracy.md").write_text(page(results), encoding="utf-8")
    picture(results)


if __name__ == "__main__":
    main()
