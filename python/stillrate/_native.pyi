"""The compiled half: `stillrate` and `stillrate-lab` over arrays."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, TypedDict, TypeVar, final, overload

import numpy as np
import numpy.typing as npt

from stillrate.config import Config
from stillrate.results import Trace

__version__: str

_Floats = npt.NDArray[np.float64]
_Settings = dict[str, float | str | list[float]]
_Sample = float | np.floating[Any] | np.integer[Any] | None
_Row = tuple[float, ...]
_Array = npt.NDArray[Any] | Sequence[_Sample] | Sequence[Sequence[_Sample]]
_Container = TypeVar("_Container")

@final
class Filter:
    """A filter with its channels: one class for every method."""

    channels: int
    dtype: str

    def __new__(cls, config: Config, channels: int = 1, dtype: npt.DTypeLike | None = None) -> Filter: ...
    @property
    def config(self) -> Config: ...
    @property
    def models(self) -> int: ...
    @property
    def estimate(self) -> Any: ...  # an Estimate with one channel, a tuple of them with more
    @overload
    def update(self, value: _Sample, *, dt_s: float | None = None) -> float: ...
    @overload
    def update(self, value: _Sample, second: _Sample, *others: _Sample, dt_s: float | None = None) -> _Row: ...
    @overload
    def update(self, value: Sequence[_Sample] | npt.NDArray[Any], *, dt_s: float | None = None) -> _Row: ...
    @overload
    def run(
        self,
        samples: _Array,
        dt_s: Any | None = None,
        trace: Literal[False] = False,
        out: npt.NDArray[Any] | None = None,
    ) -> npt.NDArray[Any]: ...
    @overload
    def run(
        self,
        samples: _Container,
        dt_s: Any | None = None,
        trace: Literal[False] = False,
        out: None = None,
    ) -> _Container: ...
    @overload
    def run(
        self, samples: Any, dt_s: Any | None = None, *, trace: Literal[True], out: npt.NDArray[Any] | None = None
    ) -> Trace: ...
    def reset(self) -> None: ...
    def save(self) -> bytes: ...
    @staticmethod
    def restore(blob: bytes) -> Filter: ...
    def copy(self) -> Filter: ...

def resolve(method: str, settings: _Settings) -> dict[str, Any]: ...
def setting_range(method: str, name: str) -> tuple[float, float, str, str] | None: ...
def method_names() -> list[str]: ...
def singer_coefficients(alpha_per_s: float, dt_s: float, single: bool) -> tuple[float, float, float, float, float]: ...

class _Delimited(TypedDict):
    names: list[str]
    columns: list[npt.NDArray[Any] | list[str]]
    named: bool
    delimiter: str
    decimal_comma: bool
    preamble: list[str]
    first_row_line: int
    missing_word: str | None

class _Timebase(TypedDict):
    sample_rate_hz: float
    median_step_s: float
    longest_step_s: float
    gaps: list[int]
    repeats: list[int]
    backward: list[int]
    missing: list[int]
    regular: bool

class _Effect(TypedDict):
    start: int
    stop: int
    before: float
    after: float
    removed: float

class _Flight(TypedDict):
    firmware: str
    time_us: npt.NDArray[np.int64]
    names: list[str]
    columns: list[npt.NDArray[np.float64 | np.int32 | np.uint32]]
    damaged_places: int
    ended: bool
    full: bool

def read_blackbox(bytes: bytes) -> tuple[_Flight | None, int, list[str]]: ...
def read_delimited(path: str | Path) -> _Delimited: ...
def write_delimited(
    path: str | Path,
    columns: Sequence[npt.NDArray[Any] | list[str]],
    *,
    delimiter: str,
    decimal_comma: bool,
    preamble: list[str],
    header: list[str] | None,
    missing_word: str,
) -> None: ...
def analyse_timebase(t_s: _Floats) -> _Timebase: ...
def time_steps(t_s: _Floats, sample_rate_hz: float) -> _Floats: ...
def welch(samples: _Floats, sample_rate_hz: float, segment: int) -> tuple[_Floats, _Floats]: ...
def filter_effect(raw: _Floats, filtered: _Floats, window: int) -> _Effect: ...

@final
class RateTableModel:
    """A rate-table error curve over rates and temperatures."""

    @staticmethod
    def from_text(text: str) -> RateTableModel: ...
    @staticmethod
    def from_network(
        inputs: int,
        hidden: int,
        linear: bool,
        parameters: list[float],
        input_scaling: list[tuple[float, float]],
        output_scaling: tuple[float, float],
    ) -> RateTableModel: ...
    def to_text(self) -> str: ...
    def with_sample_rate(self, sample_rate_hz: float) -> RateTableModel: ...
    def error(self, rates: _Floats, temperatures: _Floats | None) -> tuple[_Floats, npt.NDArray[np.bool_]]: ...
    def correct(self, rates: _Floats, temperatures: _Floats | None) -> tuple[_Floats, npt.NDArray[np.bool_]]: ...
    def slope(self, rates: _Floats, temperatures: _Floats | None) -> tuple[_Floats, npt.NDArray[np.bool_]]: ...
    def score(self, measured: _Floats, truth: _Floats, temperatures: _Floats | None) -> tuple[float, float, float]: ...
    def steepest(self) -> float: ...
    def guard(self, limit: float) -> None: ...
    def facts(self) -> dict[str, Any]: ...

@final
class NoiseObjective:
    """Records and the objective over log10(Q/R)."""

    def __new__(
        cls,
        measured: list[_Floats],
        truth: list[_Floats] | None,
        model: str,
        criterion: str,
        period_s: float,
    ) -> NoiseObjective: ...
    def moving(self) -> bool: ...
    def range(self) -> tuple[float, float]: ...
    def values(self, points: _Floats, dimensions: int) -> _Floats: ...
    def finish(self, point: list[float], value: float, evaluations: int) -> dict[str, Any]: ...

def network_evaluate(
    inputs: int, hidden: int, linear: bool, parameters: _Floats, rows: _Floats
) -> dict[str, _Floats]: ...
def network_step(
    inputs: int,
    hidden: int,
    linear: bool,
    parameters: _Floats,
    rows: _Floats,
    targets: _Floats,
    decay: float,
    mask: _Floats | None,
    damping: float,
) -> dict[str, Any]: ...
def network_train(
    inputs: int,
    hidden: int,
    linear: bool,
    rows: _Floats,
    targets: _Floats,
    decay: float,
    epochs: int,
    patience: int,
    seed: int,
) -> tuple[_Floats, int, list[float]]: ...
def uniforms(seed: int, count: int) -> _Floats: ...
def minimise_callable(
    objective: Any, lower: list[float], upper: list[float], method: str, options: dict[str, Any], progress: Any
) -> tuple[list[float], float, int]: ...
def qpso_trace(
    objective: Any, lower: list[float], upper: list[float], options: dict[str, Any], uniforms: list[float]
) -> list[dict[str, Any]]: ...
def kalman_random_walk(
    measured: _Floats,
    process_noise: float,
    measurement_variance: float,
    start_rate: float,
    start_variance: float,
) -> tuple[_Floats, _Floats, _Floats]: ...
def kalman_score(
    measured: _Floats,
    process_noise: float,
    measurement_variance: float,
    start_rate: float,
    start_variance: float,
) -> tuple[float, float, float]: ...
def kalman_track(measured: _Floats, model: str, log10_ratio: float, period_s: float) -> _Floats: ...
def compare_rates(estimate: _Floats, truth: _Floats) -> tuple[float, float]: ...
def export_c(method: str, settings: dict[str, Any], single: bool) -> tuple[str, str, str, str]: ...
def tune_noise(
    objective: NoiseObjective, method: str, options: dict[str, Any], separate: bool, progress: Any
) -> dict[str, Any]: ...
def tune_bank(objective: NoiseObjective, progress: Any) -> tuple[float, float, float, int]: ...
def rate_table_fit(
    measured: _Floats,
    truth: _Floats,
    temperature: _Floats | None,
    segments: list[tuple[int, int]] | None,
    candidates: list[str] | None,
    slope_limit: float,
    seed: int,
) -> dict[str, Any]: ...
def rate_table_fit_points(
    rates: list[float],
    errors: list[float],
    standard_errors: list[float],
    temperatures: list[float] | None,
    candidates: list[str] | None,
    slope_limit: float,
    seed: int,
) -> dict[str, Any]: ...
def rate_table_plateaus(
    measured: _Floats, rates: list[float], sample_rate_hz: float
) -> list[tuple[int, int, float]]: ...
def rate_table_motions() -> tuple[list[str], list[str]]: ...
def rate_table_unit(seed: int) -> tuple[float, list[float], float, float]: ...
def rate_table_record(truth: list[float], unit: int, seed: int, sample_rate_hz: float) -> _Floats: ...
def rate_table_calibration(unit: int, seed: int, rates: int, seconds: float) -> tuple[_Floats, _Floats]: ...
def rate_table_published(unit: int, seed: int) -> list[tuple[_Floats, _Floats]]: ...
def rate_table_table3(unit: int, seed: int, epochs: int) -> dict[str, Any]: ...
def rate_table_study(unit: int, seed: int, published_epochs: int) -> dict[str, Any]: ...

_Polynomials = tuple[list[float], list[float]]
_Chain = list[tuple[str, dict[str, float | str | list[float]]]]
_Seeds = list[int]

def servo_variance(
    transfer: _Polynomials, time_s: float | None, band_rad_s: tuple[float, float] | None, algorithm: str
) -> float: ...
def servo_drift(
    rate_loop: _Polynomials | None,
    tracking: _Polynomials | None,
    filter: _Polynomials | None,
    position: str,
    dead_time_s: float,
    noise: tuple[float, float, float, float],
    time_s: float | None,
    band_rad_s: tuple[float, float] | None,
) -> tuple[float, float, float, float]: ...
def servo_plant(name: str, design: object | None = None) -> list[float]: ...
def servo_plant_fields() -> list[tuple[str, str, str]]: ...
def servo_run(
    setup: object,
    controller: object,
    filter: _Chain,
    base: object,
    gyro: object,
    times: tuple[float, float, float],
) -> dict[str, Any]: ...
def servo_open_loop(
    plant: object, base: object, voltage: _Floats, start: list[float], timing: tuple[float, int]
) -> _Floats: ...
def servo_families(
    sample_rate_hz: float, density: float, walk: float | None
) -> list[tuple[str, _Chain, list[tuple[int, str, float, float, bool]], bool]]: ...
def servo_tune(
    bench: object,
    family: object,
    budget_percent: float,
    effort: tuple[int, int, int],
    seeds: _Seeds,
    checks: _Seeds,
    starts: list[tuple[object, list[float]]],
    progress: object | None,
) -> dict[str, Any]: ...
def servo_validate(
    bench: object, family: object, controller: object, parameters: list[float], seeds: _Seeds, margins: int
) -> dict[str, Any]: ...
def servo_tilt_table(
    bench: object,
    family: object,
    controller: object,
    parameters: list[float],
    tilts_deg: list[float],
    duration_s: float,
    seeds: _Seeds,
) -> list[float]: ...
def servo_integration_error(
    bench: object,
    family: object,
    parameters: list[float],
    motion: tuple[float, float],
    duration_s: float,
    seeds: _Seeds,
) -> float: ...
def servo_describe(
    filter: _Chain,
    sample_rate_hz: float,
    frequency_hz: float,
    amplitudes_dps: list[float],
    noise_sigma_dps: float,
    run: tuple[int, int],
) -> list[tuple[float, float]]: ...

# Rotations, reference bias, observability, recursive filters.
def rotation_exp(vector: list[float]) -> _Floats: ...
def rotation_log(rows: list[list[float]]) -> _Floats: ...
def right_jacobian(vector: list[float]) -> _Floats: ...
def rotation_from_euler(euler: list[float]) -> _Floats: ...
def rotation_from_quaternion(wxyz: list[float]) -> _Floats: ...
def rotation_check(rows: list[list[float]], project: bool) -> _Floats: ...
def position_matrix(latitude: float, longitude: float) -> _Floats: ...
def inertial_attitude(latitude: float, longitude: float, rows: list[list[float]], elapsed_s: float) -> _Floats: ...
def relative_rotation(first: list[list[float]], second: list[list[float]]) -> _Floats: ...
def preintegrate(rates: list[list[float]], dt_s: list[float], bias: list[float]) -> tuple[_Floats, _Floats]: ...
def find_reference_bias(
    rates: list[list[float]],
    dt_s: list[float],
    fix_index: list[int],
    c_b_n: list[Any],
    latitude: list[float],
    longitude: list[float],
    method: str,
    options: dict[str, Any],
) -> dict[str, Any]: ...
def bench_imu_model(
    euler_rad: list[float], latitude_rad: float, gravity_m_s2: float
) -> tuple[_Floats, _Floats, list[str]]: ...
def analyse_observability(
    dynamics: list[list[list[float]]],
    measurement: list[list[list[float]]],
    duration_s: list[float],
    interval_s: float,
    measurement_sigma: list[float],
    prior_sigma: list[float],
    process_density: list[float],
) -> dict[str, Any]: ...
def closed_form(name: str, first: float, second: float = 0.0) -> float: ...
def order_2_gains(forgetting_factor: float, count: int) -> tuple[_Floats, _Floats]: ...
def fir_taps(window: str, length: float, cutoff: float) -> _Floats: ...
def recursive_responses() -> list[dict[str, Any]]: ...
def recursive_bench(seeds: list[int], tuning_seeds: list[int], draws: int) -> dict[str, Any]: ...
def two_fix_table(time_s: float, dt_s: float) -> list[tuple[str, str, list[float]]]: ...

@final
class NativeVectorRls:
    order: int
    def __new__(
        cls,
        order: int,
        forgetting_factor: float,
        initial_covariance: float,
        trace_max: float,
        single: bool,
    ) -> NativeVectorRls: ...
    def update(self, phi: list[float], y: float) -> tuple[float, float, int]: ...
    def run(self, phi: _Floats, y: _Floats) -> tuple[_Floats, _Floats, _Floats, npt.NDArray[np.uint32]]: ...
    def weights(self) -> _Floats: ...
    def covariance(self) -> _Floats: ...
    def reset(self) -> None: ...

# Allan deviation, noise, simulator, measures.
_ModelNumbers = tuple[float, float, float, float, float, float, float, int]

def allan_deviation(
    z: _Floats, sample_rate_hz: float, taus: str, per_decade: int, confidence: float
) -> dict[str, Any]: ...
def noise_from_log(
    channels: list[_Floats], sample_rate_hz: float
) -> tuple[list[dict[str, Any]], tuple[float, float]]: ...
def simulate_bed(
    kind: str,
    sample_rate_hz: float,
    seed: int,
    duration_s: float | None,
    waves_end_s: float | None,
    noise: _ModelNumbers | None,
    bound: bool,
) -> dict[str, Any]: ...
def simulate_gyro(
    motion_dps: _Floats, sample_rate_hz: float, seed: int, noise: _ModelNumbers
) -> tuple[_Floats, _Floats, _Floats]: ...
def best_at_rest(measured_dps: _Floats, sample_rate_hz: float, noise: _ModelNumbers) -> tuple[_Floats, _Floats]: ...
def rmse(estimate: _Floats, truth: _Floats) -> float: ...
def rms_about_mean(z: _Floats) -> float: ...
def nees_mean(estimate: _Floats, truth: _Floats, variance: _Floats) -> float: ...
def pit_variance(weights: _Floats, innovations: _Floats, variances: _Floats, models: int) -> float: ...
def lag_ms(estimate: _Floats, truth: _Floats, sample_rate_hz: float, max_lag_s: float) -> float: ...
def settling(
    estimate: _Floats, truth: _Floats, sample_rate_hz: float, start: int, end: int, band: float
) -> tuple[float, float]: ...

# Gimballed head.
_Rows = list[list[float]]
_Head = dict[str, Any]

def gimbal_names() -> list[str]: ...
def gimbal_calibrate(
    command: _Floats, samples: _Floats, dt_s: float, sigma_m_s2: float | None, method: str, settings: _Head
) -> dict[str, Any]: ...
def gimbal_bound(
    command: _Floats, dt_s: float, sigma_m_s2: float, half_window: int, skip_jumps: bool, settings: _Head
) -> dict[str, Any]: ...
def gimbal_trajectory(
    segments_deg_s: _Floats | None, segment_s: float, slew_deg_s2: float, interval_s: float, settings: _Head
) -> _Floats: ...
def gimbal_simulate(
    values: list[float],
    command: _Floats,
    dt_s: float,
    per_interval: int,
    disturbance: dict[str, float],
    seed: int,
    settings: _Head,
) -> _Floats: ...
def gimbal_draw(gyro_factor: float, seed: int) -> _Floats: ...
def gimbal_score(estimates: _Floats, truth: list[float], bound: _Floats, indices: list[int]) -> _Floats: ...
def gimbal_rotation(v: _Floats) -> _Rows: ...
def gimbal_axes(values: list[float], settings: _Head) -> tuple[list[_Rows], list[_Rows]]: ...
def gimbal_step(
    values: list[float], rotation: _Floats, command: _Floats, dt_s: float, settings: _Head
) -> tuple[_Rows, list[float], list[float], _Rows]: ...
def gimbal_output(
    values: list[float], rotation: _Floats, settings: _Head
) -> tuple[list[float], list[float], _Rows]: ...
def gimbal_sensitivity(
    values: list[float], command: _Floats, dt_s: float, epochs: list[int], settings: _Head
) -> list[tuple[list[float], _Rows]]: ...
def gimbal_convert(values: list[float], gauge: str, settings: _Head) -> list[float]: ...
def gimbal_study(
    method: str, start: str, seeds: _Seeds, options: dict[str, Any], settings: _Head
) -> list[dict[str, Any]]: ...
def gimbal_plan(
    segments_deg_s: _Floats | None,
    limits: tuple[float, float, float, float],
    effort: tuple[int, int, int],
    kappa_weight: float,
    sampling: tuple[int, float],
    settings: _Head,
) -> tuple[_Rows, list[float], list[float]]: ...
