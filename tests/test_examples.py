"""The examples run and do what they say."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
from pathlib import Path
from types import ModuleType

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


def load(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"example_{name}", EXAMPLES / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_drone_log_becomes_a_header_for_its_firmware(tmp_path: Path) -> None:
    tmp_path = tmp_path / "not yet there"
    found = load("drone_to_firmware").main(tmp_path)
    # Error left over raw; found 0.02, 0.47 and 0.16. The sharp starts of the flight let noise through for a while.
    assert found["ground"] < 0.1 and found["flight"] < 0.7 and found["hover"] < 0.3
    assert abs(found["lag_ms"]) < 0.2
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("the headers were written; no C compiler to try them")
    source = '#include "stillrate_selftest.h"\n'
    command = [compiler, "-std=c99", "-Wall", "-Werror", "-Wno-unused-function", "-c", "-x", "c", "-"]
    include = [f"-I{tmp_path / 'firmware'}", "-o", str(tmp_path / "unit.o")]
    subprocess.run([*command, *include], input=source, text=True, check=True)


def test_a_gimbal_loop_is_quiet_when_held_still_and_not_late_when_panned() -> None:
    found = load("camera_gimbal").main()
    # Error left over raw; found 0.03 and 0.32.
    assert found["still"] < 0.1 and found["moving"] < 0.6
    assert abs(found["lag_ms"]) < 1.0
    assert found["coasted"] > 0


def test_a_vessel_keeps_its_motion_and_shows_its_period() -> None:
    found = load("vessel").main()
    # Error left over raw; found 0.39 to 0.50.
    assert max(found[axis] for axis in ("roll", "pitch", "yaw")) < 0.6
    assert abs(found["period_s"] - 4.0) < 0.2
    assert abs(found["lag_ms"]) < 5.0 < 100.0 < found["low_pass_lag_ms"]


def test_a_fleet_goes_on_after_a_broken_log_and_a_second_run_does_nothing(tmp_path: Path) -> None:
    fleet = load("fleet")
    folder = tmp_path / "not yet there"
    first, second = fleet.main(folder), fleet.main(folder)
    assert len(first["done"]) == 5 and first["broken"] == ["unit-5.csv"]
    assert second["done"] == [] and len(second["kept"]) == 5


@pytest.mark.long
def test_a_motion_model_of_ones_own_compiles_and_passes_its_tests(tmp_path: Path) -> None:
    cargo = shutil.which("cargo")
    if cargo is None:
        pytest.skip("no Rust toolchain")
    place = {**os.environ, "CARGO_TARGET_DIR": str(tmp_path / "target")}
    manifest = ["--quiet", "--manifest-path", str(EXAMPLES / "own_model" / "Cargo.toml")]
    subprocess.run([cargo, "test", *manifest], check=True, env=place)
    done = subprocess.run([cargo, "run", *manifest], check=True, env=place, capture_output=True, text=True)
    assert "clean" in done.stdout


def test_every_example_is_listed_with_what_it_shows() -> None:
    text = (EXAMPLES / "README.md").read_text(encoding="utf-8")
    names = [path.name for path in EXAMPLES.glob("*.py")] + ["own_model/"]
    assert len(names) == 5
    for name in names:
        assert f"`{name}`" in text, name
