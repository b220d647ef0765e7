"""The parts of the live loop: lines, stamps, sources, figures, the viewer."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from stillrate.errors import ConfigError, LogError
from stillrate.live import LineFormat
from stillrate.live.batch import LONGEST_LINE, Splitter
from stillrate.live.clock import Clock
from stillrate.live.source import open_source
from stillrate.live.statistics import Histogram, Statistics


def test_a_file_is_no_live_source(tmp_path):
    (tmp_path / "log.csv").write_text("1\n")
    with pytest.raises(LogError, match="filter"):
        open_source(str(tmp_path / "log.csv"))
    with pytest.raises(ConfigError, match="udp://HOST:PORT"):
        open_source("udp://nowhere")
    with pytest.raises(LogError, match=r"udp://nowhere\.invalid:5005: no such host"):
        open_source("udp://nowhere.invalid:5005")


def test_the_viewer_says_what_it_needs(monkeypatch):
    from stillrate.live.viewer import Rerun

    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(LogError, match="viewer needs rerun: pip install"):
        Rerun()


def test_the_viewer_is_handed_every_sample(tmp_path):
    if not hasattr(pytest.importorskip("rerun"), "RecordingStream"):
        pytest.skip("another package called rerun")
    from stillrate.live.viewer import Rerun

    with Rerun(str(tmp_path / "run.rrd")) as viewer:
        for index in range(1000):
            viewer.sample(index * 1_000_000, (0.1, 0.2), (0.1, 0.2))
    assert (tmp_path / "run.rrd").stat().st_size > 8000


def test_lines_are_split_wherever_the_pieces_end():
    text = b"1,2\r\n3,4\n\n5"
    for cut in range(len(text)):
        splitter = Splitter()
        assert [*splitter.feed(text[:cut]), *splitter.feed(text[cut:]), *splitter.last()] == [b"1,2", b"3,4", b"", b"5"]


def test_an_endless_line_is_one_malformed_line_in_bounded_memory():
    splitter = Splitter()
    found = [line for _ in range(40) for line in splitter.feed(b"1" * (LONGEST_LINE // 4))]
    assert found == [] and splitter.feed(b"1\n2\n") == [b"?", b"2"]
    assert splitter.feed(b"1" * (2 * LONGEST_LINE) + b"\n") == [b"?"]


@pytest.mark.parametrize("separator", [",", ";", "\t", " "])
def test_fields_keep_their_separator_and_units(separator):
    layout = LineFormat(unit="rad/s", columns=["2"], time="1")
    row = layout.parse(separator.join(["10", "1.0", "x"]).encode())
    assert row is not None and row.values == [pytest.approx(57.29577951308232)] and row.stamp == b"10"
    assert layout.format(row, row.values) == separator.join(["10", "1.0", "x"]).encode()


def test_a_scrap_at_the_start_does_not_settle_the_layout():
    layout = LineFormat()
    assert layout.parse(b"rubbish 5").values == [5.0]
    assert layout.parse(b"$IMU,1,2,3").values == [1.0, 2.0, 3.0]
    assert layout.parse(b"$IMU,1,2,4").values == [1.0, 2.0, 4.0]
    assert layout.parse(b"7") is None and layout.parse(b"$IMU,x,2,4") is None
    assert layout.format(None, [1.0, 2.0, 3.0]) == b",1.0,2.0,3.0"


def test_stamps_give_steps_as_in_a_log():
    clock = Clock(100.0)
    stamps = [b"1700000000000000000", b"1700000000010000000", b"1700000000020100000", b"x", b"1700000000050000000"]
    first, *steps = [clock.step_s(stamp) for stamp in stamps]
    assert first is None and np.isnan(steps[2])
    assert steps[:2] == [0.01, 0.01] and steps[3] == pytest.approx(0.0299, rel=1e-6)
    clock.skip()
    assert clock.step_s(b"1700000000070000000") == pytest.approx(0.01)


def test_percentiles_are_those_of_the_sample_within_a_bin():
    random = np.random.default_rng(2)
    values = np.exp(random.normal(-8.0, 1.5, 20_000))
    histogram = Histogram()
    for value in values:
        histogram.add(float(value))
    for percent in (1.0, 50.0, 99.0, 100.0):
        assert histogram.percentile_s(percent) == pytest.approx(np.percentile(values, percent), rel=0.045)
    assert histogram.largest_s == values.max()


def test_a_pause_of_the_sender_does_not_count_into_the_rate():
    counts = Statistics(period_s=0.01)
    at = 1_000_000_000
    for index in range(200):
        at += 2_000_000_000 if index == 100 else 10_000_000
        counts.arrived(at, 1, connected=index != 150)
    assert counts.rate_hz == pytest.approx(100.0)
    assert counts.jitter.largest_s == pytest.approx(1.99)
