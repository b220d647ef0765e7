"""``stillrate calibrate reference-bias``: a log as the how-to page makes it, good and bad."""

import json

import numpy as np
import pytest
import stillrate as sr
from stillrate.cli import main

RATE_HZ = 100.0
BIAS_DEG_H = np.array([140.0, -90.0, 60.0])


def quaternion(matrix):
    w = np.sqrt(1.0 + np.trace(matrix)) / 2.0
    skew = matrix - matrix.T
    return np.array([w, *(np.array([skew[2, 1], skew[0, 2], skew[1, 0]]) / (4.0 * w))])


def record():
    """Rates in deg/s with bias and noise, and a quaternion every 5 s of a minute."""
    t = np.arange(6000) / RATE_HZ
    rate = np.stack([0.3 * np.sin(0.9 * t), 0.4 * np.sin(1.3 * t + 1.0), 0.5 * np.cos(0.7 * t)], axis=1)
    attitude = np.eye(3)
    fixes = np.full((t.size, 4), np.nan)
    for k, row in enumerate(rate):
        if k % 500 == 0:
            fixes[k] = quaternion(attitude)
        attitude = attitude @ sr.attitude.exp(row / RATE_HZ)
    white = np.random.default_rng(11).normal(0.0, 0.1 / 60.0 * np.sqrt(RATE_HZ), rate.shape)
    return t, np.degrees(rate) + BIAS_DEG_H / 3600.0 + white, fixes


def write(path, *, fixes=None, columns=("qw", "qx", "qy", "qz"), axes=3):
    t, rates, attitude = record()
    attitude = attitude if fixes is None else fixes(attitude)
    log = sr.Log(
        t_s=t,
        rate_dps=rates[:, :axes],
        channels=("gx_dps", "gy_dps", "gz_dps")[:axes],
        sample_rate_hz=RATE_HZ,
        columns={name: attitude[:, k] for k, name in enumerate(columns)},
    )
    sr.write(path, log)
    return str(path)


def run(log, *more):
    return main(["calibrate", "reference-bias", log, "--angle-random-walk", "0.1", *more])


def test_finds_the_bias_of_a_log_and_writes_it_down(tmp_path, capsys):
    log, found = write(tmp_path / "motion.csv"), tmp_path / "bias.json"
    assert run(log, "--ignore-earth", "-o", str(found)) == 0
    said = capsys.readouterr().out
    assert "bias_x" in said and "deg/h" in said and "doubtful" not in said
    result = json.loads(found.read_text())
    error = np.degrees(result["bias_rad_s"]) * 3600.0 - BIAS_DEG_H
    sigma = np.degrees(np.sqrt(np.diag(result["covariance"]))) * 3600.0
    # 0.1 deg/sqrt(h) over 55 s leaves 0.8 deg/h.
    assert np.all(np.abs(sigma - 0.85) < 0.15) and np.all(np.abs(error) < 4.0 * sigma)
    before = found.read_bytes()
    assert run(log, "--ignore-earth", "-o", str(found)) == 2
    assert "--force" in capsys.readouterr().err and found.read_bytes() == before
    assert run(log, "--ignore-earth", "-o", str(found), "--force") == 0


def test_says_that_a_wrong_frame_is_doubtful(tmp_path, capsys):
    # Made in a frame that doesn't turn: the Earth's 15 deg/h is looked for in vain.
    assert run(write(tmp_path / "motion.csv")) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "doubtful" in said and "--ignore-earth" in said


def test_says_that_a_quaternion_in_another_order_is_doubtful(tmp_path, capsys):
    log = write(tmp_path / "motion.csv", columns=("qx", "qy", "qz", "qw"))
    run(log, "--ignore-earth")
    said = capsys.readouterr()
    assert "doubtful" in said.out or "did not settle" in said.err


@pytest.mark.parametrize(
    ("options", "status", "words"),
    [
        ({"columns": ("a", "b", "c", "d")}, 1, "no column qw (the attitude; columns: a, b, c, d)"),
        ({"fixes": lambda q: np.full_like(q, np.nan)}, 1, "0 rows with a finite attitude"),
        ({"fixes": lambda q: np.where(np.arange(len(q))[:, None] < 1, q, np.nan)}, 1, "1 row with a finite attitude"),
        ({"fixes": lambda q: 2.0 * q}, 2, "quaternion length = 2 "),
        ({"axes": 2}, 1, "2 rate columns (three are needed"),
    ],
)
def test_refuses_a_log_without_what_it_needs_in_one_line(tmp_path, capsys, options, status, words):
    assert run(write(tmp_path / "motion.csv", **options), "--ignore-earth") == status
    said = capsys.readouterr()
    assert words in said.err and said.err.count("\n") == 1 and not said.out


@pytest.mark.parametrize(
    "wrong",
    [
        ("--latitude-deg", "91"),
        ("--every-s", "0"),
        ("--every-s", "-1"),
        ("--angle-random-walk", "-0.1"),
        ("--reference-sigma-deg", "-1"),
    ],
)
def test_what_is_wrong_with_an_option_is_said_in_the_units_of_the_option(tmp_path, capsys, wrong):
    assert main(["calibrate", "reference-bias", write(tmp_path / "motion.csv"), *wrong]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"stillrate: {' '.join(wrong)} (must be ") and said.count("\n") == 1


def test_refuses_a_file_that_is_not_there(tmp_path, capsys):
    assert run(str(tmp_path / "none.csv")) == 1
    assert "no such file" in capsys.readouterr().err
