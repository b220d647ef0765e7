"""Runs the blocks of each page while Sphinx reads it, and puts what they print and draw into the page.

``![words](run:NAME)`` shows a picture that a block of the page wrote; ``run-file:NAME`` in raw HTML is the address of
any other file that one wrote.
"""

from __future__ import annotations

import re
import shutil
import tempfile
from pathlib import Path
from typing import Any

from blocks import Block, Session, blocks

GENERATED = "generated"
EXTRA = "generated/extra"


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx."""
    app.connect("source-read", _read)
    return {"parallel_read_safe": False, "parallel_write_safe": True}


def _read(app: Any, document: str, source: list[str]) -> None:
    text = source[0]
    found = blocks(text)
    with tempfile.TemporaryDirectory() as folder:
        session = Session(Path(folder))
        printed = [session.run(block, document) for block in found]
        keep = _Keeper(Path(folder), Path(app.srcdir), document)
        text = _filled(text, found, printed)
        text = re.sub(r"\(run:([\w.-]+)\)", keep.picture, text)
        source[0] = re.sub(r"run-file:([\w./-]+)", keep.file, text)


def _filled(text: str, found: list[Block], printed: list[str]) -> str:
    lines = text.split("\n")
    for block, output in reversed(list(zip(found, printed, strict=True))):
        lexer = "sh" if block.language == "console" else block.language
        shown = (
            [] if "hidden" in block.options else [f"```{lexer}", *_visible(block), "```"]
        )
        if "output" in block.options:
            tidy = "\n".join(line.rstrip() for line in output.strip("\n").split("\n"))
            shown += ["", "{.printed}", "```text", tidy, "```"]
        if block.language != "" or "hidden" in block.options:
            lines[block.first : block.after] = shown
    return "\n".join(lines)


def _visible(block: Block) -> list[str]:
    """Leave out what rustdoc hides as well: lines that begin with a hash."""
    lines = block.code.split("\n")
    return (
        [line for line in lines if not line.startswith("# ")]
        if block.language == "rust"
        else lines
    )


class _Keeper:
    """Moves files that blocks wrote to where the site finds them."""

    def __init__(self, folder: Path, root: Path, document: str) -> None:
        self.folder, self.root, self.document = folder, root, document

    def picture(self, match: re.Match[str]) -> str:
        place = self.root / GENERATED / self.document
        place.mkdir(parents=True, exist_ok=True)
        shutil.copy(self.folder / match[1], place / match[1])
        return f"(/{GENERATED}/{self.document}/{match[1]})"

    def file(self, match: re.Match[str]) -> str:
        name = f"{self.document.replace('/', '-')}-{Path(match[1]).name}"
        place = self.root / EXTRA / "files"
        place.mkdir(parents=True, exist_ok=True)
        shutil.copy(self.folder / match[1], place / name)
        return "../" * self.document.count("/") + f"files/{name}"
