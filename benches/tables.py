"""Writes the tables of README.md from the results of bench.py and the instruction counts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

TEXTBOOK, NUMBA, FILTERPY = "IMM: textbook C, gcc -O3", "IMM: numba", "IMM: filterpy"
ONE, SINGLE = "IMM: stillrate, 1 channel f64", "Kalman: stillrate"

# What is asked: sentence, numerator, denominator, bound, whether a larger ratio is better.
TARGETS: tuple[tuple[str, str, str, float, bool], ...] = (
    ("two-model IMM, one channel / textbook C", ONE, TEXTBOOK, 0.5, False),
    ("two-model IMM, one channel / numba", ONE, NUMBA, 0.4, False),
    ("filterpy / two-model IMM", FILTERPY, ONE, 4000, True),
    ("two-model IMM, 8 channels f64 / textbook C", "IMM: stillrate, 8 channels f64", TEXTBOOK, 0.15, False),
    ("two-model IMM, 16 channels f32 / textbook C", "IMM: stillrate, 16 channels f32", TEXTBOOK, 0.07, False),
    ("bank, one channel f64 / textbook C", "bank: stillrate, 1 channel f64", TEXTBOOK, 6, False),
    ("bank, 16 channels f32 / textbook C", "bank: stillrate, 16 channels f32", TEXTBOOK, 1.2, False),
    ("light bank, one channel f64 / textbook C", "light bank: stillrate, 1 channel f64", TEXTBOOK, 3, False),
    ("light bank, 16 channels f32 / textbook C", "light bank: stillrate, 16 channels f32", TEXTBOOK, 0.6, False),
    ("single Kalman / textbook C", SINGLE, "Kalman: textbook C, gcc -O3", 1, False),
    ("update(float) / math.sin", "call: stillrate update, one float", "call: math.sin", 4.5, False),
    ("update(three floats) / math.sin", "call: stillrate update, three floats", "call: math.sin", 10, False),
    ("allantools / Allan deviation", "Allan octave: allantools", "Allan octave: stillrate", 3, True),
    ("scipy / PT1, 1 channel", "PT1 1 channel: scipy lfilter", "PT1 1 channel: stillrate", 1, True),
    ("scipy / PT1, 8 channels", "PT1 8 channels: scipy lfilter", "PT1 8 channels: stillrate", 3, True),
)


def write(results: dict[str, Any], page: Path, counts: Path) -> None:
    parts = [HEADER, ratios(results), times(results), instructions(counts), made_on(results)]
    page.write_text("\n".join(parts), encoding="utf-8")


def ratios(results: dict[str, Any]) -> str:
    times = results["ns_per_sample"]
    rows = ["## Ratios\n", "| ratio | measured | asked | |", "|---|---|---|---|"]
    for sentence, above, below, bound, larger in TARGETS:
        if above not in times or below not in times:
            rows.append(f"| {sentence} | not measured | {'≥' if larger else '≤'} {bound:g} | |")
            continue
        ratio = times[above] / times[below]
        met = ratio >= bound if larger else ratio <= bound
        rows.append(f"| {sentence} | {ratio:.3g} | {'≥' if larger else '≤'} {bound:g} | {'met' if met else 'missed'} |")
    extra = results["import_ms"]["stillrate"] - results["import_ms"]["numpy"]
    met = "met" if extra <= 40 else "missed"
    rows.append(f"| `import stillrate` less `import numpy`, ms | {extra:.0f} | ≤ 40 | {met} |")
    return "\n".join(rows) + "\n"


def times(results: dict[str, Any]) -> str:
    rows = ["## Times\n", "| case | ns a sample and channel |", "|---|---|"]
    rows += [f"| {name} | {value:,.2f} |" for name, value in results["ns_per_sample"].items()]
    if results["left_out"]:
        rows += ["", "Left out because it failed or its output differed:", ""]
        rows += [f"- {name}: {reason}" for name, reason in results["left_out"].items()]
    return "\n".join(rows) + "\n"


def instructions(counts: Path) -> str:
    table = json.loads(counts.read_text(encoding="utf-8"))
    rows = [f"## Instructions a sample and channel ({table['rustc']})\n", "| case | instructions |", "|---|---|"]
    rows += [f"| {case} | {number:,.1f} |" for case, number in table["per_sample"].items()]
    return "\n".join(rows) + "\n"


def made_on(results: dict[str, Any]) -> str:
    rows = ["## Machine and versions\n", *(f"- {name}: {value}" for name, value in results["machine"].items())]
    return "\n".join(rows) + "\n"


HEADER = """# Speed

Written by `make bench`; do not edit. Every case runs in one process, interleaved, and the minimum of all rounds
counts; outputs are compared before anything is timed (relative 1e-9), and what does not agree is left out and listed.
Call overheads, Allan deviations and groups of channels are timed without that comparison (the latter have their own
test). Times depend on the machine and on what else it does; ratios carry over. Single channels run at the instructions
that every x86-64 has, groups of channels with AVX2.

The textbook C kernel is literal matrix products with loops of fixed length two, which gcc unrolls completely.

Commands: `make bench` (times), `python benches/instructions.py --update` (instruction counts).
"""
