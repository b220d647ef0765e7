"""The table of a method's settings, from the class that checks them: its fields, its words and its defaults."""

from __future__ import annotations

import dataclasses
import math
import re
from typing import Any

from docutils import nodes
from sphinx.util.docutils import SphinxDirective
from stillrate import GyroNoise, _native, methods
from stillrate.config import Config

RATE_HZ = 50.0
NOISE = GyroNoise(density_dps_sqrt_hz=0.0151, rate_random_walk_dps_sqrt_s=0.0033)


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx."""
    app.add_directive("settings", Settings)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def words(cls: type[Config]) -> dict[str, str]:
    """Return what the class says of each setting, from the parameters of its docstring."""
    section = (cls.__doc__ or "").partition("Parameters\n    ----------\n")[2]
    found: dict[str, str] = {}
    names: list[str] = []
    for line in section.split("\n"):
        if re.match(r"^    \S", line):
            names = [name.strip() for name in line.partition(":")[0].split(",")]
        elif line.strip():
            for name in names:
                found[name] = f"{found.get(name, '')} {line.strip()}".strip()
    return found


def rows(cls: type[Config]) -> list[tuple[str, str, str, str]]:
    """Return name, default, range and words of every setting of a method, the ones all share first."""
    config = cls(sample_rate_hz=RATE_HZ, noise=NOISE)
    said = {**words(Config), **words(cls)}
    table = []
    for item in dataclasses.fields(cls):
        value = getattr(config, item.name)
        shown = (
            "must be given" if item.name in ("sample_rate_hz", "noise") else _shown(value)
        )
        if item.name not in said:
            raise ValueError(f"{cls.__name__}.{item.name} has no words in the docstring")
        table.append((item.name, shown, allowed(cls, item.name), said[item.name]))
    return table


def allowed(cls: type[Config], name: str) -> str:
    """Return the range of a setting in words, from the table that checks it."""
    found = _native.setting_range(
        cls.method, "noise.density_dps_sqrt_hz" if name == "noise" else name
    )
    if found is None:
        return ""
    _, _, words, unit = found
    return f"{words} {unit}".strip()


def _shown(value: object) -> str:
    if isinstance(value, float):
        return "inf" if math.isinf(value) else f"{value:.6g}"
    if isinstance(value, (tuple, list)):
        return "(" + ", ".join(_shown(part) for part in value) + ")"
    return f'"{value}"' if isinstance(value, str) else str(value)


class Settings(SphinxDirective):
    """``{settings} CLASS``: the table."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Build the table."""
        head = ("setting", f"default at {RATE_HZ:g} Hz", "range", "meaning")
        table = nodes.table(classes=["settings"])
        group = nodes.tgroup(cols=len(head))
        table += group
        for width in (22, 15, 18, 45):
            group += nodes.colspec(colwidth=width)
        group += nodes.thead("", self._row([nodes.Text(title) for title in head]))
        body = nodes.tbody()
        group += body
        for name, default, bounds, meaning in rows(getattr(methods, self.arguments[0])):
            parsed, _ = self.parse_inline(meaning.replace("``", "`"))
            paragraph = nodes.paragraph("", "", *parsed)
            body += self._row(
                [
                    nodes.literal(text=name),
                    nodes.literal(text=default),
                    nodes.Text(bounds),
                    paragraph,
                ]
            )
        return [table]

    def _row(self, cells: list[nodes.Node]) -> nodes.row:
        row = nodes.row()
        for cell in cells:
            inner = (
                cell if isinstance(cell, nodes.paragraph) else nodes.paragraph("", "", cell)
            )
            row += nodes.entry("", inner)
        return row
