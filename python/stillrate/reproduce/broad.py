"""Bias of a real gyro from its motion, beside the mean of its rest: a BROAD recording with motion capture."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate import attitude
from stillrate.bias import reference_bias


@dataclass(frozen=True)
class BroadGap:
    """Bias of a real gyro against motion capture, beside the mean of its rest phase; deg/h.

    The logger truncates towards zero (the bin of code 0 is twice as wide as the others, at rest and in motion), which
    takes half a step off the mean at rest but nothing off the mean in motion: `rest_untruncated_deg_h` puts it back.
    """

    rest_deg_h: npt.NDArray[np.float64]
    rest_untruncated_deg_h: npt.NDArray[np.float64]
    plain_deg_h: npt.NDArray[np.float64]
    plain_sigma_deg_h: npt.NDArray[np.float64]
    with_scale_deg_h: npt.NDArray[np.float64]
    with_scale_sigma_deg_h: npt.NDArray[np.float64]
    scale: npt.NDArray[np.float64]
    lag_s: float
    mounting_deg: npt.NDArray[np.float64]
    chi_square_per_freedom: float

    @property
    def gap_sigmas(self) -> npt.NDArray[np.float64]:
        """Gap without scale factors in the estimate's own standard deviations."""
        return (self.plain_deg_h - self.rest_deg_h) / self.plain_sigma_deg_h

    @property
    def gap_with_scale_sigmas(self) -> npt.NDArray[np.float64]:
        """The same with scale factors estimated."""
        return (self.with_scale_deg_h - self.rest_deg_h) / self.with_scale_sigma_deg_h


def broad_gap(path: Path, every_s: float = 0.5, reference_sigma_deg: float = 0.2) -> BroadGap:
    """Estimate the bias of a BROAD recording from its motion phase and compare it with its rest phase.

    The motion capture's attitude is the reference every `every_s` seconds; mounting and lag are estimated, then scale
    factors as well. The rates are instantaneous samples. The camera frame's heading is unknown, so Earth rate (at most 15 deg/h) stays in the gap.

    Parameters
    ----------
    path : Path
        The recording, with ``gx_dps``..., ``q_true_wxyz`` and ``movement``.
    every_s : float
        Time between fixes, s.
    reference_sigma_deg : float
        White attitude error of the motion capture, deg an axis.
    """
    with np.load(path, allow_pickle=False) as archive:
        rates = np.stack([archive[f"g{axis}_dps"] for axis in "xyz"], axis=1).astype(np.float64)
        quaternions = archive["q_true_wxyz"].astype(np.float64)
        moving = archive["movement"]
        period = float(np.median(np.diff(archive["t_s"])))
        meta = json.loads(str(archive["meta_json"]))
    first, last = (int(k) for k in np.flatnonzero(moving)[[0, -1]])
    rest = rates[: int(meta["stats"]["static_span"][1])].mean(axis=0) * 3600.0
    half_step = 0.5 * np.array(meta["stats"]["lsb_dps"]) * 3600.0
    wanted = np.arange(first, last, max(1, round(every_s / period)))
    fixes = wanted[np.isfinite(quaternions[wanted]).all(axis=1)]
    span = slice(fixes[0] - 40, fixes[-1] + 40)
    attitudes = [attitude.from_quaternion(q / np.linalg.norm(q)) for q in quaternions[fixes]]

    def solve(scale: bool) -> Any:
        return reference_bias(
            np.radians(rates[span]),
            period,
            fixes - span.start,
            attitudes,
            estimate_mounting=True,
            estimate_lag=True,
            estimate_scale=scale,
            earth_rate=False,
            instantaneous=True,
            angle_random_walk_rad_sqrt_s=np.radians(0.4) / 60.0,
            reference_sigma_rad=np.radians(reference_sigma_deg),
            prior_lag_s=0.02,
            prior_bias_rad_s=np.radians(1.0),
        )

    plain, scaled = solve(False), solve(True)
    to_deg_h = np.degrees(1.0) * 3600.0
    return BroadGap(
        rest_deg_h=rest,
        rest_untruncated_deg_h=rest + np.sign(rest) * half_step,
        plain_deg_h=plain.bias_rad_s * to_deg_h,
        plain_sigma_deg_h=np.sqrt(np.diag(plain.covariance)[:3]) * to_deg_h,
        with_scale_deg_h=scaled.bias_rad_s * to_deg_h,
        with_scale_sigma_deg_h=np.sqrt(np.diag(scaled.covariance)[:3]) * to_deg_h,
        scale=scaled.scale,
        lag_s=scaled.lag_s,
        mounting_deg=np.degrees(scaled.mounting_rad),
        chi_square_per_freedom=scaled.chi_square / max(1, scaled.degrees_of_freedom),
    )
