"""What a study says, in sentences whose figures are its own."""

from __future__ import annotations

from collections.abc import Sequence

from stillrate.platform.study import Result

BANK_IN_LOOP = "ms-imm-ikf+pt1"
RIVAL = "one-euro"
LINEAR = ("none", "pt1", "biquad", "kalman-5.3hz")


def findings(results: Sequence[Result]) -> list[str]:
    """Compare the bank with the best linear filter and with one-euro, budget by budget, whichever way it comes out."""
    found = []
    for budget in dict.fromkeys(result.design.budget_percent for result in results):
        rows = {r.design.family: r.row for r in results if r.design.budget_percent == budget}
        linear = [name for name in LINEAR if name in rows]
        if BANK_IN_LOOP not in rows or not (linear or RIVAL in rows):
            continue
        bank = rows[BANK_IN_LOOP]
        rivals = [min(linear, key=lambda name: rows[name].max_deg[0])] if linear else []
        rivals += [RIVAL] if RIVAL in rows else []
        against = "; ".join(
            f"{bank.max_deg[0] / rows[name].max_deg[0]:.2f} of {name}'s {rows[name].max_deg[0]:.2f} deg "
            f"(rms {bank.rms_deg[0] / rows[name].rms_deg[0]:.2f} of {rows[name].rms_deg[0]:.2f} deg)"
            for name in rivals
        )
        found.append(
            f"At a budget of {budget:g} % the bank's largest angle is {bank.max_deg[0]:.2f} deg (rms "
            f"{bank.rms_deg[0]:.2f} deg) with {bank.jitter_percent:.4f} % of jitter: {against}."
        )
    return found
