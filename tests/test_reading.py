"""Tables as found in the wild: columns, units, time stamps, dialects."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import stillrate as sr
from hypothesis import given, settings
from hypothesis import strategies as st
from real_logs import FORMATS, RECORDINGS, needed
from stillrate import demo

RAD = 180.0 / np.pi


def written(folder: Path, text: str | bytes, name: str = "log.csv") -> Path:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def table(header: str, rows: int = 20, step: float = 0.01, scale: float = 1.0) -> str:
    lines = [header]
    count = len(header.split(","))
    for k in range(rows):
        lines.append(",".join([f"{k * step:.10g}", *(f"{scale * (k + column):.6g}" for column in range(1, count))]))
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("header", "factor"),
    [
        ("t_s,gx_dps,gy_dps,gz_dps", 1.0),
        ("Time (s),Gyroscope X (deg/s),Gyroscope Y (deg/s),Gyroscope Z (deg/s)", 1.0),
        ("time,gyro_x,gyro_y,gyro_z", 1.0),
        ("time [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s]", RAD),
        ("t,wx_rad_s,wy_rad_s,wz_rad_s", RAD),
        ("timestamp_s,GyroX_dps,GyroY_dps,GyroZ_dps", 1.0),
        ("time,angular_velocity.x,angular_velocity.y,angular_velocity.z", RAD),
        ("%time,field.angular_velocity.x,field.angular_velocity.y,field.angular_velocity.z", RAD),
        ("Time,Gyr_X (°/s),Gyr_Y (°/s),Gyr_Z (°/s)", 1.0),
        ("seconds,gyroADC[0],gyroADC[1],gyroADC[2]", 1.0),
        ("t_s,gx_mdps,gy_mdps,gz_mdps", 1e-3),
        ("time,roll_rate_rad_s,pitch_rate_rad_s,yaw_rate_rad_s", RAD),
        ("seconds_elapsed,gyroRotationX(rad/s),gyroRotationY(rad/s),gyroRotationZ(rad/s)", RAD),
    ],
)
def test_headers_as_loggers_write_them_are_known(tmp_path, header, factor):
    log = sr.read(written(tmp_path, table(header)))
    assert log.rate_dps.shape == (20, 3)
    assert log.sample_rate_hz == pytest.approx(100.0)
    np.testing.assert_allclose(log.rate_dps[3], factor * np.array([4.0, 5.0, 6.0]), rtol=1e-12)
    assert log.timing.regular and not log.timing.remarks()


@pytest.mark.parametrize(
    ("name", "step"), [("t_us", 1e4), ("time_ms", 10), ("stamp (ns)", 1e7), ("timestamp", 10), ("time", 1e4)]
)
def test_time_units_come_from_the_name_or_the_step(tmp_path, name, step):
    log = sr.read(written(tmp_path, table(f"{name},gz_dps", step=step)))
    assert log.sample_rate_hz == pytest.approx(100.0)
    assert log.t_s[0] == 0.0 and log.t_s[-1] == pytest.approx(0.19)


def test_stamps_in_ns_since_1970_stay_exact(tmp_path):
    first = 1_700_000_000_123_456_789
    text = "timestamp_ns,gz_dps\n" + "".join(f"{first + k * 1_250_001},{k}\n" for k in range(10))
    log = sr.read(written(tmp_path, text))
    np.testing.assert_allclose(np.diff(log.t_s), 1.250001e-3, rtol=1e-12)
    sr.write(tmp_path / "again.csv", log)
    assert f"\n{first + 1_250_001}," in (tmp_path / "again.csv").read_text()


def test_dates_are_time(tmp_path):
    rows = "".join(f"2024-05-01T12:00:00.{k * 10:03d}Z,{k}\n" for k in range(50))
    log = sr.read(written(tmp_path, "datetime,gz_dps\n" + rows))
    assert log.sample_rate_hz == pytest.approx(100.0)


def test_semicolons_decimal_commas_and_units_row(tmp_path):
    text = "sep=;\nt;gx;gy;gz\ns;deg/s;deg/s;deg/s\n" + "".join(f"0,{k:02d};{k},5;-{k},25;1,0\n" for k in range(20))
    log = sr.read(written(tmp_path, text))
    assert log.sample_rate_hz == pytest.approx(100.0)
    np.testing.assert_array_equal(log.rate_dps[4], [4.5, -4.25, 1.0])


def test_comments_blanks_and_a_mark_before_the_text(tmp_path):
    text = "\ufeff# logger 3\n# t_s gx_dps gy_dps\n" + "".join(f"  {k * 0.02:.2f}   {k}\t{-k}\n" for k in range(10))
    log = sr.read(written(tmp_path, text, "log.txt"))
    assert log.channels == ("gx_dps", "gy_dps") and log.sample_rate_hz == pytest.approx(50.0)


def test_without_time_a_rate_must_be_said(tmp_path):
    path = written(tmp_path, "gx_dps,gy_dps\n1,2\n3,4\n")
    with pytest.raises(sr.LogError, match="--rate"):
        sr.read(path)
    log = sr.read(path, rate_hz=200.0)
    np.testing.assert_array_equal(log.t_s, [0.0, 0.005])


def test_numbers_alone_are_one_channel_or_time_and_channels(tmp_path):
    one = sr.read(written(tmp_path, "1\n2\n3\n"), rate_hz=10.0)
    assert one.rate_dps.shape == (3, 1)
    two = sr.read(written(tmp_path, "0.0,5\n0.1,4\n0.2,5\n0.3,1\n", "two.csv"))
    assert two.sample_rate_hz == pytest.approx(10.0) and two.rate_dps[1, 0] == 4.0


def test_missing_values_are_nan_and_come_back_as_they_were(tmp_path):
    log = sr.read(written(tmp_path, "t_s,gz_dps,note\n0,1,a\n0.1,,b\n0.2,NaN,\n0.3,4,d\n"))
    assert np.isnan(log.rate_dps[1:3, 0]).all()
    sr.write(tmp_path / "again.csv", log)
    assert (tmp_path / "again.csv").read_text().splitlines()[2:4] == ["0.1,,b", "0.2,,"]


def test_gaps_repeats_and_jumps_back_are_kept_and_reported(tmp_path):
    stamps = np.arange(100) * 0.01
    stamps[50:] += 3.0
    stamps[20] = stamps[19]
    stamps[80] = stamps[70]
    log = sr.read(written(tmp_path, "t_s,gz_dps\n" + "".join(f"{t!r},1\n" for t in stamps.tolist())))
    np.testing.assert_array_equal(log.t_s, stamps)
    assert 50 in log.timing.gaps and log.timing.repeats == (20,) and log.timing.backward == (80,)
    assert log.sample_rate_hz == pytest.approx(100.0)
    assert any("backward" in remark for remark in log.timing.remarks())
    steps = log.steps_s()
    assert steps is not None and steps[1] == 1.0 / log.sample_rate_hz and steps[50] == pytest.approx(3.01)


def test_the_measured_axes_win_over_truth_and_raw_copies(tmp_path):
    log = sr.read(written(tmp_path, table("t_s,gx_dps_raw,gx_dps,gx_true_dps,gy_dps,gy_dps_raw")))
    assert log.channels == ("gx_dps", "gy_dps")
    assert set(log.columns) == {"gx_dps_raw", "gx_true_dps", "gy_dps_raw"}


def test_unknown_layouts_say_what_was_found(tmp_path):
    path = written(tmp_path, table("t_s,alpha,beta,gamma,delta"))
    with pytest.raises(sr.LogError, match=r"no gyro column among .*alpha, beta.*--columns"):
        sr.read(path)
    with pytest.raises(sr.LogError, match="did you mean 'gamma'"):
        sr.read(path, columns=["gama"])
    assert sr.read(path, columns=["gamma"], unit="rad/s").rate_dps[0, 0] == pytest.approx(3 * RAD)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "empty"),
        (b"\n\n\n", "no line"),
        (b"t_s,gx_dps\n", "no samples"),
        (b"t_s,gx_dps,gy_dps\n0,1,2\n0.1,2\n0.2,1,2\n0.3,1,2\n", "line 3 has 2 fields"),
        (b"t_s,gx_dps\n0,1\n0.1,x7\n0.2,3\n", "line 3: 'x7' in gx_dps is no number"),
        (bytes(range(256)) * 40, "zero"),
        (b"t_s,gx_dps\n0,\n1,\n2,\n", "every sample is missing"),
        ("t_s,gx\n0,1\n".encode("utf-16"), "UTF-16"),
        (b"t_s,gx_dps\n" + b"0,1\n" * 100000 + b"\0" * 4096, "line 100002 holds binary zeros"),
    ],
)
def test_damaged_tables_are_refused_in_one_line(tmp_path, content, says):
    path = written(tmp_path, content)
    with pytest.raises(sr.LogError) as caught:
        sr.read(path)
    assert says in str(caught.value) and str(path) in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("suffix", [".csv", ".tsv", ".npz", ".parquet"])
def test_every_format_writes_back_all_columns(tmp_path, suffix):
    if suffix == ".parquet":
        pytest.importorskip("polars")
    log = sr.read(written(tmp_path, "time_us,gx_rad_s,word,count\n0,0.5,a b,3\n10000,1.5,c,4\n20000,,d,5\n"))
    sr.write(tmp_path / f"out{suffix}", log)
    again = sr.read(tmp_path / f"out{suffix}")
    np.testing.assert_array_equal(again.rate_dps, log.rate_dps)
    np.testing.assert_array_equal(again.t_s, log.t_s)
    assert list(again.columns["word"]) == ["a b", "c", "d"] and list(again.columns["count"]) == [3, 4, 5]
    assert again.layout.order == log.layout.order
    with pytest.raises(FileExistsError):
        sr.write(tmp_path / f"out{suffix}", log)
    assert not [path for path in tmp_path.iterdir() if path.name.endswith(".part")]


def test_a_log_can_be_made_from_arrays(tmp_path):
    log = sr.Log(t_s=np.arange(10) / 5.0, rate_dps=np.ones((10, 2)), channels=("gx_dps", "gy_dps"))
    sr.write(tmp_path / "a.csv", log)
    assert (tmp_path / "a.csv").read_text().splitlines()[0] == "t_s,gx_dps,gy_dps"
    with pytest.raises(sr.LogError, match="do not fit"):
        sr.Log(t_s=np.arange(3.0), rate_dps=np.ones((10, 2)), channels=("a", "b"))


def test_pickled_arrays_are_refused(tmp_path):
    np.savez(tmp_path / "a.npz", gx_dps=np.array([{"a": 1}, None], dtype=object))
    with pytest.raises(sr.LogError):
        sr.read(tmp_path / "a.npz")


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.floats(-1e6, 1e6), st.integers(-(2**62), 2**62)), min_size=2, max_size=40),
    st.sampled_from(",;\t|"),
)
def test_numbers_survive_a_round_trip(tmp_path_factory, rows, delimiter):
    folder = tmp_path_factory.mktemp("round")
    lines = [delimiter.join(["t_s", "gz_dps", "count"])]
    lines += [delimiter.join([repr(k * 0.01), repr(rate), str(count)]) for k, (rate, count) in enumerate(rows)]
    log = sr.read(written(folder, "\n".join(lines)))
    sr.write(folder / "b.csv", log)
    again = sr.read(folder / "b.csv")
    np.testing.assert_array_equal(again.rate_dps[:, 0], [rate for rate, _ in rows])
    assert list(again.columns["count"]) == [count for _, count in rows]


@settings(max_examples=150, deadline=None)
@given(st.binary(max_size=400), st.sampled_from([".csv", ".npz", ".parquet"]))
def test_no_file_does_worse_than_a_log_error(tmp_path_factory, content, suffix):
    path = tmp_path_factory.mktemp("junk") / f"junk{suffix}"
    path.write_bytes(content)
    try:
        sr.read(path, rate_hz=10.0)
    except sr.LogError as error:
        assert "\n" not in str(error)


@needed
@pytest.mark.parametrize(
    ("file", "recording"),
    [
        ("data_ngimu_sensors.csv", "fmt_ngimu"),
        ("data_xio3_Inertial.csv", "fmt_xio3"),
        ("xio_sensor_data.csv", "xio_fusion"),
        ("ains_ahrs_imu.parquet", "vessel_sim_smsfusion"),
        ("sample_appended_multiple.ulg", "ulog_sample_appended_multiple"),
        ("xio_imu.mcap", "xio_fusion"),
        ("xio_rosbag2", "xio_fusion"),
        ("btfl_001.bbl", "bbl_btfl_001"),
    ],
)
def test_files_of_real_loggers_agree_with_their_recordings(file, recording):
    pytest.importorskip("polars")
    pytest.importorskip("pyulog")
    pytest.importorskip("rosbags")
    log = sr.read(FORMATS / file)
    with np.load(RECORDINGS / f"{recording}.npz") as known:
        expected = np.column_stack([known[f"g{axis}_dps"] for axis in "xyz"])[: len(log)]
        np.testing.assert_allclose(log.t_s, known["t_s"][: len(log)], atol=1e-9)
        meta = json.loads(str(known["meta_json"]))
    # The recordings are single precision.
    np.testing.assert_allclose(log.rate_dps, expected, rtol=1.2e-7, atol=1e-12)
    assert log.sample_rate_hz == pytest.approx(meta["stats"]["fs_mean"], rel=0.01)


def test_hdf5_and_matlab_files_are_read(tmp_path):
    h5py, matlab = pytest.importorskip("h5py"), pytest.importorskip("scipy.io")
    t, rates = np.arange(100) / 50.0, np.random.default_rng(2).normal(size=(100, 3))
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["imu/time_s"], file["imu/gyro_rad_s"] = t, rates
    matlab.savemat(tmp_path / "a.mat", {"t": t[:, None], "imu": {"gyr_dps": rates * RAD}})
    for name in ("a.h5", "a.mat"):
        log = sr.read(tmp_path / name)
        assert log.sample_rate_hz == pytest.approx(50.0), name
        np.testing.assert_allclose(log.rate_dps, rates * RAD, rtol=1e-12)


def test_a_folder_that_is_not_there_is_named_when_writing(tmp_path):
    log = demo.wave_log(demo.runs())
    with pytest.raises(FileNotFoundError, match="nowhere"):
        sr.write(tmp_path / "nowhere" / "log.csv", log)
    assert not (tmp_path / "nowhere").exists()
