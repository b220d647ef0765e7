"""``reproduce rate-table``: the published table 3, and what its methods do on motion they have not seen."""

from __future__ import annotations

from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from stillrate import _native
from stillrate.reproduce.progress import Advance, parts, unwatched
from stillrate.reproduce.rate_table_pictures import motions, staircase
from stillrate.reproduce.row import Row

PUBLISHED_MSE = {
    "raw": (2.5e-2, 2.8e-2),
    "published network + QPSO-KF": (2.9e-8, 3.6e-6),
    "QPSO-KF": (9.6e-4, 1.9e-3),
    "BP-KF (stand-in)": (1.9e-3, 3.2e-3),
}
"""Smallest and largest published mean squared error of the six records, (deg/s)^2."""

PUBLISHED_VMD = "1.5e-03 .. 2.7e-03"
PUBLISHED_SHAPE = (0.706, 0.999)
"""Smallest and largest published mean absolute error over root mean square, published network + QPSO-KF."""

CONCLUSION = (
    "The published accuracy belongs to six rates and not to the gyro. A 1-10-1 network that regresses the error on the "
    "noisy measured rate learns to answer with the nearest of the six rates it was trained at (the staircase), so its error "
    "on those rates vanishes and on every other motion it is several times worse than no correction at all. No unbiased filter can reach "
    "such figures: they are below the mean of the whole record. What helps is modest and real: a smooth curve fitted to the "
    "true rate and chosen on rates left out, behind a filter whose noise was tuned on moving records; nearly all of the gain "
    "is the filter's, and on jumps only the bank of models (IMM) keeps it."
)


def reproduce(folder: Path | None = None, *, seeds: int = 4, units: int = 10, epochs: int = 300) -> str:
    """Run the study and return it as text; with a folder, write the text and two pictures there.

    Parameters
    ----------
    folder : Path, optional
        Where `rate_table.md`, `rate_table_staircase.svg` and `rate_table_motions.svg` go.
    seeds : int
        Data seeds of the published table.
    units : int
        Simulated units of the comparison on held-out motion.
    epochs : int
        Most training epochs of the published network.
    """
    tables = [_native.rate_table_table3(0, seed, epochs) for seed in range(1, seeds + 1)]
    studies = [_native.rate_table_study(unit, unit, epochs if unit == 1 else 0) for unit in range(1, units + 1)]
    text = (
        "\n\n".join(
            [
                "# Rate-table error model: the published table and held-out motion",
                _table3(tables),
                _orderings(tables),
                _held_out(studies),
                CONCLUSION,
            ]
        )
        + "\n"
    )
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "rate_table.md").write_text(text, encoding="utf-8")
        staircase(folder / "rate_table_staircase.svg", tables[0])
        motions(folder / "rate_table_motions.svg", studies)
    return text


def rows(short: bool = False, advance: Advance = unwatched) -> list[Row]:
    """Return table 3 and what follows from it beside ours; the short form has 1 data seed and trains for fewer epochs."""
    seeds, epochs, trained = (1, 100, 60) if short else (4, 300, 300)
    tables = [_native.rate_table_table3(0, seed, epochs) for seed in parts(range(1, seeds + 1), advance, end=0.8)]
    unseen = {row[0]: row[1] for row in _native.rate_table_study(1, 1, trained)["rows"]}
    effort = f"{seeds} seed{'s' * (seeds > 1)} x 6 records, at most {epochs} epochs"

    def row(quantity: str, published: str, ours: float | None, unit: str = "", **more: Any) -> Row:
        return Row(study="rate-table", quantity=quantity, published=published, ours=ours, unit=unit, **more)

    found = []
    values = _by_method(tables)
    for method, (low, high) in PUBLISHED_MSE.items():
        undefined = "stand-in" in method
        found.append(
            row(f"table 3: mean squared error, {method}, median", f"{low:.1e} .. {high:.1e}",
                None if undefined else median(values[method]), "" if undefined else "(deg/s)^2", least=low, most=high, effort=effort,
                reason=f"the publication does not define BP-KF; our stand-in has {median(values[method]):.1e}" if undefined else _LEVELS[method])
        )  # fmt: skip
    count = len(values["raw"])
    better = sum(a < b for a, b in zip(values[_BEST], values["QPSO-KF"], strict=True))
    return [
        *found,
        row("table 3: mean squared error, VMD + wavelet threshold", PUBLISHED_VMD, None,
            reason="the decomposition is not part of the package; benches/rate_table_baselines.py compares it"),
        row("table 3: mean absolute error over root mean square, published network + QPSO-KF, median",
            f"{PUBLISHED_SHAPE[0]} .. {PUBLISHED_SHAPE[1]}", median(_shapes(tables, _BEST)), least=PUBLISHED_SHAPE[0], most=PUBLISHED_SHAPE[1],
            effort=effort, reason="1 is a constant offset, 0.80 Gaussian noise"),
        row("table 3: records on which the published network + QPSO-KF is below QPSO-KF", "all", float(better), f"of {count}",
            least=count, most=count, effort=effort, reason="trained on the very six rates it is scored on"),
        row("the published network improves the gyro: its error over raw, on motion it has not seen", "below 1",
            unseen["published network"] / unseen["raw"], "times", most=1.0, effort=f"1 unit, at most {trained} epochs",
            reason="the network answers with the nearest of the six rates it was trained at"),
        row("the same with its Kalman filter", "below 1", unseen["published network + its KF"] / unseen["raw"], "times", most=1.0,
            effort=f"1 unit, at most {trained} epochs", reason="tuned on constant rates, it does not follow motion"),
    ]  # fmt: skip


_BEST = "published network + QPSO-KF"
_LEVELS = {
    "raw": "level of the simulated unit set from the published table",
    _BEST: "the swarm is not stopped at 1e-5 here, which its first particles already meet; such figures are below the mean of the whole record",
    "QPSO-KF": "bias and drift of the simulated unit were read off the published table: a level agrees or not by construction",
}


def _by_method(tables: list[dict[str, Any]]) -> dict[str, list[float]]:
    """Collect the mean squared errors of each method over seeds and records, in a fixed order."""
    found: dict[str, list[float]] = {}
    for table in tables:
        for method, mse, _ in table["rows"]:
            found.setdefault(method, []).extend(mse)
    return found


def _shapes(tables: list[dict[str, Any]], method: str) -> list[float]:
    """Return mean absolute error over root mean square of a method, a seed and record each: 1 is a constant offset."""
    rows = [(mse, mae) for table in tables for name, mse, mae in table["rows"] if name == method]
    return [a / m**0.5 for mse, mae in rows for m, a in zip(mse, mae, strict=True)]


def _table3(tables: list[dict[str, Any]]) -> str:
    lines = [
        "## Six constant rates, each method trained or tuned with the truth of the very records it is scored on",
        "",
        "MSE in (deg/s)^2; MAE/RMS is 0.80 for Gaussian errors and 1 for a constant offset.",
        "",
        f"| method | MSE median [min, max], {len(tables)} seeds x 6 records | MAE/RMS median | published |",
        "|---|---|---|---|",
    ]
    for method, values in _by_method(tables).items():
        low_high = PUBLISHED_MSE.get(method)
        published = "-" if low_high is None else f"{low_high[0]:.1e} .. {low_high[1]:.1e}"
        lines.append(
            f"| {method} | {median(values):.1e} [{min(values):.1e}, {max(values):.1e}] | "
            f"{median(_shapes(tables, method)):.2f} | {published} |"
        )
    lines.append(f"| VMD + wavelet threshold | in `benches/rate_table_baselines.py` | - | {PUBLISHED_VMD} |")
    return "\n".join(lines)


def _orderings(tables: list[dict[str, Any]]) -> str:
    """Say which published orderings appear and which do not."""
    values = _by_method(tables)
    count = len(values["raw"])

    def below(first: str, second: str) -> int:
        return sum(a < b for a, b in zip(values[first], values[second], strict=True))

    return "\n".join(
        [
            "Orderings:",
            "",
            f"- published network + KF below QPSO-KF: {below('published network + QPSO-KF', 'QPSO-KF')} of {count}",
            f"- QPSO-KF below BP-KF: {below('QPSO-KF', 'BP-KF (stand-in)')} of {count} (never by much)",
            f"- everything below raw: "
            f"{min(below(name, 'raw') for name in values if name != 'raw')} of {count} at worst",
            "- published QPSO-KF below VMD below BP-KF: VMD is compared in "
            "`benches/rate_table_baselines.py`; the publication does "
            "not define BP-KF, the stand-in maps two statistics of a record to Q/R.",
            *_levels(values),
        ]
    )


def _levels(values: dict[str, list[float]]) -> list[str]:
    """Say of which methods the median lies outside the published range."""
    lines = []
    for method, (low, high) in PUBLISHED_MSE.items():
        middle = median(values[method])
        if not low <= middle <= high:
            side = "below" if middle < low else "above"
            lines.append(
                f"- level not reproduced: {method}, median {middle:.1e} lies {side} the published "
                f"{low:.1e} .. {high:.1e}"
            )
    if any("QPSO-KF" in line for line in lines):
        lines.append(
            "  (the swarm is not stopped at 1e-5 here, a rule that its first, random particles "
            "already meet; level and drift of "
            "the simulated unit were read off the published table, so only orderings and the collapse are findings)"
        )
    return lines


def _held_out(studies: list[dict[str, Any]]) -> str:
    motions, jumps = _native.rate_table_motions()
    methods = [row[0] for row in studies[0]["rows"]]
    lines = [
        f"## Held-out motion, {len(studies)} units, 2 kHz, deg/s RMS over units",
        "",
        "Calibrated on 13 rates of 10 s; noise tuned on other motions; test noise of its own. "
        "The published network is shown for unit 1.",
        "",
        "| method | "
        + " | ".join(["in range", "over raw", "worst motion over raw", *_SHORT, *jumps, "outside"])
        + " |",
        "|" + "---|" * (len(_SHORT) + len(jumps) + 5),
    ]
    for method in methods:
        rows = [(s, r) for s in studies for r in s["rows"] if r[0] == method]
        raws = [next(r for r in s["rows"] if r[0] == "raw") for s, _ in rows]
        overall = _pool(r[1] for _, r in rows)
        worst = max(a / b for (_, r), raw in zip(rows, raws, strict=True) for a, b in zip(r[2], raw[2], strict=True))
        cells = [overall, overall / _pool(raw[1] for raw in raws), worst]
        cells += [_pool(r[2][motions.index(name)] for _, r in rows) for name in _SHORT.values()]
        cells += [_pool(r[3][k] for _, r in rows) for k in range(len(jumps))]
        cells.append(_pool(r[4] for _, r in rows))
        lines.append(f"| {method} | " + " | ".join(f"{cell:.3f}" for cell in cells) + " |")
    lines += ["", _bank(studies), "", _tuning(studies)]
    return "\n".join(lines)


_SHORT = {
    "constant 0": "constant 0",
    "ramp": "ramp -6..6 in 10 s",
    "sine 0.1": "sine 4, 0.1 Hz",
    "sine 0.5": "sine 4, 0.5 Hz",
    "sine 1": "sine 4, 1 Hz",
    "sine 2": "sine 4, 2 Hz",
}


def _pool(values: Any) -> float:
    return float(np.sqrt(np.mean(np.square(list(values)))))


def _bank(studies: list[dict[str, Any]]) -> str:
    """Compare the bank with the better of the two honest small filters on every motion of every unit."""
    worst = 0.0
    for study in studies:
        rows = {row[0]: [*row[2], *row[3]] for row in study["rows"]}
        small = [
            rows["calibration + KF, innovations on motion"],
            rows["two-state KF, innovations, then calibration"],
            rows["calibration + KF, truth on motion"],
            rows["two-state KF, truth, then calibration"],
        ]
        bank = rows["IMM bank, innovations, then calibration"]
        worst = max(worst, *(b / min(s) for b, s in zip(bank, zip(*small, strict=True), strict=True)))
    return (
        f"IMM bank over the best small filter tuned on motion, worst motion of all units, jumps included: {worst:.2f}."
    )


def _tuning(studies: list[dict[str, Any]]) -> str:
    gaps = [[abs(s["blind"][k] - s["seen"][k]) for s in studies] for k in (0, 1)]
    still = [s["on_constants"][0] for s in studies]
    return (
        "Innovations against truth, log10(Q/R) on the moving records: at most "
        f"{max(gaps[0]):.2f} decades apart (random walk), {max(gaps[1]):.2f} (two states). On "
        f"constant records the innovations "
        f"give {median(still):.1f} instead of {median(s['blind'][0] for s in studies):.1f}, and a warning: "
        f"{sum(bool(s['warned']) for s in studies)} of {len(studies)}."
    )
