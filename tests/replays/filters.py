"""Reference outputs of the gyro filters: the recommended bank, the Singer family, the closed forms."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

import stillrate as sr

TWO_PI = 2.0 * math.pi


def replay(path: Path) -> dict[str, np.ndarray]:
    document = json.loads(path.read_text(encoding="utf-8"))
    if isinstance(document, list):
        return closed_forms(document)
    if "osc" in document["params"]:
        return bank(document)
    return singer_family(document)


def samples(document: dict[str, Any]) -> np.ndarray:
    return np.array([math.nan if z is None else z for z in document["z"]])


def bank(document: dict[str, Any]) -> dict[str, np.ndarray]:
    params = document["params"]
    z = samples(document)
    dt = np.broadcast_to(np.asarray(params.get("dt", document["T"]), dtype=float), z.shape)
    period = float(np.median(dt))
    density = params["N_"]
    two_memories = "tauv" in params
    config = sr.MsImmIkf(
        sample_rate_hz=1.0 / period,
        noise=sr.GyroNoise(density_dps_sqrt_hz=density, rate_random_walk_dps_sqrt_s=params["wrw"] * density),
        oscillators=params["osc"],
        ladder_hz=params["ladder"],
        dwell_time_s=params["tau"],
        rest_dwell_time_s=params.get("tau_rest", params["tau"]),
        frequency_memory_s=params["tauw"],
        variance_memory_s=params.get("tauv", params["tauw"]),
        derivative_cap=params["capm"] if two_memories else math.inf,
        moment_limit_hz=params["flim"] / TWO_PI if two_memories else math.inf,
        refresh_s=0.0,
    )
    trace = sr.Filter(config).run(z, dt_s=dt, trace=True)
    return {
        "est": trace.rate,
        "accel": trace.acceleration,
        "var": trace.variance,
        "mu": trace.probability,
        "omega": trace.frequency_hz * TWO_PI,
    }


def singer_family(document: dict[str, Any]) -> dict[str, np.ndarray]:
    raise NotImplementedError


def closed_forms(rows: list[dict[str, Any]]) -> dict[str, np.ndarray]:
    raise NotImplementedError
