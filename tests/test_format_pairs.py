"""Noise from a log of one format, a log of another cleaned with it, written in a third, as typed at a prompt."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import small_logs
import stillrate as sr
from real_logs import FORMATS, RECORDINGS, needed
from stillrate.cli import main

OUTPUTS = ("csv", "tsv", "npz", "parquet")
MAX_PAGE_BYTES = 8_000_000


def typed(*words):
    return main([str(word) for word in words])


def tuned_and_cleaned(folder, still, moving, ending, *, report=True):
    """`stillrate tune STILL -o f.toml && stillrate filter MOVING --config f.toml -o clean.ENDING --report page.html`."""
    for name in ("f.toml", "page.html", f"clean.{ending}"):
        (folder / name).unlink(missing_ok=True)
    settings, clean, page = folder / "f.toml", folder / f"clean.{ending}", folder / "page.html"
    assert typed("tune", still, "-o", settings) == 0
    told = ["--report", page] if report else []
    assert typed("filter", moving, "--config", settings, "-o", clean, "--quiet", *told) == 0
    before, after = sr.read(moving), sr.read(clean)
    assert len(after) == len(before) and after.channels[0].split("_")[0] == before.channels[0].split("_")[0]
    lines = settings.read_text().splitlines()
    for at, line in enumerate(lines):
        if " = " in line and not line.startswith("#"):
            above = next(other for other in reversed(lines[:at]) if " = " not in other or other.startswith("#"))
            assert above.startswith("# "), f"{line!r} has no comment"
    # Text and tables keep their own time column; what is read back has the same steps.
    np.testing.assert_allclose(after.t_s, before.t_s, atol=1e-6)
    assert np.isfinite(after.rate_dps).all() and (after.rate_dps != before.rate_dps).any()
    # How it was made travels with the file.
    assert "ms-imm-ikf" in str(after.meta)
    if report:
        assert 20_000 < page.stat().st_size < MAX_PAGE_BYTES


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pairs")
    made = {}
    for kind, write in small_logs.WRITERS.items():
        try:
            write(folder / f"log.{kind}")
        except pytest.skip.Exception:
            continue
        made[kind] = folder / f"log.{kind}"
    return made


def test_each_format_gives_settings_and_each_is_cleaned_with_the_next_ones(tmp_path, small):
    kinds = list(small)
    for index, kind in enumerate(kinds):
        other, ending = kinds[(index + 1) % len(kinds)], OUTPUTS[index % len(OUTPUTS)]
        tuned_and_cleaned(tmp_path, small[kind], small[other], ending, report=index == 0)


@pytest.mark.long
def test_every_pair_of_formats_in_every_output(tmp_path, small):
    for still, moving, ending in itertools.product(small, small, OUTPUTS):
        tuned_and_cleaned(tmp_path, small[still], small[moving], ending, report=ending == "csv")


@needed
def test_a_still_recording_and_a_bag_as_typed_beside_them(tmp_path):
    still, moving = RECORDINGS / "mpu6050_uncuyo_static449s.npz", FORMATS / "xio_imu.mcap"
    tuned_and_cleaned(tmp_path, still, moving, "parquet")


@pytest.mark.long
@needed
def test_every_pair_of_real_logs_in_turning_outputs(tmp_path):
    files = sorted(FORMATS.iterdir())
    stills = [*files, RECORDINGS / "mpu6050_uncuyo_static449s.npz"]
    refused = []
    for still, (index, moving) in itertools.product(stills, enumerate(files)):
        ending = OUTPUTS[(index + stills.index(still)) % len(OUTPUTS)]
        try:
            tuned_and_cleaned(tmp_path, still, moving, ending)
        except AssertionError as error:
            refused.append((still.name, moving.name, ending, str(error).splitlines()[:2]))
    print(f"{len(stills) * len(files) - len(refused)} of {len(stills) * len(files)} pairs")
    assert not refused
