"""Every public item of the crates and of the package, and whether its page shows how it is used.

An item is a type, a trait, a function, a method or a macro. It is documented if it has a text of its own. A type or trait is shown if an
example that runs stands on its page; a function, method or macro if one names it, on the item itself or on the page of its type. Constants,
fields, variants and aliases need a text and no example.

In Python the same holds of every name that the package and its public modules offer, and of the public methods and
properties of their classes. Fields of a configuration or a result have their line in the class's text.

``python tests/public_items.py`` prints what is missing and ends with 1 if anything is; it needs the package.
"""

from __future__ import annotations

import inspect
import json
import os
import re
import subprocess
import sys
import types
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
CRATES = ("stillrate", "stillrate-lab")
# What stands behind the three marks of a block that rustdoc does not run.
NOT_RUN = ("ignore", "text", "compile_fail", "console", "toml", "c")


def blocks(docs: str | None) -> str:
    """Return the code of all blocks in a Rust item's text that rustdoc runs."""
    found = re.findall(r"^```([^\n]*)\n(.*?)^```", docs or "", flags=re.MULTILINE | re.DOTALL)
    return "\n".join(code for words, code in found if not any(word in NOT_RUN for word in re.split(r"[,\s]+", words)))


def shows(page: str, name: str) -> bool:
    """Whether there are examples that use a name, or any where there is no name to use."""
    return bool(page.strip()) and re.search(rf"(?<!\w){re.escape(name)}(?!\w)" if name else "", page) is not None


def described(crate: str, folder: Path) -> dict[str, Any]:
    """Return rustdoc's own description of a crate. The format is not yet promised to stay, so a stable compiler must be told to give it."""
    flags = ["--", "-Z", "unstable-options", "--output-format", "json"]
    command = ["cargo", "rustdoc", "--quiet", "--package", crate, "--lib", *flags]
    environment = os.environ | {"RUSTC_BOOTSTRAP": "1", "CARGO_TARGET_DIR": str(folder)}
    subprocess.run(command, cwd=ROOT, env=environment, check=True, stderr=subprocess.DEVNULL)
    description: dict[str, Any] = json.loads((folder / "doc" / f"{crate.replace('-', '_')}.json").read_text())
    return description


class Crate:
    """The public items of one crate."""

    def __init__(self, description: dict[str, Any]) -> None:
        self.index = description["index"]
        self.seen: set[int] = set()
        self.undocumented: list[str] = []
        self.unshown: list[str] = []
        self.count = 0
        self.walk(description["root"])

    def item(self, identity: int) -> dict[str, Any] | None:
        return self.index.get(str(identity))

    def where(self, item: dict[str, Any]) -> str:
        span = item["span"]
        return f"{span['filename']}:{span['begin'][0]}" if span else "?"

    def judge(self, item: dict[str, Any], page: str, name: str = "") -> None:
        self.count += 1
        if not item["docs"]:
            self.undocumented.append(f"{self.where(item)} {item['name']}")
        if not shows(page, name):
            self.unshown.append(f"{self.where(item)} {item['name']}")

    def walk(self, identity: int) -> None:
        item = self.item(identity)
        if item is None or identity in self.seen or item["crate_id"] != 0:
            return
        self.seen.add(identity)
        (kind, inner), *_ = item["inner"].items()
        if kind == "use":
            if inner["id"] is not None:
                self.walk(inner["id"])
        elif kind == "module":
            for child in inner["items"]:
                self.walk(child)
        elif kind in ("struct", "enum", "union"):
            self.type_page(item, inner)
        elif kind == "trait":
            children = [child for child in map(self.item, inner["items"]) if child and "function" in child["inner"]]
            page = "\n".join(blocks(i["docs"]) for i in [item, *children])
            self.judge(item, page)
            for each in children:
                self.judge(each, page, each["name"])
        elif kind in ("function", "macro", "proc_macro"):
            self.judge(item, blocks(item["docs"]), item["name"])

    def type_page(self, item: dict[str, Any], inner: dict[str, Any]) -> None:
        own = [self.item(i) for i in inner["impls"]]
        inherent = [i["inner"]["impl"] for i in own if i and i["inner"]["impl"]["trait"] is None]
        children = [self.item(child) for implementation in inherent for child in implementation["items"]]
        methods = [c for c in children if c and "function" in c["inner"] and c["visibility"] == "public"]
        page = "\n".join(blocks(i["docs"]) for i in [item, *methods])
        self.judge(item, page)
        for method in methods:
            self.judge(method, page, method["name"])


def examples(docs: str | None) -> str:
    """Return the lines of all examples in a docstring."""
    return "\n".join(line for line in (docs or "").splitlines() if line.lstrip().startswith((">>>", "...")))


class Package:
    """The public items of the Python package."""

    def __init__(self) -> None:
        import stillrate
        import stillrate.live
        import stillrate.report

        self.seen: set[int] = set()
        self.undocumented: list[str] = []
        self.unshown: list[str] = []
        self.count = 0
        for module in (stillrate, stillrate.live, stillrate.report):
            self.module(module)

    def module(self, module: types.ModuleType) -> None:
        own = [name for name, item in vars(module).items() if getattr(item, "__module__", None) == module.__name__]
        for name in getattr(module, "__all__", [name for name in own if not name.startswith("_")]):
            item = getattr(module, name)
            if isinstance(item, types.ModuleType):
                self.module(item)
            elif (inspect.isclass(item) or inspect.isroutine(item)) and id(item) not in self.seen:
                self.seen.add(id(item))
                where = f"{item.__module__}.{name}"
                children = dict(self.methods(item)) if inspect.isclass(item) else {}
                page = "\n".join(examples(inspect.getdoc(i)) for i in [item, *children.values()])
                self.judge(where, item, page, "" if inspect.isclass(item) else name)
                for child, member in children.items():
                    self.judge(f"{where}.{child}", member, page, child)

    def methods(self, kind: type) -> list[tuple[str, Any]]:
        found = []
        for name, member in vars(kind).items():
            function = getattr(member, "__func__", member)
            if name.startswith("_") or not (inspect.isroutine(function) or inspect.isdatadescriptor(function)):
                continue
            if isinstance(function, types.MemberDescriptorType):  # a field that has a slot
                continue
            found.append((name, function))
        return found

    def judge(self, where: str, item: object, page: str, name: str) -> None:
        self.count += 1
        if not inspect.getdoc(item):
            self.undocumented.append(where)
        if not shows(page, name):
            self.unshown.append(where)


def report(name: str, found: Crate | Package) -> int:
    """Print what is missing in a crate or in the package, and return how much that is."""
    for line in sorted(found.undocumented):
        print(f"no docs: {line}")
    for line in sorted(found.unshown):
        print(f"no example: {line}")
    undocumented, unshown = len(found.undocumented), len(found.unshown)
    print(f"{name}: {found.count} public items, {undocumented} without docs, {unshown} without an example")
    return undocumented + unshown


def main() -> int:
    """Print what is missing."""
    missing = report("Python", Package())
    folder = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "public-items"
    for crate in CRATES:
        missing += report(crate, Crate(described(crate, folder)))
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
