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
def singer_coefficients(
    alpha_per_s: float, dt_s: float, single: bool
) -> tuple[float, float, float, float, float]: ...

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

# The other families are typed by the modules that wrap them.
def __getattr__(name: str) -> Any: ...
