"""A still picture of before and after, for a text rather than a screen."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from stillrate.io.log import Floats
from stillrate.io.safely import atomic, needs

RAW, CLEAN, TRUTH = "#e0884a", "#1467c8", "#10151d"


def write_picture(
    path: str | Path,
    t_s: Floats,
    raw_dps: Floats,
    clean_dps: Floats,
    truth_dps: Floats | None = None,
    *,
    title: str = "",
    closeups: tuple[tuple[str, slice], ...] = (),
    force: bool = False,
) -> None:
    """Write a PNG: the whole record above, close-ups below.

    Parameters
    ----------
    path : str or Path
    t_s, raw_dps, clean_dps : ndarray, shape (n,)
    truth_dps : ndarray, optional
        Drawn as a thin line in the close-ups.
    closeups : tuple of (str, slice)
        Title and samples of each close-up.

    Raises
    ------
    LogError
        If matplotlib is not installed.
    FileExistsError
        If the file exists and `force` is not set.
    """
    figure_module = needs("matplotlib.figure", "report", "a picture")
    figure: Any = figure_module.Figure(figsize=(10, 5.2 if closeups else 3), dpi=110, layout="constrained")
    grid = figure.add_gridspec(2 if closeups else 1, max(1, len(closeups)))
    axes = figure.add_subplot(grid[0, :])
    axes.plot(t_s, raw_dps, color=RAW, linewidth=0.6, label="raw")
    axes.plot(t_s, clean_dps, color=CLEAN, linewidth=1.0, label="clean")
    axes.set(ylabel="deg/s", xlabel="s", title=title)
    axes.legend(loc="upper right", ncols=3, frameon=False)
    for index, (name, part) in enumerate(closeups):
        axes = figure.add_subplot(grid[1, index])
        axes.plot(t_s[part], raw_dps[part], ".", color=RAW, markersize=3, label="raw")
        axes.plot(t_s[part], clean_dps[part], color=CLEAN, linewidth=1.8, label="clean")
        if truth_dps is not None:
            axes.plot(t_s[part], truth_dps[part], "--", color=TRUTH, linewidth=1.0, label="truth")
        axes.set(title=name, xlabel="s")
        axes.legend(loc="upper right", fontsize="small", frameon=False)
    for axes in figure.axes:
        axes.spines[["top", "right"]].set_visible(False)
        axes.margins(x=0)
    with atomic(Path(path), force=force) as temporary:
        figure.savefig(temporary, format="png")
