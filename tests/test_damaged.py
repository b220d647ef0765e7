"""Damaged logs through the command line: exit 1, one line on stderr, little time, little memory, nothing written.

Each variant runs as a process of its own, which may not map more than `ADDRESS_SPACE` bytes, must not hold more than
`RESIDENT` at any time, and must not compute for more than `CPU_S` (computing time, since a busy machine is not our fault).
Two kinds of variants: those no reader can make sense of must fail; flipped bits and cut ends of formats without a check
sum may still be a log, only a shorter or slightly other one, and then may be read.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import real_logs
import small_logs

ADDRESS_SPACE, RESIDENT, CPU_S = 4_000_000_000, 400_000_000, 2.0
HUGE = 2_000_000_000

RUN = f"""
import resource, sys
resource.setrlimit(resource.RLIMIT_AS, ({ADDRESS_SPACE}, {ADDRESS_SPACE}))
from stillrate.cli import main
code = 2
try:
    code = main()
except SystemExit as error:
    code = error.code
finally:
    held = next(line for line in open("/proc/self/status") if line.startswith("VmHWM"))
    open("held", "w").write(held.split()[1])
sys.exit(code)
"""

linux = pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="memory is measured through /proc")


def flipped(path: Path, at: float, bit: int = 0x10) -> None:
    content = bytearray(path.read_bytes())
    content[int(at * (len(content) - 1))] ^= bit
    path.write_bytes(content)


def cut(path: Path, part: float) -> None:
    content = path.read_bytes()
    path.write_bytes(content[: int(part * len(content))])


def sparse(path: Path) -> None:
    """Zeros behind what is there, as a file system leaves them after a crash; they take no room on the disk."""
    with path.open("r+b") as file:
        file.truncate(HUGE)


def inside(folder: Path) -> Path:
    return next(folder.glob("*.db3"))


def good(folder: Path, kind: str, rows: int = small_logs.ROWS) -> Path:
    path = folder / f"log.{kind}"
    small_logs.WRITERS[kind](path, rows)
    return path


def run(folder: Path, path: Path) -> tuple[int, str]:
    """Filter a log in a process of its own; return the exit code and what it said."""
    output = folder / "clean.csv"
    command = [sys.executable, "-c", RUN, "filter", str(path), "-o", str(output), "--quiet"]
    before = os.times()
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    after = os.times()
    held = 1024 * int((folder / "held").read_text())
    spent = after.children_user + after.children_system - before.children_user - before.children_system
    assert "Traceback" not in done.stderr and done.stdout == "", done.stderr
    assert held < RESIDENT, f"held {held / 1e6:.0f} MB"
    assert spent < CPU_S, f"computed for {spent:.2f} s"
    assert output.exists() == (done.returncode == 0)
    return done.returncode, done.stderr


def refused(folder: Path, path: Path) -> None:
    code, said = run(folder, path)
    assert code == 1 and len(said.splitlines()) == 1, said
    assert path.name in said


EMPTY = [kind for kind in small_logs.WRITERS if kind not in ("ros2", "tsv")]


@linux
@pytest.mark.parametrize("kind", EMPTY)
def test_an_empty_file_is_refused(tmp_path, kind):
    (tmp_path / f"log.{kind}").touch()
    refused(tmp_path, tmp_path / f"log.{kind}")


@linux
@pytest.mark.parametrize("kind", list(small_logs.WRITERS))
def test_two_gigabytes_of_nothing_behind_a_log_are_refused(tmp_path, kind):
    path = good(tmp_path, kind)
    sparse(inside(path) if path.is_dir() else path)
    refused(tmp_path, path)


@linux
@pytest.mark.parametrize("kind", ["npz", "parquet", "ulg", "bag", "mcap", "h5", "mat", "ros2"])
def test_half_a_log_is_refused(tmp_path, kind):
    path = good(tmp_path, kind)
    cut(inside(path) if path.is_dir() else path, 0.503)
    refused(tmp_path, path)


@linux
@pytest.mark.parametrize(
    ("kind", "claimed"),
    [
        ("csv", "parquet"),
        ("csv", "npz"),
        ("npz", "csv"),
        ("parquet", "npz"),
        ("mcap", "ulg"),
        ("ulg", "bbl"),
        ("h5", "npz"),
        ("bbl", "bag"),
    ],
)
def test_a_wrong_ending_is_refused(tmp_path, kind, claimed):
    path = good(tmp_path, kind)
    refused(tmp_path, path.rename(tmp_path / f"log.{claimed}"))


@linux
@pytest.mark.parametrize("rows", [0, 1])
@pytest.mark.parametrize("kind", ["csv", "npz", "parquet", "h5", "bbl"])
def test_no_row_and_one_row_are_refused(tmp_path, kind, rows):
    # One row has no rate to speak of; `--rate` says it.
    refused(tmp_path, good(tmp_path, kind, rows))


@linux
@pytest.mark.parametrize("kind", ["npz", "mat"])
def test_a_flipped_bit_is_refused_where_the_format_has_a_check_sum(tmp_path, kind):
    path = good(tmp_path, kind)
    flipped(path, 0.4)
    refused(tmp_path, path)


@linux
@pytest.mark.parametrize("kind", ["npz", "ulg", "bag", "mcap", "h5", "bbl", "ros2"])
def test_a_flipped_bit_at_the_very_beginning_is_refused(tmp_path, kind):
    # Not so for MATLAB, whose files begin with free text, and Parquet, whose own mark also stands at the end.
    path = good(tmp_path, kind)
    flipped(inside(path) if path.is_dir() else path, 0.0)
    refused(tmp_path, path)


@linux
def test_text_with_a_flipped_bit_in_a_number_is_refused(tmp_path):
    path = good(tmp_path, "csv")
    content = bytearray(path.read_bytes())
    content[content.index(b".", 1000)] ^= 0x40  # a point becomes an n
    path.write_bytes(content)
    refused(tmp_path, path)


def _readable_or_refused(tmp_path: Path, kind: str, change: object) -> None:
    """In this process: a log, or one line."""
    import stillrate as sr

    path = good(tmp_path, kind)
    change(inside(path) if path.is_dir() else path)  # type: ignore[operator]
    try:
        log = sr.read(path)
    except sr.LogError as error:
        assert "\n" not in str(error) and path.name in str(error)
    else:
        assert log.rate_dps.shape[1] in (1, 2, 3) and len(log) <= small_logs.ROWS + 1


@pytest.mark.parametrize("kind", list(small_logs.WRITERS))
def test_flipped_bits_anywhere_give_a_log_or_one_line(tmp_path, kind):
    random = np.random.default_rng(12)
    for count in range(20):
        folder = tmp_path / str(count)
        folder.mkdir()
        at, bit = random.random(), 1 << int(random.integers(8))
        _readable_or_refused(folder, kind, lambda path, at=at, bit=bit: flipped(path, at, bit))


@pytest.mark.parametrize("kind", list(small_logs.WRITERS))
def test_cuts_anywhere_give_a_log_or_one_line(tmp_path, kind):
    for count, part in enumerate(np.random.default_rng(13).random(10)):
        folder = tmp_path / str(count)
        folder.mkdir()
        _readable_or_refused(folder, kind, lambda path, part=part: cut(path, part))


def test_what_is_left_of_a_cut_flight_is_read_and_said_to_be_cut(tmp_path):
    import stillrate as sr

    path = good(tmp_path, "bbl")
    cut(path, 0.5)
    log = sr.read(path)
    assert 200 < len(log) < 400 and "the log was not closed: it may end early" in log.meta["notes"]
    np.testing.assert_allclose(log.rate_dps, small_logs.samples()[1][: len(log)], atol=0.0051)


@linux
@real_logs.needed
@pytest.mark.parametrize(
    "name", ["sample_appended_multiple.ulg", "xio_imu.mcap", "ains_ahrs_imu.parquet", "btfl_001.bbl"]
)
def test_logs_of_real_loggers_are_refused_with_zeros_behind_without_their_head_and_cut_in_half(tmp_path, name):
    content = (real_logs.FORMATS / name).read_bytes()
    path = tmp_path / name
    path.write_bytes(content)
    sparse(path)
    refused(tmp_path, path)
    path.write_bytes(content[100:])
    refused(tmp_path, path)
    if path.suffix != ".bbl":  # of which the first half is a shorter flight
        path.write_bytes(content[: len(content) // 2])
        refused(tmp_path, path)
