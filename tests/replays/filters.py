"""Reference outputs of the gyro filters: the recommended bank, the Singer family, the closed forms."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import stillrate as sr

TWO_PI = 2.0 * math.pi


def recognises(document: Any) -> bool:
    if isinstance(document, list):
        return bool(document) and isinstance(document[0], dict) and {"aT", "alpha", "T"} <= document[0].keys()
    return isinstance(document, dict) and {"params", "T", "z"} <= document.keys()


def replay(_: Path, document: Any) -> dict[str, np.ndarray]:
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
    trace = sr.Filter(singer_config(document)).run(samples(document), trace=True)
    return {
        "est": trace.rate,
        "accel": trace.acceleration,
        "var": trace.variance,
        "mu": trace.probability,
        "alpha": trace.alpha,
        "lam": trace.fading,
        "S": trace.innovation_variance,
        "nu": trace.innovation,
        "model_rate": trace.model_rate,
    }


def singer_config(document: dict[str, Any]) -> sr.Config:
    p = document["params"]
    period = document["T"]
    rate = [row[0] for row in p["P0"]]
    acceleration = [row[1] for row in p["P0"]]
    common = {
        "sample_rate_hz": 1.0 / period,
        "noise": sr.GyroNoise(density_dps_sqrt_hz=math.sqrt(p["R"][0] * period)),
    }
    models = {
        "alpha_per_s": p["alpha0"],
        "accel_max_dps2": [math.sqrt(3.0 * variance) for variance in p["sm2"]],
        "measurement_variance": p["R"],
        "initial_rate_variance": rate,
        "initial_acceleration_variance": acceleration,
    }
    if len(p["alpha0"]) == 1:
        return sr.SingerKf(**common, **{name: value[0] for name, value in models.items()})
    models |= {"transition": [*p["PI"][0], *p["PI"][1]], "initial_probability": p["mu0"]}
    alpha_moves = p["mix_alpha"] or p["jac"] or any(p["qth"])
    if not (p["fading"] or p["ps"] or alpha_moves):
        return sr.SingerImmKf(**common, **models)
    return sr.MsImmIkfPaper(
        **common,
        **models,
        mode="paper",
        initial_alpha_variance=[row[2] for row in p["P0"]],
        alpha_noise_density=p["qth"],
        alpha_mixing="shared" if p["mix_alpha"] else "private",
        jacobian="exact" if p["jac"] else "printed",
        fading=("none", "absolute", "signed")[p["fading"]],
        fading_source="measurement",
        fading_scale=p["fc"],
        fading_scope="all" if p["fade_alpha_row"] else "rate-acceleration",
        fading_gate=("always", "while-moving", "second-model-while-moving")[p["fgate"]],
        static_stay_probability=p["ps"],
        static_alpha_per_s=p["alpha3"],
    )


def closed_forms(rows: list[dict[str, Any]]) -> dict[str, np.ndarray]:
    found = {}
    for index, row in enumerate(rows):
        coefficients = sr.singer_coefficients(row["alpha"], row["T"])._asdict()
        # The answers belong to the decimal alpha T; the nearest f64 of T = 0.02 is 4e-17 off, which e^-50 shows 50-fold.
        coefficients["s"] = sr.singer_coefficients(row["aT"], 1.0).s
        found |= {f"{index}/{name}": np.array(value) for name, value in coefficients.items()}
    return found
