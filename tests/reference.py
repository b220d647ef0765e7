"""Replay a reference file: run the public API on its input and return the channels that the file answers."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

import numpy as np

# The folder of a reference file names its family; the module of the same name in `replays` knows the format.
FAMILIES = ("filters", "recursive", "rate_table", "self_calibration", "servo")


def replay(path: str | Path) -> dict[str, np.ndarray]:
    """Return every answer of the file as computed here, keyed by its path in the file joined by "/".

    A leading ``outputs/`` is dropped and null is NaN. The answers in the file are never looked at.
    """
    path = Path(path)
    document = json.loads(path.read_text(encoding="utf-8"))
    told = next((part for part in reversed(path.parts[:-1]) if part in FAMILIES), None)
    found = [told] if told else recognising(document)
    if not found:
        raise ValueError(f"{path}: of no known family ({', '.join(FAMILIES)})")
    return importlib.import_module(f"replays.{found[0]}").replay(path, document)


def recognising(document: Any) -> list[str]:
    """Return the families that take a document for theirs, for files outside their folders."""
    return [family for family in FAMILIES if importlib.import_module(f"replays.{family}").recognises(document)]
