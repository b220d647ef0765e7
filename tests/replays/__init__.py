"""Replays of reference outputs through the public API, one module a family."""
