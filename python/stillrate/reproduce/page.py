"""The page of `stillrate reproduce`: every published figure beside ours. One HTML file, no script, no network."""

from __future__ import annotations

import html
from collections.abc import Sequence

from stillrate.report.shell import asset, still_page
from stillrate.reproduce.all import STUDIES, counts
from stillrate.reproduce.row import NOT_REPRODUCED, NOT_REPRODUCIBLE, REPRODUCED, Row

TITLE = "Published figures, computed again"
LEAD = (
    "Each row is a figure as published, ours, and the range that counts as the same. The verdict follows from our figure, "
    "that range and, where there is one, a bound of theory. Not reproducible: what is needed is not in the publication or not in the package, or no estimator can reach the figure."
)
SHORT = "Short form: fewer seeds and draws, so single verdicts may differ from those of the full form."
_CLASSES = {REPRODUCED: "yes", NOT_REPRODUCED: "no", NOT_REPRODUCIBLE: "cannot"}
_HEADS = ("quantity", "published", "ours", "accepted", "verdict", "why")


def render(rows: Sequence[Row], *, short: bool) -> str:
    """Return the page as text."""
    parts = [f"<h1>{TITLE}</h1><p>{LEAD}</p>", f"<p><b>{SHORT}</b></p>" if short else "", _summary(rows)]
    parts += [_study(name, [row for row in rows if row.study == name]) for name in dict.fromkeys(r.study for r in rows)]
    return still_page(TITLE, "\n".join(filter(None, parts)), css=asset("page.css", "stillrate.reproduce"))


def number(value: float | None) -> str:
    """Return our figure with four digits, as people write it."""
    if value is None:
        return "–"
    return f"{value:.4g}" if value == 0.0 or 1e-3 <= abs(value) < 1e6 else f"{value:.2e}"


def _summary(rows: Sequence[Row]) -> str:
    names = list(dict.fromkeys(row.study for row in rows))
    head = "".join(f"<th>{verdict}</th>" for verdict in _CLASSES)
    lines = []
    for name in names:
        found = counts([row for row in rows if row.study == name])
        cells = "".join(f"<td>{found[verdict] or '–'}</td>" for verdict in _CLASSES)
        lines.append(f'<tr><td><a href="#{name}">{html.escape(name)}</a></td>{cells}</tr>')
    total = counts(rows)
    cells = "".join(f"<td><b>{total[verdict]}</b></td>" for verdict in _CLASSES)
    return (
        f"<table class='sum'><tr><th>study</th>{head}</tr>{''.join(lines)}<tr><td><b>all</b></td>{cells}</tr></table>"
    )


def _study(name: str, rows: Sequence[Row]) -> str:
    head = "".join(f"<th>{word}</th>" for word in _HEADS)
    body = "".join(_line(row) for row in rows)
    summary = html.escape(STUDIES[name].summary)
    return (
        f'<h2 id="{name}">{html.escape(name)}</h2><p>{summary}</p>'
        f"<table class='rows'><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    )


def _line(row: Row) -> str:
    unit = f" {row.unit}" if row.unit else ""
    why = ". ".join(part for part in (row.reason, row.effort) if part)
    cells = (
        html.escape(row.quantity),
        html.escape(row.published),
        f"<b>{number(row.ours)}</b>{html.escape(unit) if row.ours is not None else ''}",
        html.escape(row.accepted),
        f"<span class='{_CLASSES[row.verdict]}'>{row.verdict}</span>",
        html.escape(why),
    )
    pairs = zip(_HEADS, cells, strict=True)
    return "<tr>" + "".join(f"<td data-head='{head}' class='{head}'>{cell}</td>" for head, cell in pairs) + "</tr>"
