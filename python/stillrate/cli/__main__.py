"""``python -m stillrate.cli``."""

from stillrate.cli import run

run()
