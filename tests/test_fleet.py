"""Many logs at once: restarts, broken ones, the summary, a scheduler of one's own."""

from __future__ import annotations

import contextlib
import json
import socket
import warnings

import numpy as np
import pytest
import stillrate as sr
from stillrate.cli import main

polars = pytest.importorskip("polars")
distributed = pytest.importorskip("distributed")

from stillrate import fleet  # noqa: E402
from stillrate.fleet_work import read_record  # noqa: E402

BROKEN = {
    "empty.csv": b"",
    "words.csv": b"a,b\nc,d\ne,f\n",
    "half.parquet": b"PAR1half a file",
    "deep/noise.npz": bytes(range(256)) * 8,
    "short.csv": b"t_s,gx_dps\n0.0,1.0\n",
}


ONE_THREAD = {"n_workers": 1, "threads_per_worker": 1, "processes": False, "dashboard_address": None}


def make_logs(folder, count, samples=200):
    random = np.random.default_rng(4)
    t = np.arange(samples) / 100.0
    for index in range(count):
        path = folder / ("deep" if index % 3 == 0 else ".") / f"flight{index:03d}{('.csv', '.npz')[index % 2]}"
        path.parent.mkdir(parents=True, exist_ok=True)
        z = random.normal(0.0, 0.15, (samples, 2))
        z[20:24, 0] = np.nan
        sr.write(path, sr.Log(t_s=t, rate_dps=z, channels=("gx_dps", "gy_dps")))
    for name, content in BROKEN.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)


def stamps(out):
    return {path: path.stat().st_mtime_ns for path in sorted(out.rglob("*")) if path.is_file()}


def check_fleet(tmp_path, capsys, count):
    logs, out = tmp_path / "logs", tmp_path / "out"
    make_logs(logs, count)
    assert main(["fleet", str(logs), "-o", str(out), "--workers", "2"]) == 1
    said = capsys.readouterr().err
    named = {line.split(": ")[1] for line in said.splitlines() if line.startswith("stillrate: ")}
    assert named == set(BROKEN), said
    assert f"{count + 5} logs: {count + 5} done now, 0 before, 5 broken" in said
    table = polars.read_parquet(out / "summary.parquet")
    broken = table.filter(polars.col("status") == "broken")
    assert set(broken["log"]) == set(BROKEN) and broken["reason"].null_count() == 0
    done = table.filter(polars.col("status") == "done")
    assert len(done) == 2 * count and done["log"].n_unique() == count
    assert done.filter(polars.col("channel") == "gx_dps")["missing"].to_list() == [4] * count
    before = stamps(out)
    assert main(["fleet", str(logs), "-o", str(out)]) == 1
    said = capsys.readouterr().err
    assert f"0 done now, {count + 5} before, 5 broken" in said and all(
        f"stillrate: {name}: " in said for name in BROKEN
    )
    assert stamps(out) == before
    return logs, out


def test_a_dozen_logs_with_broken_ones_are_finished_once(tmp_path, capsys):
    logs, out = check_fleet(tmp_path, capsys, 12)
    name = "deep/flight000.csv"
    clean = sr.read(out / "clean" / f"{name}.parquet")
    raw = sr.read(logs / name)
    config = sr.load_config(_written(clean, tmp_path))
    np.testing.assert_array_equal(clean.rate_dps[:, 1], sr.Filter(config).run(raw.rate_dps[:, 1]))
    # What was lost or changed is done again, and nothing else; a change asks first.
    (out / "clean" / f"{name}.parquet").unlink()
    (out / "records/flight001.npz.json").write_text("{")
    make_logs(logs, 0)
    (logs / "empty.csv").write_bytes((logs / name).read_bytes())
    before = stamps(out)
    assert main(["fleet", str(logs), "-o", str(out), "--workers", "2"]) == 1
    assert "17 logs: 3 done now, 14 before, 4 broken" in capsys.readouterr().err
    after = stamps(out)
    touched = {str(path.relative_to(out)) for path in after if after[path] != before.get(path)}
    assert touched == {
        "summary.parquet",
        f"clean/{name}.parquet",
        f"records/{name}.json",
        "records/flight001.npz.json",
        "clean/flight001.npz.parquet",
        "records/empty.csv.json",
        "clean/empty.csv.parquet",
    }
    assert main(["fleet", str(logs), "-o", str(out), "--method", "pt1"]) == 2
    said = capsys.readouterr().err
    assert "13 logs with other content or settings" in said and "--force" in said
    assert stamps(out) == after


def _written(log, tmp_path):
    path = tmp_path / "written.toml"
    path.write_text(log.meta["stillrate"]["configuration"]["gy_dps"])
    return path


@pytest.mark.long
def test_two_hundred_logs_with_five_broken_ones_are_finished_once(tmp_path, capsys):
    check_fleet(tmp_path, capsys, 195)


def test_a_scheduler_of_ones_own_does_the_work(tmp_path):
    make_logs(tmp_path / "logs", 3)
    seen = []
    with distributed.LocalCluster(**ONE_THREAD) as cluster:
        found = fleet.run(
            [tmp_path / "logs/*.csv", tmp_path / "logs/*.npz"],
            tmp_path / "out",
            method="pt1",
            scheduler=cluster.scheduler_address,
            progress=lambda finished, total: seen.append((finished, total)),
        )
    assert {record.name for record in found.records if not record.broken} == {"flight001.npz", "flight002.csv"}
    assert {record.name for record in found.broken} == {"empty.csv", "words.csv", "short.csv"}
    assert seen == [(k, 5) for k in range(6)]


def test_what_was_finished_before_an_interruption_stays(tmp_path, monkeypatch, capsys):
    make_logs(tmp_path / "logs", 3)
    all_of_it = fleet._work_all

    def interrupted(client, jobs):
        yield from all_of_it(client, jobs[:2])
        raise KeyboardInterrupt

    monkeypatch.setattr(fleet, "_work_all", interrupted)
    with distributed.LocalCluster(**ONE_THREAD) as cluster:
        command = ["fleet", str(tmp_path / "logs"), "-o", str(tmp_path / "out")]
        command += ["--scheduler", cluster.scheduler_address]
        assert main(command) == 130
        assert "stopped with 2 of 8 logs finished" in capsys.readouterr().err
        monkeypatch.setattr(fleet, "_work_all", all_of_it)
        assert main(command) == 1
        assert "8 logs: 6 done now, 2 before" in capsys.readouterr().err


def test_a_scheduler_that_is_not_there_is_named(tmp_path, monkeypatch, capsys):
    make_logs(tmp_path / "logs", 1)
    monkeypatch.setattr(fleet, "_PATIENCE_S", 1)
    command = ["fleet", str(tmp_path / "logs"), "-o", str(tmp_path / "out"), "--scheduler", "tcp://127.0.0.1:9"]
    assert main(command) == 1
    assert "tcp://127.0.0.1:9: cannot reach the scheduler" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        ([], 2, "FOLDER_OR_GLOB requires an argument"),
        (["nowhere/*.csv"], 1, "no logs in nowhere/*.csv"),
        (["logs", "--method", "pt11"], 2, "did you mean 'pt1'"),
        (["logs", "--workers", "0"], 2, "at least 1"),
    ],
)
def test_wrong_calls_say_so_before_any_work(tmp_path, monkeypatch, capsys, arguments, code, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "logs").mkdir()
    assert main(["fleet", *arguments, "-o", "out"]) == code
    said = capsys.readouterr().err
    assert words in said and said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_folder_of_something_else_is_left_alone(tmp_path, capsys):
    make_logs(tmp_path / "logs", 1)
    (tmp_path / "out").mkdir()
    (tmp_path / "out/thesis.tex").write_text("precious")
    assert main(["fleet", str(tmp_path / "logs"), "-o", str(tmp_path / "out")]) == 2
    assert "holds no fleet results" in capsys.readouterr().err
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["thesis.tex"]


def test_results_of_another_run_below_the_logs_are_no_logs(tmp_path):
    sr.write(tmp_path / "flight.csv", sr.Log(t_s=np.arange(9) / 50.0, rate_dps=np.arange(9) % 2, channels=("gx_dps",)))
    for out in ("slow", "fast"):
        found = fleet.run([tmp_path], tmp_path / out, method="pt1", workers=1)
        assert [record.name for record in found.records] == ["flight.csv"]
    # Who names the results asks for them.
    found, _ = fleet.find_logs([tmp_path / "slow"], tmp_path / "out")
    assert [path.name for path in found] == ["flight.csv.parquet", "summary.parquet"]


def test_a_taken_port_of_the_dashboard_is_no_news(tmp_path):
    make_logs(tmp_path / "logs", 1)
    with socket.socket() as taken, warnings.catch_warnings():
        with contextlib.suppress(OSError):  # someone else has it: just as well
            taken.bind(("127.0.0.1", 8787))
            taken.listen()
        warnings.simplefilter("error", UserWarning)
        assert fleet.run([tmp_path / "logs/deep"], tmp_path / "out", method="pt1", workers=1).done == 2


def test_a_record_that_cannot_be_read_is_none(tmp_path):
    for content in ("", "[]", "{}", json.dumps({"name": "a", "channels": 3}), json.dumps({"name": "a", "spare": 1})):
        (tmp_path / "r.json").write_text(content)
        assert read_record(tmp_path / "r.json") is None
    assert read_record(tmp_path / "absent.json") is None
