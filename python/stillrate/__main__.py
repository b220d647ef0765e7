"""``python -m stillrate``."""

from stillrate.cli import run

run()
