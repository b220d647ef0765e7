"""The table of a method's settings, from the class that checks them: its fields, its words and its defaults."""

from __future__ import annotations

import dataclasses
import inspect
import math
import re
from typing import Any

from cells import table
from docutils import nodes
from sphinx.util.docutils import SphinxDirective
from stillrate import ConfigError, GyroNoise, methods
from stillrate.config import Config

RATE_HZ = 50.0
NOISE = GyroNoise(density_dps_sqrt_hz=0.0151, rate_random_walk_dps_sqrt_s=0.0033)


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx."""
    app.add_directive("settings", Settings)
    app.connect("autodoc-process-signature", _signature)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _signature(
    app: Any, what: str, name: str, obj: object, *_: object
) -> tuple[str, str] | None:
    """Show what a class takes: Sphinx would ask ``__new__``, which takes any name so as to suggest the nearest."""
    if not (isinstance(obj, type) and issubclass(obj, (Config, GyroNoise))):
        return None
    taken = list(inspect.signature(obj.__init__).parameters.values())[1:]
    found = (
        one.name if one.default is one.empty else f"{one.name}={one.default}"
        for one in taken
    )
    return f"(*, {', '.join(found)})", ""


def words(cls: type[Config]) -> dict[str, str]:
    """Return what the class says of each setting, from the parameters of its docstring."""
    section = (cls.__doc__ or "").partition("Parameters\n    ----------\n")[2]
    found: dict[str, str] = {}
    elsewhere = re.search(r"\n        As in `(\w+)`\.\n", section)
    others = words(getattr(methods, elsewhere[1])) if elsewhere else {}
    names: list[str] = []
    for line in section.split("\n"):
        if re.match(r"^    \S", line):
            names = [name.strip() for name in line.partition(":")[0].split(",")]
        elif line.strip():
            for name in names:
                found[name] = f"{found.get(name, '')} {line.strip()}".strip()
    return {
        name: others.get(name, text) if text.startswith("As in") else text
        for name, text in found.items()
    }


def _given(cls: type[Config], name: str) -> str:
    """Say whether a setting that all methods have is needed, and by which."""
    if name == "sample_rate_hz":
        return "must be given"
    louder = GyroNoise(density_dps_sqrt_hz=2.0 * NOISE.density_dps_sqrt_hz)
    one, other = (cls(sample_rate_hz=RATE_HZ, noise=noise) for noise in (NOISE, louder))
    guessed = cls(sample_rate_hz=RATE_HZ).noise is not None
    differs = one.replace(noise=None) != other.replace(noise=None)
    return "should be given" if guessed or differs else "not used"


def allowed(cls: type[Config], name: str, value: object) -> str:
    """Return what a setting may be, in the words with which the class refuses anything else."""
    wrong: Any = "?" if isinstance(value, str) else math.nan
    if isinstance(value, tuple):
        wrong = (math.nan,) * max(1, len(value))
    try:
        cls(**{"sample_rate_hz": RATE_HZ, "noise": NOISE, name: wrong})
    except ConfigError as error:
        found = re.search(r"\(must be (.+)\)$", str(error))
        if found:
            return found[1]
    raise ValueError(f"{cls.__name__}.{name}: nothing is refused")


def rows(cls: type[Config]) -> list[tuple[str, str, str]]:
    """Return name, default and words of every setting of a method, the ones all share first."""
    config = cls(sample_rate_hz=RATE_HZ, noise=NOISE)
    said = {**words(Config), **words(cls)}
    found = []
    for item in dataclasses.fields(cls):
        value = getattr(config, item.name)
        shown = _shown(value)
        if item.name in ("sample_rate_hz", "noise"):
            shown = _given(cls, item.name)
        if item.name not in said:
            raise ValueError(f"{cls.__name__}.{item.name} has no words in the docstring")
        meaning = said[item.name]
        if item.name != "noise":
            meaning += f" Must be {allowed(cls, item.name, value)}."
        elif shown == "not used":
            meaning = "The gyro's noise: this method does without."
        else:
            meaning = meaning.partition(" Methods that")[0]
        found.append((item.name, shown, meaning))
    return found


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
        head = ("setting", f"default at {RATE_HZ:g} Hz", "meaning")
        body = []
        for name, default, meaning in rows(getattr(methods, self.arguments[0])):
            parsed, _ = self.parse_inline(meaning.replace("``", "`"))
            words = default.endswith("given") or default == "not used"
            kind = nodes.emphasis if words else nodes.literal
            paragraph = nodes.paragraph("", "", *parsed)
            body.append((nodes.literal(text=name), kind(text=default), paragraph))
        return [table(head, body, (25, 20, 55), ("settings",))]
