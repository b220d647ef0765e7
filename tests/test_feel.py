"""How the package feels in the hand: pickles, containers, names, words of errors, completion, types."""

from __future__ import annotations

import ast
import importlib
import importlib.util
import inspect
import math
import pickle
import pickletools
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import stillrate as sr
from every_method import METHODS, NOISE, build
from stillrate import _native
from stillrate.cli import COMMANDS, main
from stillrate.cli import build as build_command_line

HERE = Path(__file__).parent
PT1 = sr.Pt1(sample_rate_hz=50.0)


def called_by(blob):
    """Return every name that unpickling would import."""
    words, found = [], set()
    for code, argument, _ in pickletools.genops(blob):
        if "UNICODE" in code.name:
            words.append(argument)
        elif code.name == "STACK_GLOBAL":
            found.add(".".join(words[-2:]))
        elif code.name == "GLOBAL":
            found.add(argument.replace(" ", "."))
    return found


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_unpickling_calls_nothing_but_the_documented_restore(protocol):
    # Protocol 2 writes bytes as an encoded text.
    spelling = {"_codecs.encode"} if protocol == 2 else set()
    flt = sr.Filter(build("ms-imm-ikf"))
    flt.update(0.3)
    assert called_by(pickle.dumps(flt, protocol)) - spelling == {"stillrate.saving.restore"}
    assert called_by(pickle.dumps(flt.config, protocol)) == {"stillrate.config.config_from_settings"}


def test_a_tampered_pickle_of_settings_is_checked_like_any_other():
    blob = pickle.dumps(PT1, 0).replace(b"F50.0", b"F-5.0")
    with pytest.raises(sr.ConfigError, match="sample_rate_hz = -5"):
        pickle.loads(blob)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("method", METHODS)
def test_a_restored_filter_has_the_estimate_and_continues_with_the_same_bits(method, dtype):
    random = np.random.default_rng(11)
    z = random.normal(0.0, 0.3, (400, 3))
    z[180:220, 1] = np.nan
    z[199, 2] = np.nan
    flt = sr.Filter(build(method), channels=3, dtype=dtype)
    for advance in (lambda: flt.run(z[:200]), lambda: flt.update(*z[200]), lambda: flt.run(z[201:250], trace=True)):
        advance()
        twin, again = sr.Filter.restore(flt.save()), pickle.loads(pickle.dumps(flt))
        assert repr(twin.estimate) == repr(again.estimate) == repr(flt.estimate)
        assert twin.save() == flt.save()
    np.testing.assert_array_equal(twin.run(z[250:]), flt.run(z[250:]))


def test_a_state_saved_without_its_estimate_still_continues():
    # Written before the last estimate was saved: PT1 at 50 Hz, 12.5 Hz cut-off, no sample yet.
    blob = (
        b"STILLRAT\x01\x00\x08\x03pt1\x02\x00\tcutoff_hz\x00\x00\x00\x00\x00\x00\x00)@\x0esample_rate_hz\x00\x00\x00"
        b"\x00\x00\x00\x00I@\x01\x00\x00\x00\x02\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00"
        b"\x00\x00\x00\x00\xf0\x99\xfbq"
    )
    flt = sr.Filter.restore(blob)
    assert len(flt.save()) > len(blob)
    fresh = sr.Filter(PT1)
    assert repr(flt.estimate) == repr(fresh.estimate)
    np.testing.assert_array_equal(flt.run([1.0, 2.0, 3.0]), fresh.run([1.0, 2.0, 3.0]))


def test_masked_samples_are_missing_and_the_result_is_whole():
    masked = np.ma.masked_array(np.arange(12, dtype=np.float32).reshape(6, 2), mask=np.eye(6, 2, dtype=bool))
    plain = masked.filled(np.nan)
    flt = sr.Filter(PT1, channels=2, dtype="float32")
    result = flt.run(masked)
    assert type(result) is np.ndarray and result.dtype == np.float32 and np.isfinite(result).all()
    np.testing.assert_array_equal(result, sr.Filter(PT1, channels=2, dtype="float32").run(plain))


@pytest.mark.parametrize("kind", ["float64", "Float64", "object", "Int64"])
def test_a_pandas_series_keeps_index_and_name_and_na_is_missing(kind):
    pandas = pytest.importorskip("pandas")
    index = pandas.date_range("2026-01-01", periods=5, freq="20ms")
    values = [1, None, 3, 4, 5] if kind != "float64" else [1.0, math.nan, 3.0, 4.0, 5.0]
    given = pandas.Series(values, index=index, name="gz", dtype=kind)
    result = sr.Filter(PT1).run(given)
    assert isinstance(result, pandas.Series) and result.name == "gz" and result.index.equals(index)
    np.testing.assert_array_equal(result, sr.Filter(PT1).run([1.0, math.nan, 3.0, 4.0, 5.0]))
    clean = sr.denoise(given, sample_rate_hz=50.0, method="pt1", noise=NOISE)
    assert isinstance(clean, pandas.Series) and clean.index.equals(index)


def test_a_pandas_frame_keeps_index_and_columns():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"gx": [1.0, 2.0, None], "gy": [4, 5, 6]}, index=[10, 20, 30])
    result = sr.Filter(PT1, channels=2).run(frame)
    assert list(result.columns) == ["gx", "gy"] and list(result.index) == [10, 20, 30]
    np.testing.assert_array_equal(result, sr.Filter(PT1, channels=2).run(frame.to_numpy()))
    times = pandas.Series([0.02, 0.02, 0.05])
    np.testing.assert_array_equal(
        sr.Filter(PT1, channels=2).run(frame, dt_s=times),
        sr.Filter(PT1, channels=2).run(frame.to_numpy(), dt_s=times.to_numpy()),
    )
    with pytest.raises(TypeError, match="real numbers"):
        sr.Filter(PT1).run(pandas.Series(pandas.date_range("2026-01-01", periods=3)))


def test_polars_series_and_frames_stay_polars():
    polars = pytest.importorskip("polars")
    result = sr.Filter(PT1).run(polars.Series("gz", [1.0, None, 3.0]))
    assert isinstance(result, polars.Series) and result.name == "gz" and result.null_count() == 0
    np.testing.assert_array_equal(result.to_numpy(), sr.Filter(PT1).run([1.0, math.nan, 3.0]))
    frame = polars.DataFrame({"gx": [1, 2, None], "gy": [4.0, 5.0, 6.0]})
    clean = sr.Filter(PT1, channels=2).run(frame)
    assert isinstance(clean, polars.DataFrame) and clean.columns == ["gx", "gy"]
    mapped = polars.DataFrame({"gz": [1.0, None, 3.0]}).select(
        polars.col("gz").map_batches(sr.Filter(PT1).run, return_dtype=polars.Float64)
    )
    np.testing.assert_array_equal(mapped["gz"].to_numpy(), result.to_numpy())


@pytest.mark.parametrize("missing", [None, math.nan, np.ma.masked])
def test_one_missing_sample_is_coasted_over_whatever_it_is_called(missing, recwarn):
    flt = sr.Filter(PT1)
    flt.update(1.0)
    assert flt.update(missing) == 1.0 and sr.Flags.MISSING in flt.estimate.flags
    two = sr.Filter(PT1, channels=2)
    assert two.update(1.0, missing)[0] == two.update([1.0, missing])[0] == 1.0
    assert not recwarn.list


def test_what_is_no_number_is_refused():
    pandas = pytest.importorskip("pandas")
    flt = sr.Filter(PT1)
    assert flt.update(pandas.NA) == 0.0
    assert flt.update(np.float32(0.5)) == flt.update(np.int64(0) + 0.5) == 0.5
    with pytest.raises(TypeError, match="not str"):
        flt.update("1.0")
    with pytest.raises((TypeError, ValueError)):
        sr.Filter(PT1, channels=2).update(1.0)


def test_representations_tell_what_it_is():
    assert repr(PT1) == "Pt1(sample_rate_hz=50.0, noise=None, cutoff_hz=12.5)"
    assert eval(repr(build("ms-imm-ikf")), {**vars(sr), "inf": math.inf}) == build("ms-imm-ikf")
    assert repr(sr.Filter(PT1, channels=3)) == f"Filter({PT1!r}, channels=3, dtype='float64')"
    log = sr.Log(t_s=np.arange(100) / 50.0, rate_dps=np.zeros((100, 1)), channels=("gz_dps",))
    assert repr(log) == "Log(100 samples of gz_dps at 50 Hz)"
    trace = sr.Filter(PT1).run([1.0, 2.0], trace=True)
    assert repr(trace).startswith("Trace(shape=(2,), models=1: rate, ")
    allan = sr.allan(np.random.default_rng(1).normal(size=2000), 50.0)
    observed = sr.observability(
        [[0, 1], [0, 0]], [[1, 0]], duration_s=10, interval_s=0.1, measurement_sigma=0.01, prior_sigma=1
    )
    for thing in (allan, observed, sr.VectorRls(2), sr.simulate.static(50.0, 1)):
        text = repr(thing)
        assert type(thing).__name__ in text and "\n" not in text and "object at 0x" not in text, text


def test_completion_offers_what_is_public_and_nothing_else():
    offered = {name for name in dir(sr) if not name.startswith("_")}
    assert offered == {name for name in sr.__all__ if not name.startswith("_")}
    assert all(hasattr(sr, name) for name in sr.__all__)
    for method in METHODS:
        config = build(method)
        fields = set(inspect.signature(type(config)).parameters)
        assert {"sample_rate_hz", "noise"} < fields <= set(dir(config))
    assert {"update", "run", "estimate", "save", "restore", "reset", "config"} <= set(dir(sr.Filter))
    for stub in (sr.Filter.run, sr.Filter.update):
        assert inspect.signature(stub).parameters
    assert "density_dps_sqrt_hz" in inspect.signature(sr.GyroNoise).parameters


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: sr.MsImmIkf(sample_rate_hz=50.0, dwel_time_s=3.0), "did you mean 'dwell_time_s'"),
        (lambda: PT1.replace(cutof_hz=3.0), "did you mean 'cutoff_hz'"),
        (lambda: sr.denoise([0.0] * 20, sample_rate_hz=50.0, method="ms-imm-kf", noise=NOISE), "'ms-imm-ikf'"),
        (lambda: sr.tune(sr.Log(t_s=np.arange(9.0), rate_dps=np.zeros(9), channels=("g",)), "onee-uro"), "'one-euro'"),
        (lambda: sr.denois, "did you mean 'denoise'"),
        (lambda: sr.GyroNoise(density=0.01), "did you mean 'density_dps_sqrt_hz'"),
        (lambda: sr.GyroNoise(0.01), "by name: density_dps_sqrt_hz"),
        (lambda: sr.MsImmIfk, "did you mean 'MsImmIkf'"),
    ],
)
def test_errors_suggest_the_nearest_name(call, words):
    with pytest.raises((sr.ConfigError, AttributeError), match=words):
        call()


def test_the_command_line_suggests_the_nearest_name(tmp_path, capsys):
    log, out = tmp_path / "log.csv", tmp_path / "o.csv"
    log.write_text("t_s,gyro_x,gyro_y\n" + "".join(f"{k / 50},0.1,0.{k % 7}\n" for k in range(50)))
    (tmp_path / "f.toml").write_text('method = "pt1"\nsample_rate_hz = 50\ncutof_hz = 3\n')
    for arguments, near in (
        (["filtr"], "filter"),
        (["filter", log, "-o", out, "--methd", "pt1"], "--method"),
        (["filter", log, "-o", out, "--method", "ms-imm-kf"], "ms-imm-ikf"),
        (["compare", log, "--method", "pt11"], "pt1"),
        (["filter", log, "-o", out, "--columns", "gyro_z"], "gyro_y"),
        (["filter", log, "-o", out, "--config", tmp_path / "f.toml"], "cutoff_hz"),
        (["calibrate", "gimbl"], "gimbal"),
    ):
        assert main([str(word) for word in arguments]) in (1, 2)
        said = capsys.readouterr().err
        assert near in said and said.count("\n") == 1, said


@pytest.mark.parametrize("command", COMMANDS)
def test_help_shows_the_whole_description_of_a_command(command, capsys):
    assert main([command, "--help"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    described = importlib.import_module(f"stillrate.cli.{command.replace('-', '_')}").command.__doc__
    assert " ".join(described.partition("Parameters\n")[0].split()) in said


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_shell_completes_commands_and_options(shell):
    script = build_command_line().generate_completion(shell=shell)
    for word in (*COMMANDS, "reference-bias", "config", "keep-raw", "install-completion"):
        assert word in script, word


def test_the_stub_names_what_the_compiled_module_has():
    tree = ast.parse((HERE.parent / "python/stillrate/_native.pyi").read_text())
    named = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef | ast.FunctionDef)}
    public = {name for name in named if not name.startswith("_")}
    compiled = {name for name in dir(_native) if not name.startswith("_")}
    assert public == compiled
    assert "__getattr__" not in named
    for name in sorted(public):
        node, found = named[name], getattr(_native, name)
        if isinstance(node, ast.ClassDef):
            listed = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
            listed |= {item.target.id for item in node.body if isinstance(item, ast.AnnAssign)}
            there = {item for item in vars(found) if not item.startswith("_")}
            assert {item for item in listed if not item.startswith("_")} == there, name
        else:
            real = list(inspect.signature(found).parameters)
            written = [a.arg for a in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)]
            assert written == real, name


def test_a_users_code_passes_the_strict_type_checker():
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("mypy is not installed")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--no-error-summary", HERE / "typing_user.py"],
        capture_output=True,
        text=True,
        check=False,
        cwd=HERE,
    )
    assert done.returncode == 0, done.stdout + done.stderr
