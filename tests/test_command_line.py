"""The command line: exit codes, what it writes, what it never overwrites."""

from __future__ import annotations

import inspect
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import stillrate as sr
from stillrate import demo
from stillrate.cli import CALIBRATIONS, COMMANDS, main
from stillrate.io.safely import atomic

ROOT = Path(__file__).parents[1]


@pytest.fixture
def log(tmp_path):
    path = tmp_path / "log.csv"
    assert main(["simulate", "waves", "-o", str(path), "--rate", "100", "--duration", "20", "--channels", "2"]) == 0
    return path


def test_filter_keeps_rows_columns_and_everything_else(log, tmp_path, capsys):
    out = tmp_path / "clean.csv"
    assert main(["filter", str(log), "-o", str(out)]) == 0
    before, after = sr.read(log), sr.read(out)
    assert after.layout.order == before.layout.order and len(after) == len(before)
    np.testing.assert_array_equal(after.columns["gx_true_dps"], before.columns["gx_true_dps"])
    truth = before.columns["gx_true_dps"]
    assert sr.metrics.rmse(after.rate_dps[:, 0], truth) < 0.9 * sr.metrics.rmse(before.rate_dps[:, 0], truth)
    assert "ms-imm-ikf" in after.meta["stillrate"]["configuration"]["gx_dps"]
    assert "gx_dps" in capsys.readouterr().err


@pytest.mark.parametrize("suffix", [".csv", ".npz", ".parquet"])
def test_every_format_gives_the_same_result(log, tmp_path, suffix):
    if suffix == ".parquet":
        pytest.importorskip("polars")
    sr.write(tmp_path / f"copy{suffix}", sr.read(log))
    assert main(["filter", str(tmp_path / f"copy{suffix}"), "-o", str(tmp_path / "a.npz"), "--quiet"]) == 0
    assert main(["filter", str(log), "-o", str(tmp_path / "b.npz"), "--quiet"]) == 0
    np.testing.assert_array_equal(sr.read(tmp_path / "a.npz").rate_dps, sr.read(tmp_path / "b.npz").rate_dps)


def test_chunks_do_not_show(log, monkeypatch):
    from stillrate import cleaning

    read = sr.read(log)
    configs, _ = cleaning.settings_for(read, method="pt1")
    whole = sr.Filter(configs["gx_dps"]).run(np.ascontiguousarray(read.rate_dps[:, 0]))
    done = cleaning.clean(read, configs)
    np.testing.assert_array_equal(done.clean.rate_dps[:, 0], whole)
    monkeypatch.setattr(cleaning, "CHUNK_ROWS", 77)
    np.testing.assert_array_equal(cleaning.clean(read, configs, views=True).clean.rate_dps, done.clean.rate_dps)


def test_raw_columns_are_kept_on_request(log, tmp_path):
    assert main(["filter", str(log), "-o", str(tmp_path / "c.csv"), "--keep-raw", "--method", "pt1", "--quiet"]) == 0
    order = (tmp_path / "c.csv").read_text().splitlines()[0].split(",")
    assert order[order.index("gx_dps") + 1] == "gx_dps_raw"
    again = sr.read(tmp_path / "c.csv")
    assert again.channels == ("gx_dps", "gy_dps")
    np.testing.assert_array_equal(again.columns["gx_dps_raw"], sr.read(log).rate_dps[:, 0])


def test_settings_from_a_file_are_used(log, tmp_path):
    noise = sr.GyroNoise(density_dps_sqrt_hz=0.02)
    sr.MsImmIkf(sample_rate_hz=100.0, noise=noise).to_toml(tmp_path / "f.toml")
    command = ["filter", str(log), "-o", str(tmp_path / "c.npz"), "--config", str(tmp_path / "f.toml"), "--quiet"]
    assert main(command) == 0
    assert "density_dps_sqrt_hz = 0.02" in sr.read(tmp_path / "c.npz").meta["stillrate"]["configuration"]["gx_dps"]


def test_nothing_is_overwritten_unasked(log, tmp_path, capsys):
    out = tmp_path / "c.csv"
    out.write_text("precious")
    assert main(["filter", str(log), "-o", str(out), "--quiet"]) == 2
    assert out.read_text() == "precious" and "--force" in capsys.readouterr().err
    assert main(["filter", str(log), "-o", str(out), "--quiet", "--force"]) == 0
    assert main(["filter", str(log), "-o", str(log), "--quiet", "--force"]) == 2
    assert not list(tmp_path.glob(".*"))


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["filter"], 2),
        (["filtr"], 2),
        (["filter", "LOG", "-o", "x.csv", "--methd", "pt1"], 2),
        (["filter", "LOG", "-o", "x.csv", "--method", "pt2"], 2),
        (["filter", "LOG", "-o", "x.docx"], 2),
        (["filter", "LOG", "-o", "nowhere/x.csv"], 2),
        (["filter", "LOG", "-o", "x.csv", "--rate", "-3"], 2),
        (["filter", "LOG", "-o", "x.csv", "--unit", "rpm"], 2),
        (["filter", "LOG", "-o", "x.csv", "--time-unit", "h"], 2),
        (["filter", "LOG", "-o", "x.csv", "--columns", "gq_dps"], 1),
        (["filter", "absent.csv", "-o", "x.csv"], 1),
        (["filter", ".", "-o", "x.csv"], 1),
        (["simulate", "storm", "-o", "x.csv"], 2),
        (["simulate", "waves", "-o", "x.csv", "--rate", "0"], 2),
        (["simulate", "waves", "-o", "x.csv", "--rate", "1e-9"], 2),
        (["simulate", "waves", "-o", "x.csv", "--seed", "-1"], 2),
        (["simulate", "waves", "-o", "x.csv", "--seed", str(2**64)], 2),
        (["demo", "-o", "x", "--seed", str(2**70)], 2),
        (["demo", "-o", "LOG"], 2),
        (["fleet", "LOG", "-o", "LOG"], 2),
        (["export-c", "x.toml", "-o", "LOG"], 2),
        (["filter", "LOG", "-o", "x.csv", "--columns", "gx_dps,gx_dps"], 1),
    ],
)
def test_wrong_calls_say_so_in_one_line(log, tmp_path, monkeypatch, capsys, arguments, code):
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    assert main([str(log) if word == "LOG" else word for word in arguments]) == code
    said = capsys.readouterr().err
    assert said.startswith("stillrate: ") and said.count("\n") == 1 and "Traceback" not in said
    assert sorted(tmp_path.iterdir()) == before


def test_what_a_log_lacks_is_said_with_its_name(tmp_path, capsys):
    path = tmp_path / "short.csv"
    path.write_text("t_s,gx_dps,gx_dps_raw\n" + "".join(f"{k / 50},{k % 2},0\n" for k in range(5)))
    for words in (["filter", "-o", str(tmp_path / "x.csv")], ["allan"], ["compare"]):
        assert main([words[0], str(path), *words[1:]]) == 1
        assert capsys.readouterr().err.startswith(f"stillrate: {path}: the record holds 5 usable samples")


def test_a_file_that_cannot_be_written_is_named(tmp_path):
    for error in (OSError(28, "No space left on device"), PermissionError("from another library")):
        with pytest.raises(type(error)) as caught, atomic(tmp_path / "x.csv", force=False):
            raise error
        assert caught.value.filename == str(tmp_path / "x.csv") and not list(tmp_path.iterdir())


def test_an_axis_that_never_changes_passes_and_is_remarked(tmp_path, capsys):
    rows = np.random.default_rng(5).normal(0.0, 0.1, 500)
    path = tmp_path / "dead.csv"
    path.write_text("t_s,gx_dps,gy_dps\n" + "".join(f"{k / 50},{x:.6f},0.0\n" for k, x in enumerate(rows)))
    assert main(["filter", str(path), "-o", str(tmp_path / "clean.csv")]) == 0
    assert "gy_dps: all samples are equal" in capsys.readouterr().err
    np.testing.assert_array_equal(sr.read(tmp_path / "clean.csv").rate_dps[:, 1], 0.0)
    assert not sr.denoise(np.zeros(100), sample_rate_hz=50.0).any()


DAMAGE = {
    "empty": lambda data: b"",
    "one byte": lambda data: data[:1],
    "half": lambda data: data[: len(data) // 2 - 3],
    "zeros": lambda data: b"\0" * len(data),
    "no end": lambda data: data[:-40],
    "noise": lambda data: np.random.default_rng(1).bytes(len(data)),
    "middle gone": lambda data: data[:300] + b"\0" * 500 + data[800:],
}


# A table cut between two digits is a shorter table.
@pytest.mark.parametrize(
    ("suffix", "damage"),
    [(".csv", damage) for damage in DAMAGE if damage not in ("half", "no end")]
    + [(suffix, damage) for suffix in (".npz", ".parquet") for damage in DAMAGE],
)
def test_damaged_files_exit_with_one_line_and_leave_nothing(log, tmp_path, capsys, suffix, damage):
    if suffix == ".parquet":
        pytest.importorskip("polars")
    good = tmp_path / f"good{suffix}"
    sr.write(good, sr.read(log))
    bad = tmp_path / f"bad{suffix}"
    bad.write_bytes(DAMAGE[damage](good.read_bytes()))
    out = tmp_path / "out.npz"
    capsys.readouterr()
    assert main(["filter", str(bad), "-o", str(out)]) == 1
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and bad.name in said
    assert not out.exists()


def test_help_does_not_import_the_numerics_of_commands():
    code = "import sys; from stillrate.cli import build; build(); print([m for m in sys.modules if 'cli.filter' in m])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("words", [[name] for name in COMMANDS] + [["calibrate", name] for name in CALIBRATIONS])
def test_help_is_what_the_command_says_of_itself(words, capsys):
    from importlib import import_module

    assert main([*words, "--help"]) == 0
    said = " ".join(re.sub("[│╭╮╰╯─]", " ", capsys.readouterr().out).split())
    first = inspect.getdoc(import_module(f"stillrate.cli.{'_'.join(words).replace('-', '_')}").command).splitlines()[0]
    assert first in said and "[default: False]" not in said


def test_the_package_itself_imports_nothing_beyond_numpy():
    code = "import sys, stillrate; print(sorted({'cyclopts', 'rich', 'polars', 'matplotlib'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_readme_shows_what_the_demonstration_measures():
    rows = demo.score(demo.runs())
    text = (ROOT / "README.md").read_text()
    found = re.search(r"<!-- demo-table -->\n(.*?)<!-- /demo-table -->", text, re.S)
    assert found is not None and found[1] == demo.markdown(rows)
    default = next(row for row in rows if "default" in row.name)
    bound = rows[-1]
    for row in rows[:-2]:
        assert row.static_dps > default.static_dps and row.waves_dps > default.waves_dps
    assert bound.static_dps < default.static_dps and bound.waves_dps < default.waves_dps


def test_demo_writes_page_log_and_table(tmp_path, capsys):
    assert main(["demo", "-o", str(tmp_path / "d")]) == 0
    said = capsys.readouterr().out
    assert "MS-IMM-IKF" in said and "report.html" in said
    page = (tmp_path / "d/report.html").read_text()
    assert len(page) < 500_000
    data = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)
    assert data is not None
    found = json.loads(data[1])["channels"][0]
    assert found["spectrum"] and found["allan"] and len(found["view"]["models"]) > 5
    assert not re.search(r"(src|href)=.?https?:", page)


def test_tune_writes_settings_that_filter_takes(log, tmp_path):
    rest = tmp_path / "rest.npz"
    assert main(["simulate", "static", "-o", str(rest), "--rate", "100", "--channels", "2"]) == 0
    assert main(["tune", str(rest), "-o", str(tmp_path / "f.toml")]) == 0
    config = sr.load_config(tmp_path / "f.toml")
    assert config.noise is not None and config.noise.density_dps_sqrt_hz == pytest.approx(0.0151, rel=0.05)
    assert (
        main(["filter", str(log), "--config", str(tmp_path / "f.toml"), "-o", str(tmp_path / "c.csv"), "--quiet"]) == 0
    )
    assert main(["tune", str(rest), "-o", str(tmp_path / "g.toml"), "--rest", "9:1"]) == 2


def test_allan_and_compare_show_their_tables(log, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    rest = tmp_path / "rest.npz"
    assert main(["simulate", "static", "-o", str(rest), "--rate", "50"]) == 0
    assert main(["allan", str(rest), "--json", str(tmp_path / "a.json"), "--picture", str(tmp_path / "a.png")]) == 0
    figures = json.loads((tmp_path / "a.json").read_text())["channels"]["gx_dps"]["angle_random_walk"]
    assert figures["lower"] < 0.0151 < figures["upper"]
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    asked = ["compare", str(rest), "--method", "pt1", "--method", "ms-imm-ikf", "--report", str(tmp_path / "c.html")]
    assert main(asked) == 0
    assert "ms-imm-ikf" in capsys.readouterr().out
    page = (tmp_path / "c.html").read_text(encoding="utf-8")
    assert "2 methods on rest.npz" in page and len(page) < 200_000
    assert main(asked) == 2 and "exists" in capsys.readouterr().err
    assert main([*asked, "--force"]) == 0
