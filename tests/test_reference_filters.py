"""The reference outputs of the gyro filters, computed elsewhere with 50 digits."""

import json
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from reference import recognising, replay

FOLDER = Path(__file__).parent / "reference" / "filters"
RUNS = sorted(path for path in FOLDER.glob("*.json") if not path.name.startswith("singer_closed_forms"))

# Strong input makes these two ill-conditioned: a relative input change of 1e-15 moves probabilities by 1.3e-10.
ILL_CONDITIONED = {"singer_imm_kf.json": 1e-8, "ms_imm_kf_exact_jacobian.json": 1e-8}


@pytest.mark.parametrize("path", RUNS, ids=lambda path: path.stem)
def test_run_replays_within_tolerance_of_the_channel_maximum(path):
    expected = json.loads(path.read_text())["outputs"]
    found = replay(path)
    assert set(found) == set(expected)
    tolerance = ILL_CONDITIONED.get(path.name, 1e-12)
    for name, values in expected.items():
        answer = np.array(values, dtype=float)
        worst = np.nanmax(np.abs(found[name] - answer))
        assert found[name].shape == answer.shape
        assert worst <= tolerance * np.nanmax(np.abs(answer)), name


def test_a_reference_file_is_known_by_what_stands_in_it_too():
    files = list(FOLDER.parent.glob("*/*.json"))
    assert len(files) > 25
    for path in files:
        assert recognising(json.loads(path.read_text())) == [path.parent.name], path


def test_closed_forms_agree_to_five_units_in_1e16():
    path = FOLDER / "singer_closed_forms_40digits.json"
    found = replay(path)
    for index, row in enumerate(json.loads(path.read_text())):
        for name in ("r", "s", "q11", "q12", "q22"):
            error = Fraction(float(found[f"{index}/{name}"])) / Fraction(row[name]) - 1
            assert abs(error) <= 5e-16, (row["aT"], name)
