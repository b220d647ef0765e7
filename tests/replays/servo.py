"""Reference outputs of the servo platform: drift variances, the open-loop plant, noise-free or linear closed loops."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from stillrate import platform as pf

ANSWERS = {"var_white", "var_asym", "var", "white", "gm", "rrw", "I", "I_lyap", "var_T2"}


def recognises(document: Any) -> bool:
    return isinstance(document, dict) and ("N_deg_per_sqrt_s" in document or "pn" in document)


def replay(_: Path, document: dict[str, Any]) -> dict[str, np.ndarray]:
    return variances(document) if "N_deg_per_sqrt_s" in document else plants(document)


# --- variance.json ---------------------------------------------------------------------------------------------------


def variances(document: dict[str, Any]) -> dict[str, np.ndarray]:
    density = 0.1074 / math.sqrt(50.0)
    answers: dict[str, np.ndarray] = {
        "N_deg_per_sqrt_s": np.array(density),
        "N_deg_per_sqrt_h": np.array(60.0 * density),
        "density_onesided": np.array(math.sqrt(2.0) * density),
    }
    for index, case in enumerate(document["cases"]):
        inputs = {name: value for name, value in case.items() if name not in ANSWERS}
        for name, value in variance(inputs, density).items():
            if name in case:
                answers[f"cases/{index}/{name}"] = np.asarray(value)
    return answers


def loop_of(case: dict[str, Any]) -> dict[str, Any]:
    kind, found = case["id"], {}
    if "wn" in case:
        wn, zeta = case["wn"], case["zeta"]
        found["rate_loop"] = ([wn * wn], [1.0, 2.0 * zeta * wn, wn * wn])
    elif "a" in case:
        found["rate_loop"] = ([case["a"]], [1.0, case["a"]])
    if "Ti" in case:
        found["tracking"] = ([case["k"], case["k"] / case["Ti"]], [1.0, 0.0])
    elif "k" in case:
        found["tracking"] = case["k"]
    if "fc" in case:
        corner = 2.0 * math.pi * case["fc"]
        found["filter"] = ([corner], [1.0, corner])
        found["filter_position"] = "forward-path" if "in_loop" in kind else "before-loop"
    if "wg" in case:
        found["band_rad_s"] = (1e-6, case["wg"])
    elif "T" in case:
        found["time_s"] = case["T"]
    return found


def variance(case: dict[str, Any], density: float) -> dict[str, Any]:
    if case["id"] == "random_tf":
        shape = (case["num"], case["den"])
        return {
            "I": pf.variance(*shape),
            "I_lyap": pf.variance(*shape, algorithm="lyapunov"),
            "var_T2": pf.variance(*shape, time_s=2.0),
        }
    integrator = case["id"] == "pure_integrator"
    coloured = {
        "bias_sigma_dps": case.get("sb", 0.01 if integrator else 0.0),
        "bias_time_s": case.get("tau", 20.0 if integrator else 0.0),
        "rate_random_walk_dps_sqrt_s": case.get("K", 0.001 if integrator else 0.0),
    }
    noise = pf.LoopNoise(density_dps_sqrt_hz=density, **coloured)
    d = pf.drift(noise, **loop_of(case))
    found = {"white": d.white, "var_white": d.white, "gm": d.gauss_markov, "rrw": d.rate_random_walk}
    found["var"] = [d.white, d.gauss_markov, d.rate_random_walk]
    if "zeta" in case and "T" in case:
        # The asymptote: what is left of the variance once the transient has died out, on the line of slope N^2.
        late = 200.0 / (case["zeta"] * case["wn"])
        settled = pf.drift(noise, **{**loop_of(case), "time_s": late}).white
        found["var_asym"] = settled + density**2 * (case["T"] - late)
    return found


# --- plant.json ------------------------------------------------------------------------------------------------------


def plants(document: dict[str, Any]) -> dict[str, np.ndarray]:
    cases = document.get("cases", document)
    answers: dict[str, np.ndarray] = {}
    for name, case in cases.items():
        if name.startswith("open_loop"):
            answers[f"cases/{name}/states"] = open_loop(case)
        else:
            answers[f"cases/{name}/rec"] = closed_loop(case, cases)
    # Cases are keyed by their own name too, as a file without the level "cases" would have them.
    answers.update({key.removeprefix("cases/"): value for key, value in list(answers.items())})
    return answers


def open_loop(case: dict[str, Any]) -> np.ndarray:
    base = case["base"]
    ticks = round(max(case["t"]) / 0.02)
    voltage = [6.0 * math.sin(2.0 * math.pi * 0.7 * k * 0.02) for k in range(ticks)]
    states = pf.open_loop(
        voltage,
        base=pf.Sine(amplitude_deg=math.degrees(base["A_rad"]), frequency_hz=base["f_hz"], ramp_s=base["t_ramp"]),
        plant=pf.Plant.from_symbols(case["plant"], curves="transcendental"),
        period_s=0.02,
        dt_s=case["dt"],
        start=case["x0"],
    )
    return states[[round(t / 0.02) for t in case["t"]]]


def base_of(case: dict[str, Any]) -> pf.Base:
    amplitude = math.degrees(case["A_rad"])
    if case["base_kind"] == 0:
        return pf.Tilt(amplitude_deg=amplitude, duration_s=case["t_ramp"])
    if case["base_kind"] == 1:
        return pf.Sine(amplitude_deg=amplitude, frequency_hz=case["f_hz"], ramp_s=case["t_ramp"])
    return pf.Constant(angle_deg=amplitude)


def filter_of(case: dict[str, Any]) -> Any:
    parameters = case["filter_params"]
    match case["filter_kind"]:
        case 0:
            return None
        case 1:
            return pf.LoopPt1(cutoff_hz=parameters[0])
        case 2:
            return pf.LoopButterworth(cutoff_hz=parameters[0])
        case _:
            return pf.LoopKalman(phi=parameters[0], ratio=parameters[1])


def noise_of(case: dict[str, Any], ticks: int) -> np.ndarray:
    if case["noise"] != "lcg":
        return np.zeros(0)
    word, samples = 12345, np.empty(ticks)
    for k in range(ticks):
        word = (1103515245 * word + 12345) % 2**31
        samples[k] = math.degrees(case["noise_sigma_rad_s"] * math.sqrt(12.0) * (word / 2**31 - 0.5))
    return samples


def closed_loop(case: dict[str, Any], cases: dict[str, Any]) -> np.ndarray:
    symbols = case["plant"]
    if isinstance(symbols, str):
        symbols = cases[f"open_loop_{symbols}"]["plant"]
    ctrl = case["ctrl"]
    ticks = max(case["tick"]) + 1
    filtered = ctrl["angle_source"] not in ("raw", 0)
    found = pf.run(
        base_of(case),
        setup=pf.Setup(
            plant=pf.Plant.from_symbols(symbols, curves="transcendental"),
            sample_rate_hz=50.0,
            dt_s=1e-3,
            delay_s=ctrl["delay_steps"] * 1e-3,
        ),
        controller=pf.Controller(
            kappa=ctrl["kap"],
            ko_per_s=ctrl["Ko"],
            kvi_per_s=ctrl["Kvi"],
            kd_s=ctrl["kd"],
            rate_demand_max_dps=math.degrees(ctrl["rmax"]),
            angle_from_filtered=filtered,
            inclinometer_time_s=ctrl.get("tau_incl", 0.0),
        ),
        filter=filter_of(case),
        gyro=pf.GyroErrors(
            scale_error=ctrl.get("sf", 0.0),
            lsb_dps=math.degrees(ctrl.get("lsb", 0.0)),
            samples_dps=noise_of(case, ticks),
        ),
        start_deg=math.degrees(case["theta0"]),
        duration_s=ticks * 0.02,
    )
    return found.record[case["tick"]]
