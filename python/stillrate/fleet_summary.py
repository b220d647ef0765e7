"""What became of the logs of a fleet, as one table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from stillrate.fleet_work import Record
from stillrate.io.safely import atomic


def write_summary(path: Path, records: Sequence[Record]) -> None:
    """Write one row a channel and one for each broken log; leave the file alone if it says the same."""
    import polars

    text, count, figure = polars.String, polars.Int64, polars.Float64
    schema = {
        "log": text,
        "status": text,
        "reason": text,
        "channel": text,
        "samples": count,
        "method": text,
        "sample_rate_hz": figure,
        "noise_density_dps_sqrt_hz": figure,
        "quiet_before_dps": figure,
        "quiet_after_dps": figure,
        "removed_dps": figure,
        "in_motion": polars.Boolean,
        "missing": count,
        "saturated": count,
        "bad_time": count,
        "notes": text,
        "fingerprint": text,
    }
    rows: list[dict[str, Any]] = []
    for record in records:
        common = {
            "log": record.name,
            "status": "broken" if record.broken else "done",
            "reason": record.reason or None,
            "samples": None if record.broken else record.samples,
            "sample_rate_hz": None if record.broken else record.sample_rate_hz,
            "notes": "; ".join(record.notes) or None,
            "fingerprint": record.fingerprint or None,
        }
        rows += [{**common, **channel} for channel in record.channels] or [common]
    table = polars.DataFrame([{name: row.get(name) for name in schema} for row in rows], schema=schema)
    try:
        if path.exists() and polars.read_parquet(path).equals(table):
            return
    except Exception:  # a damaged summary is written anew
        pass
    with atomic(path, force=True) as temporary:
        table.write_parquet(temporary)
