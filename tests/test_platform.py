"""The servo platform: reference outputs, drift figures, refusals, and that a filter changes what it should."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import stillrate as sr
from reference import replay
from stillrate import platform as pf

HERE = Path(__file__).parent / "reference" / "servo"


def numbers(node: Any, path: str = "") -> dict[str, np.ndarray]:
    """Flatten every number or list of numbers of a file."""
    if isinstance(node, dict):
        return {k: v for name, item in node.items() for k, v in numbers(item, f"{path}/{name}").items()}
    if isinstance(node, list) and node and isinstance(node[0], dict):
        return {k: v for i, item in enumerate(node) for k, v in numbers(item, f"{path}/{i}").items()}
    try:
        return {path.lstrip("/"): np.asarray(node, dtype=float)}
    except (TypeError, ValueError):
        return {}


def test_drift_variances_follow_their_reference() -> None:
    theirs = numbers(json.loads((HERE / "variance.json").read_text()))
    ours = replay(HERE / "variance.json")
    assert sum(key.startswith("cases/") for key in ours) >= 60
    for key, value in ours.items():
        loose = key.endswith(("I_lyap", "var_T2"))
        # README: 1e-11 relative, 1e-9 where the reference itself came from scipy's Lyapunov solver.
        np.testing.assert_allclose(value, theirs[key], rtol=1e-9 if loose else 1e-11, err_msg=key)


def test_the_platform_follows_its_reference() -> None:
    document = json.loads((HERE / "plant.json").read_text())["cases"]
    ours = replay(HERE / "plant.json")
    for name, case in document.items():
        answer = "states" if name.startswith("open_loop") else "rec"
        theirs = np.array(case[answer])
        # README: relative to the column's largest magnitude (here over the instants handed out, which is stricter).
        scale = np.maximum(np.abs(theirs).max(axis=0), 1e-300)
        off = np.max(np.abs(ours[f"cases/{name}/{answer}"] - theirs) / scale)
        assert off <= case["rel_tol"], f"{name}: {off:.2e} of {case['rel_tol']:.2e}"


def test_the_paper_gyro_drifts_as_specified() -> None:
    gyro = pf.LoopNoise.from_std_at_rate(0.1074, 50.0)
    loop = ([20.0], [1.0, 20.0])
    corner = 2.0 * math.pi * 0.75
    slow = ([corner], [1.0, corner])
    assert pf.drift(gyro, rate_loop=loop, time_s=60.0).rms_deg == pytest.approx(0.11757, abs=1e-5)
    # A filter of unit gain at DC hardly reduces the drift, and inside a tracked loop its lag makes it worse.
    assert pf.drift(gyro, rate_loop=loop, filter=slow, time_s=60.0).rms_deg == pytest.approx(0.11728, abs=1e-5)
    tracked = {"rate_loop": loop, "tracking": 2.0, "filter": slow, "filter_position": "forward-path"}
    assert pf.drift(gyro, **tracked).rms_deg == pytest.approx(0.01001, abs=1e-5)
    assert pf.drift(gyro, rate_loop=loop, tracking=2.0).bias_gain_s == -0.5


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"rate_loop": ([20.0], [1.0, 20.0])}, "give time_s"),
        ({"rate_loop": ([225.0], [1.0, 18.0, 225.0]), "tracking": 19.0}, "Routh row"),
        ({"rate_loop": ([1.0, 0.0, 0.0], [1.0, 1.0]), "time_s": 1.0}, "infinite variance"),
        ({"time_s": -1.0}, "time_s = -1"),
        ({"rate_loop": ([1.0], [0.0])}, "denominator"),
        ({"tracking": 2.0, "dead_time_s": 0.1}, "dead time"),
    ],
)
def test_a_variance_that_does_not_exist_says_why(arguments: dict[str, Any], text: str) -> None:
    with pytest.raises(sr.ConfigError, match=text):
        pf.drift(pf.LoopNoise(density_dps_sqrt_hz=0.015), **arguments)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"plant": pf.Plant.platform_30kg().replace(inertia_kg_m2=0.0)}, "inertia_kg_m2 = 0"),
        ({"plant": pf.Plant.platform_30kg().replace(stiction_n_m=1.0)}, "stiction_n_m = 1"),
        ({"plant": pf.Plant.platform_30kg().replace(curves="smooth")}, "curves = smooth"),
        ({"dt_s": 4e-3}, "dt_s = 0.004"),
        ({"dt_s": 1.5e-3}, "dt_s"),
        ({"delay_s": -1e-3}, "delay_s"),
        ({"delay_s": 5.0}, "delay_s"),
        ({"sample_rate_hz": float("nan")}, "sample_rate_hz"),
    ],
)
def test_bad_parameters_are_refused_by_name(change: dict[str, Any], text: str) -> None:
    with pytest.raises(sr.ConfigError, match=text):
        pf.run(pf.Constant(), setup=pf.Setup().replace(**change))


def test_design_figures_are_refused_by_name() -> None:
    for name in ("mass_kg", "arm_m", "lead_m", "voltage_max_v", "current_max_a", "motor_inertia_kg_m2"):
        with pytest.raises(sr.ConfigError, match=f"{name} = 0"):
            pf.Plant.from_design(pf.PlatformDesign(**{name: 0.0}))


def test_an_unreachable_base_and_an_unstable_loop_are_reported_with_their_number() -> None:
    short = pf.Setup(plant=pf.Plant.from_design(pf.PlatformDesign(lead_m=0.01)))
    found = pf.run(pf.Sine(), setup=short, duration_s=1.0).warnings
    assert any("needs 62.8 deg/s" in text and "has 34.4 deg/s" in text for text in found)
    wild = pf.Controller(kappa=0.4, ko_per_s=0.5, kvi_per_s=20.0, kd_s=2e-3)
    assert any("1.0149" in text for text in pf.run(pf.Sine(), controller=wild, duration_s=1.0).warnings)
    assert not pf.run(pf.Sine(), controller=wild, filter=pf.LoopPt1(cutoff_hz=5.3), duration_s=1.0).warnings
    assert any("30.0 deg" in text for text in pf.run(pf.Tilt(amplitude_deg=30.0), duration_s=1.0).warnings)


def test_a_filter_of_the_library_runs_in_the_loop() -> None:
    noise = pf.Setup().noise
    bank = sr.MsImmIkf(sample_rate_hz=50.0, noise=noise)
    still = pf.run(pf.Constant(), filter=[bank, sr.Pt1(sample_rate_hz=50.0, cutoff_hz=3.6)], duration_s=10.0, seed=3)
    raw = pf.run(pf.Constant(), duration_s=10.0, seed=3)
    late = slice(200, None)
    assert np.std(still.column("w")[late]) < 0.2 * np.std(raw.column("w")[late])
    # The filter in the loop is the library's: the same samples give the same bits outside it.
    alone = sr.Filter(bank).run(np.degrees(raw.column("y")))
    inside = pf.run(pf.Constant(), filter=bank, gyro=pf.GyroErrors(white_sigma_dps=0.1, seed=1), duration_s=2.0)
    again = sr.Filter(bank).run(np.degrees(inside.column("y")))
    np.testing.assert_allclose(np.degrees(inside.column("w")), again, rtol=1e-12, atol=1e-15)
    assert np.isfinite(alone).all()
    with pytest.raises(sr.ConfigError, match="sample_rate_hz = 100"):
        pf.run(pf.Constant(), filter=sr.Pt1(sample_rate_hz=100.0, cutoff_hz=5.0))


def test_a_recorded_motion_drives_the_base() -> None:
    t = np.arange(400) / 100.0
    rate = 20.0 * np.sin(2.0 * np.pi * 0.5 * t) + 3.0
    rate[100] = np.nan
    found = pf.run(pf.Recorded(rate_dps=rate, sample_rate_hz=100.0), duration_s=3.9)
    assert np.abs(found.base_deg).max() == pytest.approx(20.0 / np.pi, rel=0.05)
    assert np.abs(found.angle_deg).max() < 3.0


def test_the_camera_gimbal_holds_its_camera() -> None:
    gimbal = pf.Setup.camera_gimbal()
    gains = pf.Controller(kappa=2.0, ko_per_s=2.0, kvi_per_s=60.0, kd_s=0.0)
    found = pf.run(pf.Sine(amplitude_deg=10.0), setup=gimbal, controller=gains)
    assert found.lost_at is None and not found.warnings
    assert found.residual_deg[1] < 0.8


def test_a_small_search_stays_within_its_budget() -> None:
    pt1 = pf.families()["pt1"]
    seen: list[int] = []
    effort = {"evaluations": 60, "restarts": 1, "seeds": (1, 2), "check_seeds": (5, 6)}
    found = pf.tune(pt1, 0.2, progress=seen.append, **effort)  # type: ignore[arg-type]
    assert seen[-1] == 60 and found.feasible and found.tried >= 1
    assert found == pf.tune(pt1, 0.2, **effort)  # type: ignore[arg-type]
    # A search that begins with an earlier design cannot end behind it.
    warm = pf.tune(pt1, 0.2, starts=[(found.controller, found.parameters)], **{**effort, "evaluations": 4})  # type: ignore[arg-type]
    assert warm.feasible and warm.objective_deg <= found.objective_deg * (1.0 + 1e-9)
    with pytest.raises(sr.ConfigError, match="evaluations = 3"):
        pf.tune(pt1, 0.2, **{**effort, "evaluations": 3})  # type: ignore[arg-type]
    with pytest.raises(sr.ConfigError, match="starts"):
        pf.tune(pt1, 0.2, starts=[(found.controller, ())], **effort)  # type: ignore[arg-type]
    # Same numbers again: the search does not depend on threads.
    row = pf.validate(pt1, found.controller, found.parameters, seeds=(3, 4), margin_seeds=1)
    assert row.max_deg[0] > row.rms_deg[0] > 0.0 and row.gain_margin >= 1.5


def test_a_search_can_be_stopped() -> None:
    def stop(done: int) -> bool:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        pf.tune(pf.families()["none"], 0.2, evaluations=400, seeds=(1,), progress=stop)


def test_a_describing_function_tells_amplitudes_apart() -> None:
    flat = pf.describe(pf.LoopPt1(cutoff_hz=5.3), amplitudes_dps=(2.0, 60.0))
    assert flat[0] == pytest.approx(flat[1], rel=0.02)
    quiet, loud = pf.describe(sr.MsImmIkf(sample_rate_hz=50.0, noise=pf.Setup().noise), amplitudes_dps=(0.05, 60.0))
    assert quiet[0] < 0.3 and loud[0] == pytest.approx(1.0, abs=0.02)


def test_the_page_shows_the_platform_and_stands_alone(tmp_path: Path) -> None:
    from stillrate.platform.page import write
    from stillrate.platform.study import Design, Study, measure, show

    setup = pf.Setup()
    designs = [Design("none", 0.05, pf.Controller()), Design("pt1", 0.05, pf.Controller(), (5.3,))]
    runs = tuple((d.family, show(d, pf.Sine(), setup=setup, duration_s=4.0)) for d in designs)
    results = tuple(measure(d, setup=setup, seeds=(1, 2)) for d in designs)
    study = Study(setup=setup, results=results, fixed=(("none", results[0].row), ("pt1", results[1].row)), runs=runs)
    path = tmp_path / "page.html"
    write(study, path)
    text = path.read_text()
    assert "type='range'" in text and text.count("<polyline") >= 4 and text.count("<circle") >= 4
    assert "http" not in text.replace("http-equiv", "")
    for result in results:
        assert f"{result.row.max_deg[0]:.2f}" in text
    with pytest.raises(FileExistsError):
        write(study, path)


def test_the_command_line_refuses_wrong_usage(capsys: pytest.CaptureFixture[str]) -> None:
    from stillrate.cli import main

    for arguments, text in (
        (["--effort", "heroic"], "--effort heroic"),
        (["--seeds", "1"], "--seeds 1"),
        (["--filters", "nonesuch"], "--filters nonesuch"),
        (["--rate", "123", "--tune"], "dt_s"),
        (["--rate", "125"], "--tune"),
    ):
        assert main(["platform", *arguments]) == 2, arguments
        assert text in capsys.readouterr().err


def test_every_shipped_design_is_quiet_again_after_a_tilt_and_levels() -> None:
    from stillrate.platform.shipped import SHIPPED
    from stillrate.platform.study import setup_of

    assert SHIPPED
    for design in SHIPPED:
        setup = setup_of(design)
        family = pf.families(setup)[design.family]
        # Seeds of this test's own; rest jitter is heavy-tailed for a filter that opens by itself, so many of them.
        row = pf.validate(
            family, design.controller, design.parameters, setup=setup, seeds=range(31, 47), margin_seeds=0
        )
        name = f"{design.family} at {design.budget_percent} %"
        assert row.jitter_percent < 2.0 * row.undisturbed_percent, name
        if family.linear:
            assert row.jitter_seeds[2] < 2.0 * row.undisturbed_percent, name
        # Most of it is the gyro's: bias over 25 s and angle random walk, which scatters by 0.08 deg from seed to seed.
        assert row.levelling_deg[0] <= 0.2, name
        assert row.levelling_own_deg[0] <= 0.05, name


def test_a_better_design_of_a_smaller_budget_stands_for_a_larger_one() -> None:
    from stillrate.platform.study import Design, carried_over

    def design(budget: float, objective: float, feasible: bool = True) -> Design:
        return Design("pt1", budget, pf.Controller(), (5.0,), feasible=feasible, objective_deg=objective)

    large, small = design(0.05, 3.0), design(0.02, 2.0)
    assert [d.objective_deg for d in carried_over([large, small])] == [2.0, 2.0]
    assert [d.budget_percent for d in carried_over([large, small])] == [0.05, 0.02]
    assert carried_over([large, design(0.02, 4.0)])[0] == large
    assert carried_over([large, design(0.02, 1.0, feasible=False)])[0] == large


def test_with_the_controller_fixed_the_bank_changes_the_jitter_and_not_the_residual() -> None:
    from stillrate.platform.study import fixed_test

    found = dict(fixed_test(pf.Setup(), seeds=range(41, 47)))
    raw, bank = found["none"], found["ms-imm-ikf"]
    assert bank.rms_deg[0] == pytest.approx(raw.rms_deg[0], rel=0.02)
    assert bank.max_deg[0] == pytest.approx(raw.max_deg[0], rel=0.02)
    assert raw.jitter_percent >= 8.0 * bank.jitter_percent
