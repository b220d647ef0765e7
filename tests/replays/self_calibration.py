"""Reference outputs of the gimballed platform: single steps of the model, and every method on one record."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import stillrate as sr
from stillrate.gimbal import parts

Found = dict[str, np.ndarray]

# Name in the file (its first word) -> our method and settings.
METHODS: dict[str, tuple[str, dict[str, Any]]] = {
    "ekf_joint_first_order_4hz": ("first-order", {"half_window": 0}),
    "ekf_joint_first_order_avg": ("first-order", {}),
    "mekf_c0": ("on-line", {"second_order": 0.0}),
    "mekf_c5": ("on-line", {"second_order": 5.0}),
    "relin_schedule": ("relinearised", {}),
    "relin_model": ("relinearised", {"reference": "model"}),
    "dual_cascade": ("two-loop", {}),
    "dual_two_stage": ("two-stage", {}),
    "batch_gn": ("batch", {}),
}


def recognises(document: Any) -> bool:
    return isinstance(document, dict) and ("rexp" in document or "x_true" in document)


def replay(path: Path, document: dict[str, Any]) -> Found:
    with np.load(_record_of(path)) as record:
        data = {name: record[name] for name in record.files}
    return unit_vectors(document, data) if "rexp" in document else expected(document, data)


def _record_of(path: Path) -> Path:
    """The record beside a file, else the project's own."""
    for folder in (path.parent, Path(__file__).parent.parent / "reference" / "self_calibration"):
        known = folder / "platform900.npz"
        if known.exists():
            return known
        if others := sorted(folder.glob("*.npz")):
            return others[0]
    raise FileNotFoundError(f"{path}: no record (platform900.npz) beside it")


def unit_vectors(document: dict[str, Any], data: Found) -> Found:
    x = np.array(document["x"])
    head = sr.gimbal.Head(refined=False)
    found: Found = {}
    for i, case in enumerate(document["rexp"]):
        found[f"rexp/{i}/R"] = parts.rotation_exponential(case["v"])
    gyros, forces = parts.axes(x, head)
    found["gyro_axes"] = gyros
    for i, force in enumerate(forces):
        for name, part in zip(("a", "da_dthp", "da_dtho"), force, strict=True):
            found[f"acc_axis/{i}/{name}"] = part
    for i, case in enumerate(document["step"]):
        step = parts.step(x, case["R_in"], case["w_cmd"], 0.25, head)
        found[f"step/{i}/R_out"] = step.rotation
        found[f"step/{i}/omega_p"] = step.rate_rad_s
        found[f"step/{i}/f_mid"] = step.force_m_s2
        found[f"step/{i}/Gamma_params3_20"] = step.rate_sensitivity[:, 3:21]
        force, output, jacobian = parts.output(x, step.rotation, head)
        found[f"h/{i}/f"], found[f"h/{i}/z"], found[f"h/{i}/H"] = force, output, jacobian[:, :33]
    epochs = [int(k) for k in document["sens"]]
    for k, (output, jacobian) in zip(epochs, parts.sensitivity(x, data["wcmd"], 0.25, epochs, head), strict=True):
        found[f"sens/{k}/z"], found[f"sens/{k}/J"] = output, jacobian[:, :33]
    truth = sr.gimbal.simulate(x, data["wcmd"], 0.25)
    for k in document["truth_noisefree_z_at_k"]:
        found[f"truth_noisefree_z_at_k/{k}"] = truth[5 * int(k)]
    return found


def expected(document: dict[str, Any], data: Found) -> Found:
    meta = document["meta"]
    clean, noisy = data["Z_noisefree"], data["Z_case1"]
    truth = np.array(document["x_true"])
    found: Found = {}
    for case, entry in document["cases"].items():
        sigma = float(meta.get(f"sigma_raw_case{case}", meta["sigma_raw_case1"]))
        samples = (
            noisy if sigma == meta["sigma_raw_case1"] else clean + sigma / meta["sigma_raw_case1"] * (noisy - clean)
        )
        head = sr.gimbal.Head(
            gravity_m_s2=meta["g"],
            latitude_rad=meta["lat_rad"],
            earth_rate_rad_s=meta["omega_e"],
            scale=tuple(document["scale"]),
            prior=tuple(document["x0"][case]),
            refined=False,
            robust=False,
            reference="commanded",
            every=1,
        )
        bound = sr.gimbal.bound(
            data["wcmd"], meta["T"], sigma_m_s2=sigma, skip_jumps=True, head=head, prior=tuple(document["x_true"])
        )
        crlb = np.zeros(33)
        crlb[[sr.gimbal.NAMES.index(name) for name in bound.names]] = bound.standard_deviation
        answers: Found = {
            "crlb_1sigma": crlb,
            "whitened_J_sv_min_max": bound.singular_values[[-1, 0]],
        }
        for method in entry["methods"]:
            if method.split()[0] in METHODS:
                wanted = entry["methods"][method].keys()
                run = one_method(method.split()[0], head, meta, data["wcmd"], samples, sigma, truth, crlb)
                answers |= {f"methods/{method}/{key}": value for key, value in run.items() if key in wanted}
        for key, value in answers.items():
            found[f"{case}/{key.removeprefix('methods/')}"] = value
            found[f"cases/{case}/{key}"] = value
    return found


def one_method(
    name: str,
    head: sr.gimbal.Head,
    meta: dict[str, Any],
    command: np.ndarray,
    samples: np.ndarray,
    sigma: float,
    truth: np.ndarray,
    crlb: np.ndarray,
) -> Found:
    method, options = METHODS[name]
    run = sr.gimbal.calibrate(command, samples, meta["T"], method, head=head, sigma_m_s2=sigma, **options)
    free = tuple(n for n, sd in zip(sr.gimbal.NAMES, crlb, strict=False) if sd > 0)
    rows = run.history.coefficients
    last = rows[-1] if len(rows) else run.coefficients
    scores = sr.gimbal.score(np.vstack([rows, last]) if len(rows) else last, truth, crlb, free)
    found: Found = {
        "final": last,
        "sd_final": run.standard_deviation,
        "checkpoints": np.array(np.nan),
        "phi0": run.coefficients[:3],
        "iters": np.array(float(len(run.details["steps"]))),
        "step_history": np.array(run.details["steps"]),
        "cost": np.array(run.details["cost"]),
        "n_obs": np.array(float(run.details["observations"])),
    }
    for key, column in (("relerr_nonkappa", 0), ("relerr_kappa", 1), ("relerr_all27", 2), ("rms_over_crlb", 3)):
        found[key] = np.array(scores[-1, column])
    if len(rows):
        at = [round(t / meta["T"]) - 1 for t in meta["checkpoints_s"]]
        found["checkpoints"] = rows[at]
    for key, limit in (("t_1pct", 0.01), ("t_02pct", 0.002)):
        found[key] = np.array(settling(run.history.time_s, scores[:-1, 0], limit) if len(rows) else np.nan)
    return found


def settling(time_s: np.ndarray, errors: np.ndarray, limit: float) -> float:
    """First time after which the error stays below the limit; NaN if it never does."""
    bad = np.flatnonzero(~(errors < limit))
    first = bad[-1] + 1 if len(bad) else 0
    return float(time_s[first]) if first < len(time_s) else float("nan")
