"""Tables of the recursive filters and of the bias from two fixes, beside the printed claims."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from rich.console import Console
from rich.table import Table

from stillrate import _native, attitude, closed_forms
from stillrate.bias import reference_bias
from stillrate.reproduce.progress import Advance, unwatched
from stillrate.reproduce.row import Row

JUDGING_SEEDS = (20_261, 20_262, 20_263)
"""Seeds of the table; the rival is tuned on others."""
TUNING_SEEDS = (911, 912, 913)
DRAWS = 200
LAMBDA = 0.9512


def responses() -> list[dict[str, Any]]:
    """Return the steady-state figures of filters with matched noise reduction, measured on the filters themselves."""
    rows: list[dict[str, Any]] = _native.recursive_responses()
    return rows


def adaptive(draws: int = DRAWS, seeds: tuple[int, ...] = JUDGING_SEEDS) -> dict[str, Any]:
    """Return RMS error over sigma of every filter in every scenario; one-euro tuned by search on other seeds."""
    found: dict[str, Any] = _native.recursive_bench(list(seeds), list(TUNING_SEEDS), draws)
    return found


def two_fixes(time_s: float = 2.5, dt_s: float = 0.005) -> list[tuple[str, str, list[float]]]:
    """Return motion, method and error an axis in deg/h of the bias from two fixes, without noise."""
    rows: list[tuple[str, str, list[float]]] = _native.two_fix_table(time_s, dt_s)
    return rows


def claims(bench: dict[str, Any], steady: list[dict[str, Any]], effort: str = "") -> list[Row]:
    """Return the printed claims on filters of DOI 10.7690/bgzdh.2019.03.009 with what was found here."""
    errors = {name: error for name, error, _ in bench["rows"]}
    lag = {row["name"]: row["delay"] for row in steady}["RLS = KF = EMA steady"]
    noise = closed_forms.rls_noise(LAMBDA, 20) / _kf_noise(20)
    follows = errors["EMA .9512"][-1]

    def claim(quantity: str, published: str, ours: float, unit: str = "", **more: Any) -> Row:
        return Row(study="recursive", quantity=quantity, published=published, ours=ours, unit=unit, **more)

    return [
        claim("gain recursion with a plus sign, as printed: gain at sample 481", "0 to 1", _gain(+1), least=0.0, most=1.0,
              reason="with a plus sign the gain grows without end; an error of print"),
        claim("the same with a minus sign: gain at sample 481", "0 to 1", _gain(-1), least=0.0, most=1.0,
              reason="the sign is put right"),
        claim("the first output is the first sample: gain at sample 1", "1", closed_forms.rls_gain(LAMBDA, 1),
              least=1.0, most=1.0, reason="no delay at start-up"),
        claim("HMM/RLS has no delay: steady lag", "0", lag, "samples", least=-0.5, most=0.5,
              reason="none at start-up; in the steady state it is an exponential average"),
        claim("HMM/RLS is better than HMM/KF: its noise variance over the KF's at sample 20", "below 1", noise, most=1.0,
              reason="same first output and same steady state; in between their gains differ"),
        claim("HMM/RLS follows manoeuvres: error in mixed motion over that without a filter", "below 1", follows, most=1.0,
              effort=effort, reason=f"a filter of variable forgetting has {errors['VFF'][-1]:.2f}, at the same noise at rest"),
    ]  # fmt: skip


def rows(short: bool = False, advance: Advance = unwatched) -> list[Row]:
    """Return the claims on filters; the short form judges on 1 seed and tunes the rival by a fifth of the draws."""
    seeds, draws = (JUDGING_SEEDS[:1], DRAWS // 5) if short else (JUDGING_SEEDS, DRAWS)
    bench = adaptive(draws, seeds)
    advance(0.9)
    return claims(bench, responses(), f"{len(seeds)} seed{'s' * (len(seeds) > 1)}")


def two_point_rows(short: bool = False, advance: Advance = unwatched) -> list[Row]:
    """Return the claims on the bias from two fixes; nothing is drawn, so both forms are the same."""
    fixes = two_fixes()
    advance(1.0)
    exact = max(abs(e) for motion, method, error in fixes if method == "exact" for e in error)
    small = max(abs(e) for motion, method, error in fixes if method == "small-angle" for e in error)
    floor = _floor_deg_h(0.3, 2.5)

    def fix(quantity: str, ours: float, **more: Any) -> Row:
        return Row(study="two-point", quantity=quantity, published="0.15", ours=ours, unit="deg/h", most=0.15, **more)

    return [
        fix("bias from two fixes to 0.1 %, no noise, exact method", exact, reason="largest of two motions and three axes"),
        fix("the same with the small-angle formula", small, reason="the formula leaves out that the axes turn"),
        fix("the same with a real gyro (0.3 deg/sqrt(h), 2.5 s)", floor, floor=floor,
            reason="angle random walk over the root of the time is a bound for every estimator; ours is that bound"),
    ]  # fmt: skip


def _gain(sign: int) -> float:
    """Return the gain at sample 481 with the second term of the printed recursion added or taken off."""
    gain = 1.0
    for _ in range(480):
        gain = (gain + sign * gain * gain / (LAMBDA + gain)) / LAMBDA
    return gain


def _floor_deg_h(walk_deg_sqrt_h: float, time_s: float) -> float:
    """Return the angle random walk over the root of the time: no bias is known better from two perfect fixes."""
    return float(walk_deg_sqrt_h / np.sqrt(time_s / 3600.0))


def _kf_noise(n: int) -> float:
    variance = 0.0
    for k in range(1, n + 1):
        gain = closed_forms.kf_gain(LAMBDA, k)
        variance = (1 - gain) ** 2 * variance + gain**2
    return variance


def _steady_table(steady: list[dict[str, Any]]) -> Table:
    table = Table(title="Matched noise reduction: delays in samples, f3 as a fraction of the sample rate")
    for name in ("filter", "noise", "DC delay", "at 1 Hz/200", "f3/fs", "t50/t90/2 %", "overshoot"):
        table.add_column(name, justify="left" if name == "filter" else "right")
    for row in steady:
        table.add_row(
            row["name"],
            f"{row['noise_ratio']:.4f}",
            f"{row['delay']:.2f}",
            f"{row['phase_delay']:.2f}",
            f"{row['half_power']:.4f}",
            f"{row['half']}/{row['nine_tenths']}/{row['settled']}",
            f"{100 * row['overshoot']:.1f} %",
        )
    return table


def _adaptive_table(bench: dict[str, Any]) -> Table:
    table = Table(title=f"RMS error over sigma, seeds {', '.join(map(str, JUDGING_SEEDS))}; lag in samples")
    for name in ("filter", *bench["scenarios"], "lag mixed"):
        table.add_column(name, justify="left" if name == "filter" else "right")
    for name, error, lag in bench["rows"]:
        table.add_row(name, *(f"{value:.3g}" for value in error), f"{lag:.1f}")
    return table


def _claims_table(found: list[Row]) -> Table:
    table = Table(title="Printed claims (DOI 10.7690/bgzdh.2019.03.009)")
    for name in ("claim", "found here", "verdict"):
        table.add_column(name)
    for row in found:
        table.add_row(row.quantity, f"{row.ours:.4g} {row.unit}; {row.reason}", row.verdict)
    return table


def recursive(console: Console | None = None) -> None:
    """Print the tables of the recursive filters and the printed claims with a verdict each."""
    out = console or Console()
    steady, bench = responses(), adaptive()
    out.print(_steady_table(steady))
    out.print(_adaptive_table(bench))
    minimum, beta, derivative = bench["one_euro"]
    out.print(
        f"one-euro tuned on seeds {TUNING_SEEDS} by {2 * DRAWS} draws: minimum {minimum:.3g} Hz, beta {beta:.3g}, "
        f"derivative {derivative:.3g} Hz"
    )
    out.print(_claims_table([*claims(bench, steady), *two_point_rows()]))


def two_point(console: Console | None = None) -> None:
    """Print the exact bias from two fixes beside the classical shortcuts, for slow and fast motion."""
    out = console or Console()
    table = Table(title="Bias 140/150/160 deg/h from two fixes over 2.5 s at 5 ms, no noise: error in deg/h")
    for name in ("motion", "method", "x", "y", "z"):
        table.add_column(name, justify="left" if name in ("motion", "method") else "right")
    for motion, method, error in two_fixes():
        table.add_row(motion, method, *(f"{value:.3g}" for value in error))
    out.print(table)


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
