"""Reference outputs of the recursive filters, rotations, reference bias and observability."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import stillrate as sr
from stillrate import attitude, closed_forms

# One sample a second: slopes a sample and a second are the same, so are densities and standard deviations.
RATE_HZ = 1.0


def recognises(document: Any) -> bool:
    return isinstance(document, dict) and _kind(document) is not None


def _kind(document: dict[str, Any]) -> str | None:
    cases = document.get("cases")
    first = cases[0] if isinstance(cases, list) and cases and isinstance(cases[0], dict) else {}
    if "vff" in document or "cusum" in document:
        return "adaptive"
    if "gyro" in document and "C_b_n0" in document:
        return "ref_bias"
    if "prior_std" in document and "euler" in document:
        return "observability"
    if "Phi" in document:
        return "rls_vec"
    if "Exp" in first or (first and set(first) <= {"v", "Exp", "Jr"} and "v" in first):
        return "so3"
    if "taps" in first or "initial_state" in document:
        return "fir"
    if "q_over_r" in first:
        return "kf1"
    if "level" in first or "g1" in first:
        return "rls2"
    if "gain" in first:
        return "rls1"
    if "lam" in document and "x" in document:
        return "rls1_missing"
    return None


def replay(path: Path, document: dict[str, Any]) -> dict[str, np.ndarray]:
    kind = _kind(document)
    if kind is None:
        raise ValueError(f"{path}: in no known format of this family")
    found: dict[str, np.ndarray] = globals()[f"_{kind}"](document)
    return found


def _numbers(values: list[float | None]) -> np.ndarray:
    return np.array([math.nan if value is None else float(value) for value in values])


def _noise(sigma: float = 1.0) -> sr.GyroNoise:
    return sr.GyroNoise(density_dps_sqrt_hz=sigma)


def _rls(lam: float, order: int = 1) -> sr.Filter:
    return sr.Filter(
        sr.RecursiveLeastSquares(sample_rate_hz=RATE_HZ, noise=_noise(), forgetting_factor=lam, order=order)
    )


def _gains(function: Any, lam: float, count: int) -> np.ndarray:
    return np.array([function(lam, n) for n in range(1, count + 1)])


def _plus_sign(lam: float, count: int) -> np.ndarray:
    """Replay the printed formula with its wrong sign: only to show that it must fail."""
    gains = [1.0]
    while len(gains) < count:
        p = gains[-1]
        gains.append((p + p * p / (lam + p)) / lam)
    return np.array(gains)


def _rls1(document: dict[str, Any]) -> dict[str, np.ndarray]:
    x = _numbers(document["x"])
    found: dict[str, np.ndarray] = {}
    for i, case in enumerate(document["cases"]):
        lam = float(case["lam"])
        found[f"cases/{i}/y"] = _rls(lam).run(x)
        found[f"cases/{i}/gain"] = _gains(closed_forms.rls_gain, lam, len(x))
    wrong = document.get("plus_sign_must_fail")
    if wrong:
        found["plus_sign_must_fail/gain"] = _plus_sign(float(wrong["lam"]), len(wrong["gain"]))
    return found


def _rls1_missing(document: dict[str, Any]) -> dict[str, np.ndarray]:
    trace = _rls(float(document["lam"])).run(_numbers(document["x"]), trace=True)
    early = (trace.flags & int(sr.Flags.NO_DATA_YET)) != 0
    return {"y": np.where(early, math.nan, trace.rate)}


def _kf1(document: dict[str, Any]) -> dict[str, np.ndarray]:
    x = _numbers(document["x"])
    found: dict[str, np.ndarray] = {}
    for i, case in enumerate(document["cases"]):
        lam = float(case["lam"])
        ratio = closed_forms.variance_ratio(lam)
        config = sr.RandomWalkKf(sample_rate_hz=RATE_HZ, noise=_noise(), variance_ratio=ratio)
        # With unit sample variance the reported variance is the gain.
        trace = sr.Filter(config).run(x, trace=True)
        found[f"cases/{i}/y"] = trace.rate
        found[f"cases/{i}/gain"] = trace.variance
        found[f"cases/{i}/q_over_r"] = np.array(ratio)
        found[f"cases/{i}/steady_gain"] = np.array(1.0 - closed_forms.forgetting_factor_of_variance_ratio(ratio))
    return found


def _rls2(document: dict[str, Any]) -> dict[str, np.ndarray]:
    x = _numbers(document["x"])
    found: dict[str, np.ndarray] = {}
    for i, case in enumerate(document["cases"]):
        lam = float(case["lam"])
        trace = _rls(lam, order=2).run(x, trace=True)
        found[f"cases/{i}/level"] = trace.rate
        found[f"cases/{i}/slope"] = trace.acceleration
        g1, g2 = closed_forms.order_2_gains(lam, len(x))
        found[f"cases/{i}/g1"], found[f"cases/{i}/g2"] = g1, g2
    return found


def _designed(name: str) -> np.ndarray | None:
    """Return the taps that a case's name describes, where it does."""
    if match := re.fullmatch(r"(boxcar|hann|hamming|blackman)(\d+)", name):
        return closed_forms.fir_taps(match[1], int(match[2]))
    if match := re.fullmatch(r"firwin(\d+)_(boxcar|hann|hamming|blackman)_fc([0-9.]+)fs", name):
        return closed_forms.fir_taps(match[2], int(match[1]), float(match[3]))
    return None


def _fir(document: dict[str, Any]) -> dict[str, np.ndarray]:
    x = _numbers(document["x"])
    start = "zero" if document.get("initial_state", "zeros") == "zeros" else "first-sample"
    found: dict[str, np.ndarray] = {}
    for i, case in enumerate(document["cases"]):
        taps = _designed(case["name"])
        if taps is None:
            taps = _numbers(case["taps"])
        config = sr.FirLowPass(sample_rate_hz=RATE_HZ, noise=_noise(), taps=tuple(taps), start=start)
        trace = sr.Filter(config).run(x, trace=True)
        found[f"cases/{i}/taps"] = np.array(config.taps)
        found[f"cases/{i}/y"] = trace.rate
        found[f"cases/{i}/noise_var"] = np.array(trace.variance[-1])
        weights = np.array(config.taps)
        found[f"cases/{i}/group_delay"] = np.array(np.arange(len(weights)) @ weights / weights.sum())
    return found


def _adaptive(document: dict[str, Any]) -> dict[str, np.ndarray]:
    x = _numbers(document["x"])
    noise = _noise(document["sigma"])
    found: dict[str, np.ndarray] = {}
    for name, order in (("vff", 1), ("vff2", 2)):
        if case := document.get(name):
            config = sr.VariableForgetting(
                sample_rate_hz=RATE_HZ,
                noise=noise,
                order=order,
                forgetting_factor_max=case["lam_max"],
                forgetting_factor_min=case["lam_min"],
                smoothing=case["beta"],
                threshold=case["thr"],
                width=case["width"],
            )
            trace = sr.Filter(config).run(x, trace=True)
            found[f"{name}/y"] = trace.rate
            found[f"{name}/lam"] = trace.fading[:, 0]
    if case := document.get("cusum"):
        config = sr.CusumForgetting(
            sample_rate_hz=RATE_HZ,
            noise=noise,
            forgetting_factor=case["lam"],
            drift=case["drift"],
            threshold=case["h"],
            samples_kept=case["n_keep"],
        )
        trace = sr.Filter(config).run(x, trace=True)
        found["cusum/y"] = trace.rate
        found["cusum/alarm"] = ((trace.flags & int(sr.Flags.CHANGE)) != 0).astype(float)
    return found


def _rls_vec(document: dict[str, Any]) -> dict[str, np.ndarray]:
    phi, y = np.array(document["Phi"]), np.array(document["y"])
    upper = np.triu_indices(phi.shape[1])
    found: dict[str, np.ndarray] = {}
    for i, case in enumerate(document["cases"]):
        rls = sr.VectorRls(phi.shape[1], forgetting_factor=float(case["lam"]), initial_covariance=float(case["p0"]))
        weights, covariance = [], []
        for row, value in zip(phi, y, strict=True):
            rls.update(row, value)
            weights.append(rls.weights)
            covariance.append(rls.covariance[upper])
        found[f"cases/{i}/w"] = np.array(weights)
        found[f"cases/{i}/P_upper"] = np.array(covariance)
    return found


def _so3(document: dict[str, Any]) -> dict[str, np.ndarray]:
    found: dict[str, np.ndarray] = {}
    for i, case in enumerate(document["cases"]):
        found[f"cases/{i}/Exp"] = attitude.exp(case["v"])
        found[f"cases/{i}/Jr"] = attitude.right_jacobian(case["v"])
    return found


def _ref_bias(document: dict[str, Any]) -> dict[str, np.ndarray]:
    latitude, longitude = document["lat"], document["lon"]
    elapsed = document["t1"] - document["t0"]
    start, end = (attitude.from_euler(*document[name]) for name in ("euler0", "euler1"))
    inertial_start = attitude.inertial(latitude, longitude, start, 0.0)
    inertial_end = attitude.inertial(latitude, longitude, end, elapsed)
    gyro = np.array(document["gyro"])
    result = sr.reference_bias(
        gyro,
        document["dt"],
        [0, len(gyro)],
        [start, end],
        latitude,
        longitude,
        max_iterations=max(len(document["iterations"]), 6),
        tolerance=0.0,
    )
    found = {
        "C_b_n0": start,
        "C_b_n1": end,
        "C_n_e": attitude.position(latitude, longitude),
        "C_b_i0": inertial_start,
        "C_b_i1": inertial_end,
        "dC_ref": attitude.relative(inertial_start, inertial_end),
        "bias_rad_s": result.bias_rad_s,
    }
    for i, step in enumerate(result.history):
        found[f"iterations/{i}/b"] = step.bias_rad_s
        found[f"iterations/{i}/dC_imu"] = step.rotation
        found[f"iterations/{i}/J"] = step.jacobian_s
        found[f"iterations/{i}/delta"] = step.residual_rad
    return found


def _observability(document: dict[str, Any]) -> dict[str, np.ndarray]:
    latitude = document.get("lat", math.radians(document.get("lat_deg", 52.0)))
    gravity = document.get("g", 9.81)
    models = [sr.bench_imu(*euler, latitude_rad=latitude, gravity_m_s2=gravity) for euler in document["euler"]]
    found: dict[str, np.ndarray] = {}
    for i, case in enumerate(document["cases"]):
        used = models[: case["positions"]]
        report = sr.observability(
            [model[0] for model in used],
            [model[1] for model in used],
            duration_s=document["T_seg"],
            interval_s=document["dt"],
            measurement_sigma=document["meas_std"],
            prior_sigma=document["prior_std"],
            states=used[0][2],
        )
        found[f"cases/{i}/A_last"] = used[-1][0]
        found[f"cases/{i}/som_sv_SI"] = report.singular_values
        found[f"cases/{i}/som_sv_prior"] = report.singular_values_scaled
        found[f"cases/{i}/rank_prior_1e12"] = np.array(report.stacked_ranks[-1])
        found[f"cases/{i}/gramian_prior_eig"] = report.gramian_eigenvalues
        found[f"cases/{i}/posterior_std"] = report.posterior_sigma
    return found
