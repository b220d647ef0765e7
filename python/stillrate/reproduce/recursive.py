"""Tables of the recursive filters and of the bias from two fixes, beside the printed claims."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from stillrate import _native, closed_forms
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
