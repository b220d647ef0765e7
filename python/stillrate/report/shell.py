"""What all pages share: one HTML file with its style, its data and its scripts inside, and nothing from elsewhere.

A page with scripts is made by `assemble`, one that shows all it has at once by `still_page`.
"""

from __future__ import annotations

import html
import json
import platform
from collections.abc import Sequence
from importlib import resources
from string import Template
from typing import Any

import numpy as np

from stillrate import __version__


def asset(name: str, package: str = "stillrate.report") -> str:
    """Return a file that lies beside this module, or in another package."""
    return resources.files(package).joinpath(name).read_text(encoding="utf-8")


def as_json(data: Any) -> str:
    """Return data as a page holds it."""
    return json.dumps(data, separators=(",", ":"), allow_nan=False)


def assemble(
    *,
    title: str,
    lead: str,
    body: str,
    parts: dict[str, str],
    data: str,
    scripts: Sequence[str],
    styles: Sequence[str] = ("page.css",),
) -> str:
    """Return a page.

    Parameters
    ----------
    title, lead : str
        Words, as yet unescaped.
    body : str
        Name of the template of what is between them and the foot.
    parts : dict
        What the template asks for, as HTML.
    data : str
        What `as_json` gave.
    scripts, styles : sequence of str
        Names of files, in order.
    """
    return Template(asset("shell.html")).substitute(
        title=html.escape(title),
        lead=html.escape(lead),
        body=Template(asset(body)).substitute(parts),
        css="\n".join(asset(name) for name in styles),
        versions=html.escape(f"stillrate {__version__}, numpy {np.__version__}, Python {platform.python_version()}"),
        data=data.replace("</", "<\\/"),
        script="\n".join(asset(name) for name in scripts),
    )


def still_page(title: str, body: str, *, css: str = "") -> str:
    """Return a page without scripts.

    Parameters
    ----------
    title : str
        Words, as yet unescaped.
    body : str
        What stands on the page, as HTML.
    css : str
        Style beyond that of all such pages.
    """
    return Template(asset("still.html")).substitute(
        title=html.escape(title),
        body=body,
        css=asset("still.css") + css,
        version=html.escape(f"stillrate {__version__}"),
    )


def table(head: Sequence[str], rows: Sequence[Sequence[str]], kind: str = "") -> str:
    """Return a table; the cells are HTML already."""
    top = "".join(f"<th>{html.escape(name)}</th>" for name in head)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    style = f' class="{kind}"' if kind else ""
    return f"<table{style}><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"
