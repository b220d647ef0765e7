"""Replay of the rate-table family: networks, scalar filter, swarm, uniform numbers, staircase."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import stillrate as sr

rt = sr.rate_table


def recognises(document: Any) -> bool:
    """Tell a file of this family by the questions it asks."""
    return isinstance(document, dict) and _kind(document) is not None


def replay(path: Path, data: dict[str, Any]) -> dict[str, np.ndarray]:
    """Return every answer of a file of this family."""
    kind = _kind(data)
    if kind is None:
        raise ValueError(f"{path}: not of the rate-table family")
    answers = {
        "uniform": _uniform,
        "network": _network,
        "kalman": _kalman,
        "swarm": _swarm,
        "metrics": _metrics,
        "staircase": _staircase,
    }[kind](data)
    return {key: np.asarray(value, dtype=np.float64) for key, value in answers.items()}


def _kind(data: dict[str, Any]) -> str | None:
    if "seed" in data and "first" in data:
        return "uniform"
    if {"z", "truth", "cases"} <= data.keys():
        return "kalman"
    if {"uniforms", "cases", "function"} <= data.keys():
        return "swarm"
    if {"a", "b"} <= data.keys() and "rmse" in data:
        return "metrics"
    if {"params", "x_min", "x_range", "e_min"} <= data.keys():
        return "staircase"
    nets = [v for v in data.values() if isinstance(v, dict) and {"I", "H", "params", "X"} <= v.keys()]
    return "network" if nets and len(nets) == len(data) else None


def _uniform(data: dict[str, Any]) -> dict[str, Any]:
    return {"first": rt.uniforms(data["seed"], len(data["first"]))}


def _network(data: dict[str, Any]) -> dict[str, Any]:
    out: dict[str, Any] = {}
    for name, case in data.items():
        net = rt.Network(parameters=case["params"], inputs=case["I"], hidden=case["H"], linear=case["linear"])
        rows, lm = np.asarray(case["X"], dtype=float), case["lm"]
        step = net.step(rows, case["target"], decay=lm["lam"], damping=lm["mu"], decay_mask=lm["decay_mask"])
        out |= {
            f"{name}/forward": net.output(rows),
            f"{name}/jacobian": net.jacobian(rows),
            f"{name}/mse": step.mean_square,
            f"{name}/grad_mse": step.gradient,
            f"{name}/dydx_first_input": net.slope(rows),
            f"{name}/lm/objective_before": step.before,
            f"{name}/lm/step": step.step,
            f"{name}/lm/objective_after": step.after,
        }
    return out


def _kalman(data: dict[str, Any]) -> dict[str, Any]:
    out: dict[str, Any] = {}
    z, truth = np.asarray(data["z"], dtype=float), np.asarray(data["truth"], dtype=float)
    for k, case in enumerate(data["cases"]):
        key = f"cases/{k}"
        diffuse = case["start"] == "diffuse"
        start = {} if diffuse else _start(case["start"])
        run = rt.kalman(z, case["Q"], case["R"], **start)
        out |= {f"{key}/x0": run.rate_dps[0], f"{key}/P0": run.variance[0], f"{key}/x": run.rate_dps}
        out |= {f"{key}/K": run.gain, f"{key}/P": run.variance}
        errors = rt.compare(run.rate_dps, truth)
        out |= {f"{key}/mse": errors.mse, f"{key}/mae": errors.mae}
        if case["Q"] > 0:
            out[f"{key}/K_inf"] = run.settled_gain
        if diffuse:
            out |= {f"{key}/nll_concentrated": run.innovation, f"{key}/R_hat": run.implied_variance}
    return out


def _start(text: str) -> dict[str, float]:
    """Read "x0=0,P0=1"."""
    values = dict(part.split("=") for part in text.replace(" ", "").split(","))
    return {"start_rate_dps": float(values["x0"]), "start_variance": float(values["P0"])}


def _swarm(data: dict[str, Any]) -> dict[str, Any]:
    out: dict[str, Any] = {}
    function = _function(data["function"])
    for k, case in enumerate(data["cases"]):
        dimensions = case["d"]
        trace = rt.qpso_trace(
            function,
            case["lo"],
            case["hi"],
            data["uniforms"],
            particles=case["n"],
            iterations=case["iters_schedule"],
            last_contraction=float(case["w1"]),
            first_contraction=float(case["w2"]),
            own_weight=float(case["c1"]),
            swarm_weight=float(case["c2"]),
            attractor=case["phi"],
            bound=case["bound"],
            target=float("-inf"),
        )
        for i, expected in enumerate(case["trace"]):
            swarm, key = trace[expected["t"]], f"cases/{k}/trace/{i}"
            table = {
                name: np.reshape(swarm[source], (-1, dimensions))
                for name, source in (("x", "position"), ("pbest", "best"))
            }
            table |= {
                "f": swarm["value"],
                "gbest": swarm["swarm_best"],
                "gf": swarm["swarm_value"],
                "beta": swarm["contraction"],
                "mbest": swarm["mean_best"],
            }
            out |= {f"{key}/{name}": table[name] for name in expected if name in table}
        out[f"cases/{k}/final/gbest"] = trace[-1]["swarm_best"]
        out[f"cases/{k}/final/gf"] = trace[-1]["swarm_value"]
        out[f"cases/{k}/final/evals"] = case["n"] * len(trace)
    return out


def _function(text: str):
    """Turn "f=(x0-0.7)^2+2(x1+0.3)^2+0.5 x0 x1" into a function of an array of points."""
    body = text.split("=", 1)[1].replace("^", "**").strip()
    if not re.fullmatch(r"(?:x\d+|\d+\.?\d*(?:e-?\d+)?|[\s()*+/-])+", body):
        raise ValueError(f"not a polynomial: {text}")
    # A number or a bracket before a name or a bracket, or a space between factors, multiplies.
    body = re.sub(r"(?<=[\d)])\s*(?=[x(])|(?<=\))\s*(?=\d)", "*", body)
    code = compile(body, "<objective>", "eval")

    def values(points: np.ndarray) -> np.ndarray:
        names = {f"x{d}": points[:, d] for d in range(points.shape[1])}
        return np.asarray(eval(code, {"__builtins__": {}}, names)) + np.zeros(len(points))

    return values


def _metrics(data: dict[str, Any]) -> dict[str, Any]:
    errors = rt.compare(data["a"], data["b"])
    return {"mae": errors.mae, "mse": errors.mse, "rmse": errors.rmse}


def _staircase(data: dict[str, Any]) -> dict[str, Any]:
    """Answer the curve and its slope; what the file "expects" of the guard is a word and no answer."""
    hidden = (len(data["params"]) - 1) // 3
    lows, ranges = np.atleast_1d(data["x_min"]), np.atleast_1d(data["x_range"])
    model = rt.Network(parameters=data["params"], hidden=hidden).error_model(
        list(zip(lows.tolist(), ranges.tolist(), strict=True)), (data["e_min"], data["e_range"])
    )
    return {"e": model.predict(data["y"]), "slope_e": model.slope(data["y"])}
