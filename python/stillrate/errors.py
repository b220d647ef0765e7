"""The exceptions of the package."""

from __future__ import annotations


class ConfigError(ValueError):
    """A setting cannot be used; the text names field, value, unit and allowed range."""


class LogError(ValueError):
    """A log cannot be used; one sentence says which file, which sample, what to do."""
