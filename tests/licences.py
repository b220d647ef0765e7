"""Licences of everything that stillrate is built from or installed with, and whether each is one we may ship beside.

``python tests/licences.py`` prints the list. The Rust side is what ``Cargo.lock`` holds, development included; the Python side what the
extras of pyproject.toml pull in, as far as it is installed.
"""

from __future__ import annotations

import importlib.metadata
import json
import re
import subprocess
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]

# Permissive ones only: they ask for a notice at most.
ALLOWED = frozenset(
    [
        "0BSD",
        "Apache-2.0",
        "BSD-2-Clause",
        "BSD-3-Clause",
        "BSL-1.0",
        "CC0-1.0",
        "ISC",
        "MIT",
        "MIT-CMU",
        "PSF-2.0",
        "Unicode-3.0",
        "Unlicense",
        "Zlib",
    ]
)
# What metadata older than licence expressions say instead.
WORDS = {
    "MIT License": "MIT",
    "BSD License": "BSD-3-Clause",
    "BSD": "BSD-3-Clause",
    "BSD 3-Clause License": "BSD-3-Clause",
    "Apache Software License": "Apache-2.0",
    "Apache 2.0": "Apache-2.0",
    "Python Software Foundation License": "PSF-2.0",
    "any-OSI": "Zlib",  # apsw: any licence that the OSI approved, at the user's choice
}
# What a user installs with the library; the other extras are tools to work on it.
SHIPPED_EXTRAS = ("tables", "logs", "report", "fleet", "live", "viewer")


def is_allowed(expression: str) -> bool:
    """Tell whether an SPDX expression can be met by allowed licences alone. An exception (WITH) only grants more."""
    text = re.sub(r"\s+WITH\s+[\w.-]+", "", expression.replace("/", " OR "))
    words = re.findall(r"[()]|[\w.+-]+", text)
    # `and` and `or` bind as AND and OR do, so with every licence a truth the expression is Python's.
    plain = {"(": "(", ")": ")", "AND": "and", "OR": "or"}
    return bool(words) and bool(eval(" ".join(plain.get(word, str(word in ALLOWED)) for word in words)))


def of_crates() -> dict[str, str]:
    """Return the licence of every crate in Cargo.lock; an empty text where it gives none."""
    command = ["cargo", "metadata", "--format-version", "1", "--locked"]
    listed = json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout)
    return {f"{package['name']} {package['version']}": package["license"] or "" for package in listed["packages"]}


def _said_by(metadata: importlib.metadata.PackageMetadata) -> str:
    if expression := metadata.get("License-Expression"):
        return expression
    classifiers = [
        line.rsplit(" :: ", 1)[1] for line in metadata.get_all("Classifier") or [] if line.startswith("License")
    ]
    said = classifiers or [(metadata.get("License") or "").split("\n")[0]]
    return " OR ".join(WORDS.get(word, word.replace(" ", "-")) for word in said)


def _requirements() -> Iterator[str]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    yield from project["dependencies"]
    for extra in SHIPPED_EXTRAS:
        yield from project["optional-dependencies"][extra]


def of_python() -> dict[str, str]:
    """Return the licence of every installed package that stillrate or an extra of it pulls in."""
    found: dict[str, str] = {}
    waiting = list(_requirements())
    while waiting:
        name = re.match(r"[\w.-]+", waiting.pop())
        assert name is not None
        try:
            package = importlib.metadata.distribution(name[0])
        except importlib.metadata.PackageNotFoundError:
            continue
        key = f"{package.metadata['Name']} {package.version}"
        if key not in found:
            found[key] = _said_by(package.metadata)
            waiting += [line for line in package.requires or [] if "extra ==" not in line]
    return found


if __name__ == "__main__":
    for title, licences in (("Rust", of_crates()), ("Python", of_python())):
        print(f"{title}:")
        for package, licence in sorted(licences.items()):
            print(f"  {package:32s} {licence}{'' if is_allowed(licence) else '   NOT ALLOWED'}")
