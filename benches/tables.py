"""Writes README.md from the results of bench.py and the counts of instructions.py; both call it when they have written theirs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

PAGE, RESULTS, COUNTS = (Path(__file__).with_name(name) for name in ("README.md", "results.json", "instructions.json"))
TEXTBOOK, UNROLLED = "IMM: textbook C, sizes as arguments", "IMM: textbook C, gcc -O3"
NUMBA, NUMBA_UNROLLED = "IMM: numba, sizes as arguments", "IMM: numba"
FILTERPY = "IMM: filterpy"
ONE, SINGLE = "IMM: stillrate, 1 channel f64", "Kalman: stillrate"

# Those measured against the textbook kernel: what, which case, bound.
AGAINST_TEXTBOOK: tuple[tuple[str, str, float], ...] = (
    ("two-model IMM, one channel", ONE, 0.5),
    ("two-model IMM, 8 channels f64", "IMM: stillrate, 8 channels f64", 0.15),
    ("two-model IMM, 16 channels f32", "IMM: stillrate, 16 channels f32", 0.07),
    ("bank, one channel f64", "bank: stillrate, 1 channel f64", 6),
    ("bank, 16 channels f32", "bank: stillrate, 16 channels f32", 1.2),
    ("light bank, one channel f64", "light bank: stillrate, 1 channel f64", 3),
    ("light bank, 16 channels f32", "light bank: stillrate, 16 channels f32", 0.6),
)

# What is asked: sentence, numerator, denominator, bound, whether a larger ratio is better.
TARGETS: tuple[tuple[str, str, str, float, bool], ...] = (
    *((f"{what} / textbook C", case, TEXTBOOK, bound, False) for what, case, bound in AGAINST_TEXTBOOK),
    *((f"{what} / unrolled C", case, UNROLLED, bound, False) for what, case, bound in AGAINST_TEXTBOOK),
    ("two-model IMM, one channel / numba", ONE, NUMBA, 0.4, False),
    ("two-model IMM, one channel / unrolled numba", ONE, NUMBA_UNROLLED, 0.4, False),
    ("filterpy / two-model IMM", FILTERPY, ONE, 4000, True),
    ("single Kalman / textbook C", SINGLE, "Kalman: textbook C, gcc -O3", 1, False),
    ("single Kalman / kfilter (Rust)", SINGLE, "Kalman: kfilter (Rust)", 1, False),
    ("update(float) / math.sin", "call: stillrate update, one float", "call: math.sin", 4.5, False),
    ("update(three floats) / math.sin", "call: stillrate update, three floats", "call: math.sin", 10, False),
    ("allantools / Allan deviation", "Allan octave: allantools", "Allan octave: stillrate", 3, True),
    ("scipy / PT1, 1 channel", "PT1 1 channel: scipy lfilter", "PT1 1 channel: stillrate", 1, True),
    ("scipy / PT1, 8 channels", "PT1 8 channels: scipy lfilter", "PT1 8 channels: stillrate", 3, True),
    ("scipy / biquad, 1 channel", "biquad 1 channel: scipy sosfilt", "biquad 1 channel: stillrate", 1, True),
    ("scipy / biquad, 8 channels", "biquad 8 channels: scipy sosfilt", "biquad 8 channels: stillrate", 3, True),
    *(
        (
            f"scipy / FIR of {taps} taps, {label}",
            f"FIR of {taps} taps {label}: scipy lfilter",
            f"FIR of {taps} taps {label}: stillrate",
            1,
            True,
        )
        for taps in (21, 101)
        for label in ("1 channel", "8 channels")
    ),
    ("scipy / RLS, 1 channel", "RLS 1 channel: scipy lfilter", "RLS 1 channel: stillrate", 1, True),
    ("scipy / RLS, 8 channels", "RLS 8 channels: scipy lfilter", "RLS 8 channels: stillrate", 3, True),
)


def page() -> str:
    """Return what README.md must hold."""
    results, counts = (json.loads(path.read_text(encoding="utf-8")) for path in (RESULTS, COUNTS))
    return "\n".join([HEADER, ratios(results), times(results), instructions(counts), made_on(results)])


def write() -> None:
    PAGE.write_text(page(), encoding="utf-8")


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
        rows += ["", "Left out because it is not installed, failed or gave another output:", ""]
        rows += [f"- {name}: {reason}" for name, reason in results["left_out"].items()]
    return "\n".join(rows) + "\n"


def instructions(table: dict[str, Any]) -> str:
    rows = [f"## Instructions a sample and channel ({table['rustc']})\n", "| case | instructions |", "|---|---|"]
    rows += [f"| {case} | {number:,.1f} |" for case, number in table["per_sample"].items()]
    return "\n".join(rows) + "\n"


def made_on(results: dict[str, Any]) -> str:
    rows = ["## Machine and versions\n", *(f"- {name}: {value}" for name, value in results["machine"].items())]
    return "\n".join(rows) + "\n"


HEADER = """# Speed

Written by `make bench`; do not edit. Every case runs in one process, interleaved, and the minimum of all rounds
counts. Outputs are compared before anything is timed, to a relative 1e-9 (padasip, which starts from a large but finite covariance, to 1e-6), and
what does not agree, or is not installed, is left out and listed. Not compared: scipy's recursive mean, which has its final gain from the
start; call overheads; Allan deviations; groups of channels, which have their own test. Times depend on the machine and on what else it
does; ratios carry over. Single channels run at the instructions that every x86-64 has, groups of channels with AVX2.

The textbook C and numba kernels of two interacting models come in two forms, both of literal products. "Textbook" takes the numbers of
models and states as arguments, as a matrix library does: the goals were set with a kernel that took 122 ns (C) and 149 ns (numba) on a similar machine,
which is this form. "Unrolled" has both fixed at two when it is compiled, so that the compiler undoes every loop: a stricter
yardstick, shown with the same bounds.

How far from the machine's limit: with AVX2 and eight channels the some 330 operations and five divisions of a step are bound by the
ports at 6.9 ns a sample and channel on this kind of processor if nothing waits. One channel alone is bound by the chain from one
sample's evidence to the next one's mixture: 1/S (13 cycles), the exponent (6), 2^x (35), the mixing share (19, with a
division) and the mixed variance (15) make some 90 cycles, 23 ns at 3.9 GHz; what is above it is two square roots and five
divisions that share one divider.

| command | what it measures |
|---|---|
| `make bench` | times (`bench.py`), [accuracy](accuracy.md) (`accuracy.py`) and [scaling](scaling.md) (`scaling.py`); installs the peers of `requirements.txt`, needs gcc |
| `python benches/instructions.py --update` | instructions a sample, with valgrind; `make test` fails where one grew by more than 3 % |
| `python benches/gimbal_speed.py` | the gimbal filters beside a port to numba |
| `python benches/recursive_speed.py` | the recursive filters beside scipy |
| `python benches/rate_table_tuning.py` | tuning of one long record beside a loop in numba |
| `python benches/rate_table_baselines.py` | the published table with its baseline of wavelets on variational modes |
| `python benches/optimisers.py` | evaluations that our optimiser and others need on test functions |

The last five print and write nothing unless asked; `.venv/bin/python` has what they need after `make bench`.
"""
