"""The rerun viewer, where it is installed: raw and clean curves as they come."""

from __future__ import annotations

import collections
import importlib
import threading
from types import TracebackType
from typing import Any, Self

import numpy as np

from stillrate.errors import LogError
from stillrate.io.safely import first_line

_EVERY_S = 0.1
_KEPT = 1 << 16


class Rerun:
    """Hands samples over to the rerun viewer, ten times a second, from a thread of its own.

    Parameters
    ----------
    path : str, optional
        Record into a file instead of opening the viewer.

    Raises
    ------
    LogError
        If rerun is not installed.
    """

    def __init__(self, path: str | None = None) -> None:
        self._rerun = _module()
        self._stream: Any = self._rerun.RecordingStream("stillrate live")
        try:
            if path is None:
                self._stream.spawn()
            else:
                self._stream.save(path)
        except (OSError, RuntimeError) as error:
            raise LogError(f"the rerun viewer does not start ({first_line(error)})") from None
        self._samples: collections.deque[tuple[int, tuple[float, ...], tuple[float, ...]]]
        self._samples = collections.deque(maxlen=_KEPT)
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._work, name="rerun", daemon=True)

    def sample(self, arrived_ns: int, raw: tuple[float, ...], clean: tuple[float, ...]) -> None:
        """Take a sample; the oldest is forgotten if the viewer does not keep up."""
        self._samples.append((arrived_ns, raw, clean))

    def __enter__(self) -> Self:
        """Start handing over."""
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Hand over the rest."""
        self._done.set()
        self._thread.join()

    def _work(self) -> None:
        while not self._done.wait(_EVERY_S):
            self._hand_over()
        self._hand_over()
        self._stream.flush()

    def _hand_over(self) -> None:
        taken = [self._samples.popleft() for _ in range(len(self._samples))]
        if not taken:
            return
        times = self._rerun.TimeColumn("time", timestamp=np.array([at for at, _, _ in taken]).astype("datetime64[ns]"))
        for kind, which in (("raw", 1), ("clean", 2)):
            table = np.array([row[which] for row in taken], dtype=np.float64)
            for channel in range(table.shape[1]):
                self._stream.send_columns(
                    f"channel_{channel + 1}/{kind}",
                    indexes=[times],
                    columns=self._rerun.Scalars.columns(scalars=table[:, channel]),
                )


def _module() -> Any:
    """Import rerun-sdk; another package bears the same name."""
    try:
        module = importlib.import_module("rerun")
    except ImportError:
        module = None
    if not hasattr(module, "RecordingStream"):
        raise LogError("the viewer needs rerun: pip install 'stillrate[viewer]'")
    return module
