"""Filters from saved bytes, as a plain function: the one thing that a pickled filter calls."""

from __future__ import annotations

from stillrate._native import Filter


def restore(blob: bytes) -> Filter:
    """Return the filter that `Filter.save` wrote; the same as `Filter.restore`.

    Raises
    ------
    ConfigError
        If the bytes are damaged, of another version, or hold settings out of range.

    Examples
    --------
    >>> import stillrate as sr
    >>> flt = sr.Filter(sr.Pt1(sample_rate_hz=50.0), channels=2)
    >>> flt.update(0.12, -0.5)
    (0.12, -0.5)
    >>> [estimate.rate for estimate in restore(flt.save()).estimate]
    [0.12, -0.5]
    """
    return Filter.restore(blob)
