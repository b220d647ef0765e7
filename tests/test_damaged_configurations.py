"""Configurations and saved filters that are cut off, flipped, of another version or of another filter are refused, for every method."""

from __future__ import annotations

from pathlib import Path

import pytest
import stillrate as sr
from every_method import METHODS, build
from stillrate import _native
from stillrate.config import Config


def refused_or_same(text: bytes, config: Config, path: Path) -> bool:
    """Return whether damaged text was refused; a blank more is no damage, but nothing else may come of it."""
    path.write_bytes(text)
    try:
        assert sr.load_config(path) == config, text
    except sr.ConfigError:
        return True
    return False


@pytest.mark.parametrize("method", METHODS)
def test_settings_cut_off_anywhere_are_refused(method: str, tmp_path: Path) -> None:
    config = build(method)
    text = config.to_toml().encode()
    for end in range(len(text) - 1):
        assert refused_or_same(text[:end], config, tmp_path / "cut.toml"), text[:end]


@pytest.mark.parametrize("method", METHODS)
def test_settings_with_a_flipped_bit_are_refused_or_mean_the_same(method: str, tmp_path: Path) -> None:
    config = build(method)
    text = config.to_toml().encode()
    refused = 0
    for at in range(len(text)):
        flipped = bytearray(text)
        flipped[at] ^= 1 << (at % 8)
        refused += refused_or_same(bytes(flipped), config, tmp_path / "flipped.toml")
    assert refused > 0.95 * len(text)


@pytest.mark.parametrize("method", METHODS)
def test_settings_of_another_format_or_filter_are_refused(method: str, tmp_path: Path) -> None:
    text = build(method).to_toml()
    path = tmp_path / "other.toml"
    path.write_text(text.replace("format = 1", "format = 2"))
    with pytest.raises(sr.ConfigError, match="format 2"):
        sr.load_config(path)
    for other in METHODS:
        if other != method:
            path.write_text(text.replace(f'"{method}"', f'"{other}"', 1))
            with pytest.raises(sr.ConfigError, match="checksum"):
                sr.load_config(path)


def test_settings_changed_by_hand_load_without_the_checksum(tmp_path: Path) -> None:
    text = sr.Pt1(sample_rate_hz=50.0, cutoff_hz=8.0).to_toml().replace("cutoff_hz = 8.0", "cutoff_hz = 9")
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(sr.ConfigError, match="remove the line that begins with checksum"):
        sr.load_config(path)
    path.write_text("".join(line for line in text.splitlines(keepends=True) if not line.startswith("checksum")))
    assert sr.load_config(path) == sr.Pt1(sample_rate_hz=50.0, cutoff_hz=9.0)


@pytest.mark.parametrize("method", METHODS)
def test_absurd_settings_are_refused_with_field_value_unit_and_range(method: str) -> None:
    for name, value in build(method).settings().items():
        found = _native.setting_range(method, name)
        if isinstance(value, str):
            assert found is None
            continue
        assert found is not None, name
        _, high, words, unit = found
        for absurd in (1e30, -1e30, float("nan"), 1.5 * high):
            changed = [absurd] * max(len(value), 1) if isinstance(value, list) else absurd
            with pytest.raises(sr.ConfigError) as refusal:
                _native.resolve(method, {"sample_rate_hz": 100.0, name: changed})
            if name != "forgetting_factor":  # this one may be told that it contradicts tau_s first
                assert all(part in str(refusal.value) for part in (name, words, unit)), refusal.value


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_a_saved_filter_that_is_damaged_is_refused(method: str, dtype: str) -> None:
    running = sr.Filter(build(method), dtype=dtype)
    running.run([0.1, 0.2, float("nan"), 0.1] * 20)
    good = running.save()
    assert sr.Filter.restore(good).save() == good
    for at in range(0, len(good), 3):
        flipped = bytearray(good)
        flipped[at] ^= 1 << (at % 8)
        for bad in (good[:at], bytes(flipped)):
            with pytest.raises(sr.ConfigError):
                sr.Filter.restore(bad)


def test_what_is_no_saved_filter_or_of_another_version_is_refused_in_words() -> None:
    good = sr.Filter(build("singer-imm-kf")).save()
    for other in (b"", b"something else entirely"):
        with pytest.raises(sr.ConfigError, match="not a saved filter"):
            sr.Filter.restore(other)
    with pytest.raises(sr.ConfigError, match="version 99"):
        sr.Filter.restore(good[:8] + b"\x63" + good[9:])
