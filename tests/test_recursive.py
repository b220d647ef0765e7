"""The recursive filters against reference outputs, pandas, and their closed forms."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import stillrate as sr
from reference import replay
from stillrate import closed_forms

FOLDER = Path(__file__).parent / "reference" / "recursive"
# As the README of the reference outputs states them, per file.
TOLERANCE = {
    "rls1": 1e-13,
    "rls1_missing": 1e-13,
    "kf1": 1e-13,
    "rls2": 1e-10,
    "fir": 1e-12,
    "adaptive": 1e-10,
    "rls_vec_directional": 1e-8,
    "so3": 1e-14,
}


def answers(document: object, found: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Look up in the file what the replay found, by the same paths."""
    values = {}
    for key in found:
        node = document
        for part in key.split("/"):
            node = node[int(part)] if isinstance(node, list) else node[part]
        flat = (
            [[math.nan if x is None else x for x in row] if isinstance(row, list) else row for row in node]
            if isinstance(node, list)
            else node
        )
        values[key] = np.array([math.nan if x is None else x for x in flat] if isinstance(flat, list) else flat, float)
    return values


@pytest.mark.parametrize("name", sorted(TOLERANCE))
def test_replays_the_reference_outputs(name: str) -> None:
    path = FOLDER / f"{name}.json"
    found = replay(path)
    expected = answers(json.loads(path.read_text()), found)
    assert found
    for key, value in found.items():
        np.testing.assert_allclose(value, expected[key], rtol=0, atol=TOLERANCE[name], err_msg=key)


def test_replays_the_reference_bias_with_every_intermediate() -> None:
    path = FOLDER / "ref_bias.json"
    document = json.loads(path.read_text())
    found = replay(path)
    expected = answers(document, found)
    assert {f"iterations/{i}/delta" for i in range(len(document["iterations"]))} <= set(found)
    for key, value in found.items():
        # The README's 1e-13 rad/s is for the bias; matrices have entries of order one and a chain of 200 products.
        np.testing.assert_allclose(value, expected[key], rtol=0, atol=1e-13, err_msg=key)


def test_replays_observability() -> None:
    path = FOLDER / "observability.json"
    found = replay(path)
    expected = answers(json.loads(path.read_text()), found)
    for key, value in found.items():
        right = expected[key]
        np.testing.assert_allclose(value, right, rtol=1e-6, atol=1e-10 * np.abs(right).max(), err_msg=key)


def test_never_reads_the_answers(tmp_path: Path) -> None:
    """With its answers blanked a file replays the same (their shapes stay: they say how much is asked)."""
    document = json.loads((FOLDER / "kf1.json").read_text())
    for case in document["cases"]:
        case["y"] = [0.0] * len(case["y"])
        case["gain"] = [0.0] * len(case["gain"])
    target = tmp_path / "recursive" / "kf1.json"
    target.parent.mkdir()
    target.write_text(json.dumps(document))
    before, after = replay(FOLDER / "kf1.json"), replay(target)
    for key in before:
        np.testing.assert_array_equal(before[key], after[key])


def gappy(seed: int, n: int = 3000) -> np.ndarray:
    random = np.random.default_rng(seed)
    x = np.cumsum(random.normal(size=n)) * 0.1 + random.normal(size=n)
    x[random.random(n) < 0.15] = np.nan
    return x


@pytest.mark.parametrize("lam", [0.9512, 0.5, 0.999, 1e-3])
@pytest.mark.parametrize("gaps", [False, True])
def test_equals_pandas_ewm(lam: float, gaps: bool) -> None:
    x = gappy(1) if gaps else np.nan_to_num(gappy(2))
    config = sr.RecursiveLeastSquares(sample_rate_hz=200.0, noise=None, forgetting_factor=lam)
    trace = sr.Filter(config).run(x, trace=True)
    ours = np.where(trace.flags & int(sr.Flags.NO_DATA_YET), np.nan, trace.rate)
    theirs = pd.Series(x).ewm(alpha=1.0 - lam, adjust=True, ignore_na=False).mean().to_numpy()
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12 * max(1.0, np.nanmax(np.abs(x))))


def test_equals_pandas_ewm_with_times() -> None:
    random = np.random.default_rng(3)
    steps = random.choice([0.005, 0.007, 0.02, 0.5], size=2000)
    times = np.cumsum(steps)
    x = np.cumsum(random.normal(size=2000)) * 0.1
    tau = 0.1
    config = sr.RecursiveLeastSquares(sample_rate_hz=200.0, tau_s=tau)
    ours = sr.Filter(config).run(x, dt_s=steps)
    stamps = pd.to_datetime(np.round(times * 1e9).astype("int64"))
    halflife = pd.Timedelta(tau * math.log(2.0), unit="s")
    theirs = pd.Series(x).ewm(halflife=halflife, times=stamps).mean().to_numpy()
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-8 * max(1.0, np.abs(x).max()))


@pytest.mark.parametrize("lam", [0.0, -0.5, 1.0001, math.nan, math.inf])
def test_forgetting_factors_outside_the_unit_interval_are_refused(lam: float) -> None:
    with pytest.raises(sr.ConfigError, match="forgetting_factor"):
        sr.RecursiveLeastSquares(sample_rate_hz=200.0, forgetting_factor=lam)
    with pytest.raises(sr.ConfigError, match="forgetting_factor"):
        sr.VectorRls(3, forgetting_factor=lam)
    with pytest.raises(sr.ConfigError, match="forgetting_factor"):
        closed_forms.rls_gain(lam, 3)


@pytest.mark.parametrize("order", [-1, 0, 17])
def test_orders_of_vector_least_squares_outside_1_to_16_are_refused(order: int) -> None:
    with pytest.raises(sr.ConfigError, match=f"order = {order} "):
        sr.VectorRls(order)


def test_memory_may_be_said_in_seconds_or_as_a_factor() -> None:
    by_tau = sr.RecursiveLeastSquares(sample_rate_hz=200.0, tau_s=0.1)
    assert by_tau.forgetting_factor == pytest.approx(math.exp(-0.05), abs=1e-15)
    by_factor = sr.RecursiveLeastSquares(sample_rate_hz=200.0, forgetting_factor=math.exp(-0.05))
    assert by_factor.tau_s == pytest.approx(0.1, abs=1e-12)
    with pytest.raises(sr.ConfigError, match="give one of the two"):
        sr.RecursiveLeastSquares(sample_rate_hz=200.0, tau_s=0.2, forgetting_factor=0.5)
    assert sr.config.config_from_settings("hmm-rls", by_tau.settings()) == by_tau


def test_every_method_runs_from_sample_rate_and_noise_alone() -> None:
    noise = sr.GyroNoise(density_dps_sqrt_hz=0.01)
    x = np.random.default_rng(0).normal(size=(500, 2))
    x[100:110] = np.nan
    for cls in (
        sr.RandomWalkKf,
        sr.RecursiveLeastSquares,
        sr.VariableForgetting,
        sr.CusumForgetting,
        sr.FirLowPass,
    ):
        y = sr.Filter(cls(sample_rate_hz=200.0, noise=noise), channels=2).run(x)
        assert y.shape == x.shape and np.isfinite(y).all()


def test_closed_forms_match_the_printed_figures() -> None:
    lam = 0.9512
    assert closed_forms.lag_samples(lam) == pytest.approx(19.49, abs=0.005)
    assert closed_forms.tau_samples(lam) == pytest.approx(19.99, abs=0.005)
    assert math.sqrt(closed_forms.steady_noise(lam)) == pytest.approx(0.15815, abs=5e-6)
    assert closed_forms.half_power_frequency(lam) == pytest.approx(0.0079643, abs=5e-8)
    assert closed_forms.half_power_frequency(0.17) is None
    assert closed_forms.variance_ratio(lam) == pytest.approx(0.0025036165, abs=5e-11)
    assert closed_forms.phase_delay_samples(lam, 1 / 200) == pytest.approx(17.35, abs=0.005)


def test_vector_rls_runs_many_samples_at_once() -> None:
    random = np.random.default_rng(5)
    phi = random.normal(size=(400, 3))
    y = phi @ [1.0, -2.0, 0.5] + 0.01 * random.normal(size=400)
    trace = sr.VectorRls(3, forgetting_factor=0.99).run(phi, y)
    single = sr.VectorRls(3, forgetting_factor=0.99)
    for row, value in zip(phi, y, strict=True):
        single.update(row, value)
    np.testing.assert_array_equal(trace.weights[-1], single.weights)
    np.testing.assert_allclose(trace.weights[-1], [1.0, -2.0, 0.5], atol=0.01)
    with pytest.raises(ValueError, match="phi"):
        single.update([1.0], 0.0)
