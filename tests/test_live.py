"""The live command from outside: lines, UDP, a serial port, a terminal, signals."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import stillrate as sr
from stillrate.cli import main
from stillrate.live.source import StandardInput

TRAFFIC = Path(__file__).parent / "live_traffic.py"
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals and pseudo-terminals")


@pytest.fixture
def settings(tmp_path):
    path = tmp_path / "f.toml"
    noise = sr.GyroNoise(density_dps_sqrt_hz=0.0151, rate_random_walk_dps_sqrt_s=0.0033)
    sr.MsImmIkf(sample_rate_hz=1000.0, noise=noise).to_toml(path)
    return path


def start(*arguments, **pipes):
    return subprocess.Popen([sys.executable, "-m", "stillrate", "live", *map(str, arguments)], **pipes)


def feed(text, *arguments):
    done = subprocess.run(
        [sys.executable, "-m", "stillrate", "live", "-", *map(str, arguments)],
        input=text,
        capture_output=True,
        timeout=60,
        check=False,
    )
    return done.returncode, done.stdout.decode().splitlines(), done.stderr.decode()


def wait_until(true, seconds=30.0):
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


def test_a_log_replayed_line_by_line_has_the_bits_of_filter(tmp_path, settings):
    random = np.random.default_rng(5)
    t = np.arange(800) / 1000.0 + random.uniform(-1e-4, 1e-4, 800)
    z = random.normal(0.0, 0.5, (800, 2))
    z[300:310, 1] = np.nan
    log = sr.Log(t_s=t, rate_dps=z, channels=("gx_dps", "gy_dps"), sample_rate_hz=1000.0, columns={"temp": t})
    sr.write(tmp_path / "raw.csv", log)
    clean = tmp_path / "clean.csv"
    common = ["--config", str(settings), "--rate", "1000"]
    assert main(["filter", str(tmp_path / "raw.csv"), "-o", str(clean), "--quiet", *common]) == 0
    code, lines, _ = feed((tmp_path / "raw.csv").read_bytes(), *common, "--quiet")
    assert code == 0
    (tmp_path / "live.csv").write_text("\n".join(lines) + "\n")
    batch, live = sr.read(clean), sr.read(tmp_path / "live.csv")
    np.testing.assert_array_equal(live.rate_dps, batch.rate_dps)
    np.testing.assert_array_equal(live.columns["temp"], batch.columns["temp"])


def test_every_line_has_its_answer_and_bad_ones_are_counted(settings):
    text = b"# by hand\n1,2,20\n\nrubbish\n1,2\n1,nan,21\n\xff\xfe,1,2\n1,,22\n1,2,23"
    code, lines, said = feed(text, "--config", settings, "--columns", "1,2")
    assert code == 0 and len(lines) == 9
    assert lines[0] == "# by hand" and lines[1] == "1.0,2.0,20" and lines[2] == ""
    assert [line.split(",")[2] for line in lines[3:]] == ["", "", "21", "", "22", "23"]
    assert all(np.isfinite(float(field)) for line in lines[3:] for field in line.split(",")[:2])
    assert "9 lines in, 9 out; 7 samples, 3 malformed, 2 with a missing value" in said
    assert "model in force" in said and "added latency p50" in said


def test_bad_lines_before_the_first_good_one_are_answered_with_it():
    code, lines, _ = feed(b"12.\x00\nfoo\n1.5\n", "--rate", "100", "--density", "0.02", "--method", "pt1")
    assert code == 0 and len(lines) == 3 and lines[2] == "1.5"


def test_a_scrap_at_the_start_costs_no_line():
    code, lines, _ = feed(b"0.3\n1,2\n1,2\n", "--rate", "100", "--density", "0.02", "--method", "pt1")
    assert code == 0 and lines == ["0.3", "1.0,2.0", "1.0,2.0"]


@pytest.mark.parametrize(
    ("text", "arguments", "code", "words"),
    [
        (b"a\nb\n", ["--rate", "100", "--density", "0.02"], 1, "none of 2 lines holds numbers"),
        (b"1\n", ["--rate", "100"], 2, "--density"),
        (b"1\n", ["--rate", "100", "--density", "0.02", "--method", "pt2"], 2, "did you mean 'pt1'"),
        (b"1,2\n", ["--rate", "100", "--density", "0.02", "--columns", "3"], 1, "no column 3: the lines have 2"),
        (
            b"t_s,gyro_z\n",
            ["--rate", "100", "--density", "0.02", "--columns", "gyro_x"],
            1,
            "did you mean 'gyro_z'",
        ),
        (b"1\n", ["--rate", "100", "--density", "0.02", "-o", "file.csv"], 2, "cannot send there"),
        (b"1\n", ["--rate", "100", "--density", "0.02", "--unit", "rpm"], 2, "unit = 'rpm'"),
    ],
)
def test_wrong_calls_say_so(text, arguments, code, words, monkeypatch, capfd):
    read, write = os.pipe()
    os.write(write, text)
    os.close(write)
    monkeypatch.setattr("stillrate.live.source.StandardInput", lambda: StandardInput(read))
    assert main(["live", "-", "--quiet", *arguments]) == code
    os.close(read)
    said = capfd.readouterr().err
    assert words in said and said.count("\n") == 1


def traffic(settings, count, rate_hz, tmp_path):
    """Send, filter, receive in three processes; return seconds from sent to answered, NaN where lost, and the summary."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    receiver = subprocess.Popen([sys.executable, TRAFFIC, "receive", "0", str(count), "40"], stdout=subprocess.PIPE)
    answers = int(receiver.stdout.readline())
    source, sink = f"udp://127.0.0.1:{port}", f"udp://127.0.0.1:{answers}"
    said = tmp_path / "said.txt"
    with said.open("w") as errors:
        live = start(source, "-o", sink, "--config", settings, "--columns", "2", stderr=errors)
        wait_until(lambda: _listening(port) or live.poll() is not None)
        assert live.poll() is None, said.read_text()
        sender = subprocess.run(
            [sys.executable, TRAFFIC, "send", str(port), str(count), str(rate_hz)], capture_output=True, check=True
        )
        came = np.frombuffer(receiver.communicate(timeout=90)[0], np.int64)
        live.send_signal(signal.SIGTERM)
        assert live.wait(timeout=20) == 0
    left = np.frombuffer(sender.stdout, np.int64)
    return np.where(came > 0, (came - left) * 1e-9, np.nan), said.read_text()


@contextlib.contextmanager
def real_time():
    """Run children before all ordinary processes, where the system allows it: what else it does is not measured."""
    before = None
    if hasattr(os, "sched_setscheduler"):
        with contextlib.suppress(PermissionError):
            found = os.sched_getscheduler(0), os.sched_getparam(0)
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(5))
            before = found
    try:
        yield
    finally:
        if before is not None:
            os.sched_setscheduler(0, *before)


def _listening(port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("0.0.0.0", port))
        except OSError:
            return True
    return False


@POSIX
def test_udp_at_1_khz_loses_nothing(settings, tmp_path):
    latency_s, said = traffic(settings, 3000, 1000.0, tmp_path)
    assert not np.isnan(latency_s).any()
    assert "3000 lines in, 3000 out; 3000 samples, 0 malformed" in said and "dropped" not in said


@POSIX
@pytest.mark.long
def test_udp_at_1_khz_for_a_minute_adds_less_than_two_milliseconds(settings, tmp_path):
    with real_time():
        latency_s, said = traffic(settings, 60_000, 1000.0, tmp_path)
    assert not np.isnan(latency_s).any(), said
    assert np.percentile(latency_s, 99) < 2e-3, (np.percentile(latency_s, [50, 99, 100]), said)


@POSIX
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_end_it_with_a_summary(settings, number):
    live = start("-", "--config", settings, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    live.stdin.write(b"0.5\n0.6\n")
    live.stdin.flush()
    assert live.stdout.readline() == b"0.5\n"
    live.stdout.readline()
    live.send_signal(number)
    out, said = live.communicate(timeout=20)
    assert live.returncode == 0 and out == b""
    assert b"2 lines in, 2 out" in said and b"Traceback" not in said


@POSIX
def test_a_reader_that_goes_away_ends_it_quietly(settings):
    live = start("-", "--config", settings, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    live.stdin.write(b"0.5\n")
    live.stdin.flush()
    live.stdout.readline()
    live.stdout.close()
    with contextlib.suppress(BrokenPipeError):
        for _ in range(100):
            live.stdin.write(b"0.5\n")
            live.stdin.flush()
            time.sleep(0.01)
    assert live.wait(timeout=20) == 0
    said = live.stderr.read()
    assert b"lines in" in said and b"Traceback" not in said
    with contextlib.suppress(BrokenPipeError):
        live.stdin.close()


@POSIX
def test_a_serial_port_that_vanishes_is_found_again(settings, tmp_path):
    pytest.importorskip("serial")
    import pty
    import tty

    port = tmp_path / "gyro"

    def plug():
        master, slave = pty.openpty()
        tty.setraw(slave)
        port.unlink(missing_ok=True)
        port.symlink_to(os.ttyname(slave))
        return master, slave

    master, slave = plug()
    said = tmp_path / "said.txt"
    with said.open("w") as errors:
        live = start(port, "--config", settings, stdout=subprocess.PIPE, stderr=errors)
        os.set_blocking(live.stdout.fileno(), False)
        answers = b""

        def heard(count):
            nonlocal answers
            answers += live.stdout.read() or b""
            return answers.count(b"\n") >= count

        # The tail of a line is dropped; it is repeated until the port is open.
        wait_until(lambda: os.write(master, b"9\n0.5\n") and heard(1))
        before = answers.count(b"\n")
        os.close(slave)
        os.close(master)
        port.unlink()
        time.sleep(0.5)
        assert live.poll() is None
        master, slave = plug()
        wait_until(lambda: os.write(master, b"9\n0.5\n") and heard(before + 3))
        live.send_signal(signal.SIGINT)
        assert live.wait(timeout=20) == 0
    os.close(master)
    os.close(slave)
    assert "1 reconnections" in said.read_text()


@POSIX
def test_a_terminal_shows_rate_latency_and_model(settings, tmp_path):
    import pty
    import select

    master, slave = pty.openpty()
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "120", "LINES": "30"}
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.DEVNULL, "stderr": slave, "env": environment}
    live = start("-", "--config", settings, **pipes)
    os.close(slave)
    seen = b""
    end = time.monotonic() + 40
    while b"rest (" not in seen and time.monotonic() < end:
        live.stdin.write(b"0.5\n" * 50)
        live.stdin.flush()
        while select.select([master], [], [], 0.05)[0]:
            seen += os.read(master, 4096)
    live.send_signal(signal.SIGINT)
    with contextlib.suppress(OSError):
        while data := os.read(master, 4096):
            seen += data
    assert live.wait(timeout=20) == 0
    live.stdin.close()
    os.close(master)
    for word in (b"rate", b"jitter", b"latency", b"p99", b"model in force", b"rest (", b"column 1"):
        assert word in seen, seen[-2000:]
