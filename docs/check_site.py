"""Check a built site: no page asks another host for anything, every local address leads somewhere, no page is empty."""

from __future__ import annotations

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {
    "script": "src",
    "link": "href",
    "img": "src",
    "iframe": "src",
    "source": "src",
    "object": "data",
}
"""What a browser fetches by itself."""
_ELSEWHERE = re.compile(r"""(?:url\(\s*|@import\s+)["']?(?:https?:)?//""")


class _Page(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.linked: list[str] = []
        self.anchors: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        if "id" in given:
            self.anchors.add(given["id"])
        if tag in LOADED and LOADED[tag] in given:
            self.fetched.append(given[LOADED[tag]])
        if tag == "a" and "href" in given:
            self.linked.append(given["href"])


def problems(site: Path) -> list[str]:
    """Return what is wrong with a site, one line each."""
    pages: dict[Path, _Page] = {}
    for path in sorted(site.resolve().rglob("*.html")):
        pages[path] = _Page()
        pages[path].feed(path.read_text(encoding="utf-8"))
    found = [] if pages else [f"{site}: no page"]
    for path, page in pages.items():
        for address in page.fetched:
            parts = urlsplit(address)
            if parts.netloc or parts.scheme not in ("", "data"):
                found.append(f"{path}: fetches {address}")
        for address in page.fetched + page.linked:
            parts = urlsplit(address)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.is_file():
                found.append(f"{path}: leads nowhere: {address}")
            elif (
                parts.fragment
                and target in pages
                and parts.fragment not in pages[target].anchors
            ):
                found.append(f"{path}: no such place: {address}")
    for sheet in site.rglob("*.css"):
        if _ELSEWHERE.search(sheet.read_text(encoding="utf-8")):
            found.append(f"{sheet}: fetches from another host")
    return found


if __name__ == "__main__":
    wrong = problems(Path(sys.argv[1]))
    print("\n".join(wrong), file=sys.stderr)
    sys.exit(1 if wrong else 0)
