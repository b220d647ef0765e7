"""What `stillrate export-c` writes for firmware."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
import stillrate as sr
from stillrate.cli import main


@pytest.fixture
def config(tmp_path: Path) -> Path:
    path = tmp_path / "filter.toml"
    sr.MsImmIkf(sample_rate_hz=1000.0, noise=sr.GyroNoise(density_dps_sqrt_hz=0.01)).to_toml(path)
    return path


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_exported_source_compiles_without_a_warning(config: Path, tmp_path: Path, dtype: str) -> None:
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    out = tmp_path / "firmware"
    assert main(["export-c", str(config), "-o", str(out), "--dtype", dtype]) == 0
    source = tmp_path / "unit.c"
    suffix = dtype.replace("float", "f")
    source.write_text(
        '#include "stillrate_selftest.h"\n'
        f"static stillrate_ms_imm_ikf_{suffix}_state state;\n"
        "int start_up(void) { return stillrate_selftest(&state); }\n"
    )
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-c"]
    subprocess.run([compiler, *flags, f"-I{out}", source, "-o", tmp_path / "unit.o"], check=True)


def test_nothing_is_overwritten_unasked_and_bad_settings_are_refused(config: Path, tmp_path: Path) -> None:
    out = tmp_path / "firmware"
    assert main(["export-c", str(config), "-o", str(out)]) == 0
    before = (out / "stillrate_config.h").read_text()
    assert "static const stillrate_ms_imm_ikf_f32_config STILLRATE_CONFIG" in before
    assert main(["export-c", str(config), "-o", str(out), "--dtype", "float64"]) != 0
    assert (out / "stillrate_config.h").read_text() == before
    assert main(["export-c", str(config), "-o", str(out), "--dtype", "float64", "--force"]) == 0
    bad = tmp_path / "bad.toml"
    bad.write_text('method = "pt1"\nsample_rate_hz = -50.0\n')
    assert main(["export-c", str(bad), "-o", str(tmp_path / "other")]) != 0
    assert not (tmp_path / "other").exists()
