"""A published figure beside ours: one row of the page that `stillrate reproduce all` writes.

No verdict is ever given: it follows from our figure, the range that counts as the same figure, and, where there is one, a
bound that no estimator can pass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

REPRODUCED, NOT_REPRODUCED, NOT_REPRODUCIBLE = "reproduced", "not reproduced", "not reproducible"
VERDICTS = (REPRODUCED, NOT_REPRODUCED, NOT_REPRODUCIBLE)


@dataclass(frozen=True, kw_only=True)
class Row:
    """A published figure, ours, and what counts as the same.

    Attributes
    ----------
    study : str
        Name of the study, as `stillrate reproduce` lists it.
    quantity : str
        What was published, with its place.
    published : str
        The figure as published.
    ours : float or None
        Our figure; None where the publication or the package lacks what is needed to compute one.
    unit : str
        Unit of both; empty for a ratio or a count.
    least, most : float
        Our figure counts as the published one from `least` to `most`, both included.
    floor : float or None
        No estimator can be below this (same unit); above `most`, the published figure cannot be reached by anyone.
    reason : str
        Why the verdict is what it is, or what had to be assumed.
    effort : str
        Seeds, draws or units behind our figure.

    Examples
    --------
    >>> Row(study="bank", quantity="rms at rest", published="2.0", ours=2.1, unit="deg/s", least=1.9, most=2.1).verdict
    'reproduced'
    """

    study: str
    quantity: str
    published: str
    ours: float | None
    unit: str = ""
    least: float = -math.inf
    most: float = math.inf
    floor: float | None = None
    reason: str = ""
    effort: str = ""

    @property
    def verdict(self) -> str:
        """Reproduced, not reproduced, or not reproducible."""
        if self.ours is None or (self.floor is not None and self.floor > self.most):
            return NOT_REPRODUCIBLE
        return REPRODUCED if self.least <= self.ours <= self.most else NOT_REPRODUCED

    @property
    def accepted(self) -> str:
        """The range that counts as the published figure, in words."""
        if self.ours is None:
            return ""
        if math.isinf(self.least):
            return f"at most {self.most:.4g}"
        if math.isinf(self.most):
            return f"at least {self.least:.4g}"
        if self.least == self.most:
            return f"{self.most:.4g}"
        return f"{self.least:.4g} to {self.most:.4g}"

    def as_json(self) -> dict[str, Any]:
        """Return the row for a file; an infinite figure is a word there."""
        return {
            "study": self.study,
            "quantity": self.quantity,
            "published": self.published,
            "ours": _number(self.ours),
            "unit": self.unit,
            "least": _number(self.least) if math.isfinite(self.least) else None,
            "most": _number(self.most) if math.isfinite(self.most) else None,
            "floor": _number(self.floor),
            "verdict": self.verdict,
            "reason": self.reason,
            "effort": self.effort,
        }


def around(published: float, relative: float) -> dict[str, float]:
    """Return the range within a part of a published figure, as arguments of `Row`.

    Examples
    --------
    >>> around(10.0, 0.5)
    {'least': 5.0, 'most': 15.0}
    """
    half = relative * abs(published)
    return {"least": published - half, "most": published + half}


def _number(value: float | None) -> float | str | None:
    if value is None or math.isfinite(value):
        return value
    return str(value)
