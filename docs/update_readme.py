"""Put the demonstration's table and picture, as measured by this build, into the README."""

from __future__ import annotations

import re
import shutil
import tempfile
from pathlib import Path

from stillrate import demo
from stillrate.cli import main

ROOT = Path(__file__).parents[1]


def update() -> None:
    """Write the table between its marks and the picture beside the other documents."""
    readme = ROOT / "README.md"
    table = demo.markdown(demo.score(demo.runs()))
    text = re.sub(
        r"(<!-- demo-table -->\n).*?(<!-- /demo-table -->)",
        lambda found: found[1] + table + found[2],
        readme.read_text(encoding="utf-8"),
        flags=re.S,
    )
    readme.write_text(text, encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        main(["demo", "-o", folder])
        shutil.copy(
            Path(folder) / "before-after.png", ROOT / "docs/images/before-after.png"
        )


if __name__ == "__main__":
    update()
