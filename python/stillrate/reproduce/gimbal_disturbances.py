"""What disturbs a gimbal calibration, whether its residual tests notice, and what the optional states make of it.

Each line is a study of its own on the default run with coefficients drawn as in `stillrate.reproduce.gimbal`. "own" is the root mean square
of error over the method's own standard deviations: 1 is honest, more is overconfident.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from stillrate import _native
from stillrate.gimbal import Head, calibrate, draw, score, simulate, trajectory

COLUMNS = ("disturbance", "method", "handled by", "other %", "kappa %", "own", "noticed")
SIGMA = 1e-6
_G = 9.8


@dataclass(frozen=True)
class Disturbed:
    """One disturbance and one way to handle it.

    Attributes
    ----------
    disturbance, method, handling : str
    other, other_max, kappa : float
        Median and maximum of the largest relative error, median of kappa over the mean size of the kgI, per cent.
    own : float
        Root mean square of error over the method's own standard deviations.
    noticed, draws : int
        Draws whose residual tests raised the alarm, and all.
    """

    disturbance: str
    method: str
    handling: str
    other: float
    other_max: float
    kappa: float
    own: float
    noticed: int
    draws: int

    def cells(self) -> list[str]:
        """Return the line as words."""
        numbers = [f"{self.other:.3g} / {self.other_max:.3g}", f"{self.kappa:.3g}", f"{self.own:.2f}"]
        return [self.disturbance, self.method, self.handling, *numbers, f"{self.noticed} of {self.draws}"]


def _torquer(size: float) -> dict[str, float]:
    return {"tq_x": size, "tq_y": -size, "tq_z": size}


def _cases() -> list[tuple[str, dict[str, float], str, str, dict[str, Any]]]:
    """Disturbance, its numbers, method, handling, settings of the head."""
    joint, line = "relinearised", "on-line"
    cases: list[tuple[str, dict[str, float], str, str, dict[str, Any]]] = [
        ("none", {}, joint, "", {}),
        ("none", {}, line, "", {}),
    ]
    for size in (1e-6, 1e-5):
        name = f"torquer error {size:g}"
        cases += [
            (name, _torquer(size), joint, "nothing", {}),
            (name, _torquer(size), joint, "torquer states", {"torquer": True}),
            (name, _torquer(size), line, "torquer states", {"torquer": True}),
        ]
    for walk in (1e-5, 1e-4, 1e-3):
        name, disturbance = f"ARW {walk:g} deg/sqrt(h)", {"angle_random_walk_deg_sqrt_h": walk}
        cases += [
            (name, disturbance, joint, "nothing", {}),
            (name, disturbance, joint, "process noise", disturbance),
            (name, disturbance, line, "process noise", disturbance),
        ]
    quadratic = {f"ka2{axis}": 1e-5 / _G for axis in "xyz"}
    told = {"quantisation_m_s2": 1e-5, "told_sigma_m_s2": math.hypot(SIGMA, 1e-5 / math.sqrt(12.0))}
    cases += [
        ("latency 1 ms", {"latency": 1e-3}, joint, "nothing", {}),
        ("latency 1 ms", {"latency": 1e-3}, joint, "latency state", {"latency": True}),
        ("latitude 1e-4 rad", {"latitude": 1e-4}, joint, "nothing", {}),
        ("latitude 1e-4 rad", {"latitude": 1e-4}, joint, "latitude state", {"latitude": True}),
        ("quadratic 1e-5 g/g^2", quadratic, joint, "nothing", {}),
        ("quadratic 1e-5 g/g^2", quadratic, joint, "quadratic states", {"quadratic": True}),
        ("quantisation 1e-5 m/s^2", told, joint, "noise figure", {}),
    ]
    for spikes in (0.005, 0.05):
        name = f"{100 * spikes:g} % spikes, 2 % lost"
        disturbance = {"spike_probability": spikes, "loss_probability": 0.02}
        cases += [
            (name, disturbance, joint, "robust lines", {}),
            (name, disturbance, joint, "plain lines", {"robust": False}),
            (name, disturbance, line, "robust lines", {}),
        ]
    return cases


def study(draws: int = 6, seed: int = 2001) -> list[Disturbed]:
    """Run every disturbance with the same draws."""
    seeds = [seed + i for i in range(draws)]
    rows = []
    for name, disturbance, method, handling, settings in _cases():
        head = Head(every=10**6, **settings)
        found = _native.gimbal_study(method, "zero", seeds, {"sigma_m_s2": SIGMA, **disturbance}, head.settings())
        rows.append(_row(name, method, handling, found))
    return [*rows, _gravity(seeds)]


def _row(name: str, method: str, handling: str, found: list[dict[str, Any]]) -> Disturbed:
    other = np.array([100 * one["other"] for one in found])
    ratios = []
    for one in found:
        deviation = np.array(one["deviation"])
        use = deviation > 0
        use[:3] = False
        ratios.append(((np.array(one["coefficients"]) - np.array(one["truth"]))[use] / deviation[use]) ** 2)
    return Disturbed(
        disturbance=name,
        method=method,
        handling=handling,
        other=float(np.median(other)),
        other_max=float(other.max()),
        kappa=float(np.median([100 * one["kappa"] for one in found])),
        own=float(np.sqrt(np.mean(np.concatenate(ratios)))),
        noticed=sum(bool(one["alarm"]) for one in found),
        draws=len(found),
    )


def _gravity(seeds: list[int]) -> Disturbed:
    """Take a gravity that is wrong by 1e-6 for a right one: to the records a scale error of the accelerometers."""
    command, found = trajectory(), []
    for seed in seeds:
        truth = draw(seed=seed)
        samples = simulate(truth, command, sigma_m_s2=SIGMA, seed=seed, head=Head(gravity_m_s2=_G * (1 + 1e-6)))
        one = calibrate(command, samples, 0.25, sigma_m_s2=SIGMA, every=10**6)
        error, kappa, *_ = score(one.coefficients, truth, one.bound, one.names)[0]
        found.append(
            {
                "other": error,
                "kappa": kappa,
                "coefficients": one.coefficients,
                "truth": truth[: len(one.names)],
                "deviation": one.standard_deviation,
                "alarm": "residuals" in one.flags,
            }
        )
    return _row("gravity 1e-6 g", "relinearised", "nothing", found)


def remarks(rows: list[Disturbed]) -> list[str]:
    """Return what no test notices, and what the additions to the published method are worth."""
    of = {(row.disturbance, row.method, row.handling): row for row in rows}
    nominal = of["none", "relinearised", ""]
    spikes = of["0.5 % spikes, 2 % lost", "relinearised", "robust lines"]
    text = [f"0.5 % spikes and 2 % lost samples change the error by {100 * (spikes.other / nominal.other - 1):+.0f} %."]
    for row in rows:
        if 2 * row.noticed < row.draws and row.own > 1.5:
            text.append(
                f"not noticed ({row.noticed} of {row.draws}): {row.disturbance}, {row.method}, handled by {row.handling or 'nothing'}; "
                f"it costs {row.other / nominal.other:.1f} x the error and the deviations are {row.own:.1f} x too small"
            )
    for walk in ("1e-05", "0.0001", "0.001"):
        name = f"ARW {walk} deg/sqrt(h)"
        joint, line = of[name, "relinearised", "process noise"], of[name, "on-line", "process noise"]
        text.append(
            f"process noise at {name}: relinearised {joint.other:.3g} % (own {joint.own:.2f}), on-line {line.other:.3g} % (own {line.own:.2f})"
        )
    for size in ("1e-06", "1e-05"):
        line = of[f"torquer error {size}", "on-line", "torquer states"]
        plain = of["none", "on-line", ""]
        text.append(
            f"on-line filter with torquer states at {size}: {line.other:.3g} % (own {line.own:.2f}); "
            f"without the states on a head without the error: {plain.other:.3g} % (own {plain.own:.2f})"
        )
    return text
