"""What was hoped for of the filters in the loop, and whether this run's figures bear it out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from stillrate.platform.findings import BANK_IN_LOOP, LINEAR, RIVAL
from stillrate.platform.study import BANK, PLATFORM, Result, Study
from stillrate.platform.tuning import Row

BUDGET, SMALL_BUDGET, FAST_BUDGET = 0.05, 0.02, 0.1
"""Rest jitter, percent: the usual budget and the small one at 50 Hz, and that at 200 Hz."""


@dataclass(frozen=True)
class Goal:
    """A hope in words, the figure asked for, the figure found, and whether it holds."""

    what: str
    asked: str
    found: str
    holds: bool


def goals(study: Study) -> list[Goal]:
    """Return every goal that the study's figures can judge: only for the 30 kg platform, by its control rate."""
    rate = study.setup.sample_rate_hz
    results = [result for result in study.results if result.design.plant == PLATFORM]
    found: list[Goal] = []
    if rate == 50.0:
        found += _magnitudes(results)
        found += _small_budget(results)
        found += _usual_budget(results)
    if rate == 200.0:
        found += _fast(results)
    if results:
        found += _demands(results)
    return [*found, *_fixed(study)]


def _best(results: Iterable[Result], names: Iterable[str], jitter_percent: float) -> Result | None:
    """Return the design of least residual (largest angle) whose measured jitter stays within a limit."""
    held = [r for r in results if r.design.family in set(names) and r.row.jitter_percent <= jitter_percent]
    return min(held, key=lambda r: r.row.max_deg[0], default=None)


def _at(results: Iterable[Result], name: str, budget_percent: float) -> Row | None:
    rows = [r.row for r in results if r.design.family == name and r.design.budget_percent == budget_percent]
    return rows[0] if rows else None


def _magnitudes(results: list[Result]) -> Iterator[Goal]:
    raw = _at(results, "none", BUDGET)
    if raw is not None:
        largest = raw.max_deg[0]
        yield Goal(
            f"no filter at {BUDGET:g} %: largest angle",
            "4.6 to 5.2 deg",
            f"{largest:.2f} deg with {raw.jitter_percent:.3f} %",
            4.6 <= largest <= 5.2 and raw.jitter_percent <= BUDGET,
        )
    bank = _best(results, [BANK_IN_LOOP], 0.025)
    if bank is not None:
        largest = bank.row.max_deg[0]
        yield Goal(
            "the bank with at most 0.025 % of jitter: largest angle",
            "at most 2.0 deg",
            f"{largest:.2f} deg with {bank.row.jitter_percent:.3f} %",
            largest <= 2.0,
        )


def _small_budget(results: list[Result]) -> Iterator[Goal]:
    bank = _best(results, [BANK_IN_LOOP], SMALL_BUDGET)
    for what, names in (("the best linear filter", LINEAR), (RIVAL, (RIVAL,))):
        other = _best(results, names, SMALL_BUDGET)
        if bank is None or other is None:
            continue
        share = bank.row.max_deg[0] / other.row.max_deg[0]
        name = f" ({other.design.family})" if len(names) > 1 else ""
        yield Goal(
            f"measured jitter at most {SMALL_BUDGET:g} %: the bank's largest angle against {what}{name}",
            "at most 0.50",
            f"{share:.2f} ({bank.row.max_deg[0]:.2f} of {other.row.max_deg[0]:.2f} deg)",
            share <= 0.5,
        )


def _usual_budget(results: list[Result]) -> Iterator[Goal]:
    bank, rival = _at(results, BANK_IN_LOOP, BUDGET), _at(results, RIVAL, BUDGET)
    if bank is not None and rival is not None:
        yield Goal(
            f"at {BUDGET:g} %: the bank's rms angle against {RIVAL}",
            "no more",
            f"{bank.rms_deg[0]:.2f} deg ({bank.jitter_percent:.3f} %) against {rival.rms_deg[0]:.2f} deg "
            f"({rival.jitter_percent:.3f} %)",
            bank.rms_deg[0] <= rival.rms_deg[0],
        )


def _fast(results: list[Result]) -> Iterator[Goal]:
    bank = _best(results, [BANK_IN_LOOP], FAST_BUDGET / 3.0)
    linear = [r for r in results if r.design.family in LINEAR and r.row.jitter_percent <= FAST_BUDGET]
    if bank is None or not linear:
        return
    best = min(linear, key=lambda r: r.row.rms_deg[0])
    share = bank.row.rms_deg[0] / best.row.rms_deg[0]
    quieter = bank.row.jitter_percent / best.row.jitter_percent
    yield Goal(
        f"at 200 Hz: the bank against the best linear filter within {FAST_BUDGET:g} % ({best.design.family})",
        "rms at most 1.15, jitter at most 0.33",
        f"rms {share:.2f} ({bank.row.rms_deg[0]:.2f} of {best.row.rms_deg[0]:.2f} deg), jitter {quieter:.2f}",
        share <= 1.15 and quieter <= 1.0 / 3.0,
    )


def _demands(results: list[Result]) -> Iterator[Goal]:
    for where, measure in (("over all seeds", _pooled), ("on the worst single seed", lambda r: r.recovery)):
        worst = max(results, key=measure)
        yield Goal(
            f"rest jitter 6 s after a 15 deg tilt {where}, against undisturbed rest",
            "below 2 for every design",
            f"at most {measure(worst):.2f} ({worst.design.family} at {worst.design.budget_percent:g} %)",
            measure(worst) < 2.0,
        )
    level = max(results, key=lambda r: r.row.levelling_deg[0])
    yield Goal(
        "levelling error 25 s after a start at 20 deg, mean over seeds",
        "at most 0.2 deg for every design",
        f"at most {level.row.levelling_deg[0]:.2f} deg ({level.design.family} at {level.design.budget_percent:g} %), "
        f"of it {max(r.row.levelling_own_deg[0] for r in results):.2f} deg the loop's own",
        level.row.levelling_deg[0] <= 0.2,
    )


def _pooled(result: Result) -> float:
    return result.row.jitter_percent / result.row.undisturbed_percent


def _fixed(study: Study) -> Iterator[Goal]:
    for bank in (swapped for swapped in study.swapped if swapped.name == BANK):
        yield Goal(
            "controller fixed: the bank's residual, and how much quieter the actuator rests",
            "within 2 %, at least 8 times",
            f"{bank.change_percent:+.1f} %, {bank.quieter:.1f} times",
            abs(bank.change_percent) < 2.0 and bank.quieter >= 8.0,
        )
