"""The compiled half: `stillrate` and `stillrate-lab` over arrays."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, TypedDict, final, overload

import numpy as np
import numpy.typing as npt

from stillrate.config import Config
from stillrate.results import Trace

__version__: str

_Floats = npt.NDArray[np.float64]
_Settings = dict[str, float | str | list[float]]

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
    def estimate(self) -> Any: ...
    def update(self, value: Any, *others: float, dt_s: float | None = None) -> Any: ...
    @overload
    def run(
        self,
        samples: Any,
        dt_s: Any | None = None,
        trace: Literal[False] = False,
        out: npt.NDArray[Any] | None = None,
    ) -> npt.NDArray[Any]: ...
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
def method_names() -> list[str]: ...

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
    effort: tuple[int, int, int, int],
    seeds: _Seeds,
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
