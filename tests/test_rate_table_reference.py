"""The reference outputs of the rate-table family, through the public interface."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from reference import replay

import stillrate as sr

FOLDER = Path(__file__).parent / "reference" / "rate_table"
# Inputs and settings of the files, and words that are no numbers; everything else is an answer.
QUESTIONS = {
    "seed", "first_u64_hex", "z", "truth", "Q", "R", "start", "a", "b", "params", "x_min", "x_range", "e_min",
    "e_range", "y", "expect", "I", "H", "linear", "layout", "X", "target", "lam", "mu", "decay_mask", "function",
    "uniforms", "draw_order", "phi", "bound", "iters_schedule", "n", "d", "lo", "hi", "w1", "w2", "c1", "c2", "t",
    "invariants",
}  # fmt: skip


def answers(value, path=()):
    """Yield (key, array) of every answer in a file."""
    if path and path[-1] in QUESTIONS:
        return
    if isinstance(value, dict):
        for name, part in value.items():
            yield from answers(part, (*path, name))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for k, part in enumerate(value):
            yield from answers(part, (*path, str(k)))
    else:
        yield "/".join(path), np.asarray(value, dtype=float)


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.json")), ids=lambda path: path.stem)
def test_every_answer_of_the_reference_is_given_within_its_tolerance(path):
    computed = replay(path)
    expected = dict(answers(json.loads(path.read_text())))
    assert expected, path
    assert set(expected) == set(computed)
    for key, value in expected.items():
        step = key.endswith(("lm/step", "lm/objective_after"))
        scale = np.abs(value).max() if step else 1.0
        np.testing.assert_allclose(computed[key], value, rtol=0, atol=(1e-9 if step else 1e-12) * scale, err_msg=key)


def test_the_staircase_is_rejected():
    data = json.loads((FOLDER / "staircase_net.json").read_text())
    net = sr.rate_table.Network(parameters=data["params"])
    model = net.error_model([(data["x_min"][0], data["x_range"][0])], (data["e_min"], data["e_range"]))
    with pytest.raises(sr.LogError, match="rejected"):
        model.check()
    assert model.steepest_slope() > 10 * model.slope_limit
