"""Pictures of a page: drawn by matplotlib, in the page's own colours, light or dark."""

import io
import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from markupsafe import Markup
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frictionjoint.arrays import Array

# inches; a page is twice a half wide, a phone as wide as a half
WIDE, HALF = 10.2, 5.0
MEASURED, BEFORE, AFTER, REFINED = "#8a8f94", "#d95f02", "#1b9e77", "#7570b3"
# stand for what the style sheet decides
_INK, _LINE = "#010203", "#040506"
_STYLE: dict[Any, Any] = {
    "axes.edgecolor": _LINE,
    "axes.grid": True,
    "axes.labelcolor": _INK,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "figure.constrained_layout.use": True,
    "font.size": 9.5,
    "grid.color": _LINE,
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.handlelength": 1.2,
    "legend.labelcolor": _INK,
    "svg.fonttype": "none",
    "text.color": _INK,
    "xtick.color": _INK,
    "ytick.color": _INK,
}
# what matplotlib numbers through a figure: of no use in a page of many
_NUMBERED = re.compile(r' id="[A-Za-z0-9.]+_\d+"')
_RASTER_DPI = 150


def figure(width: float, height: float, rows: int = 1) -> tuple[Figure, list[Axes]]:
    """An empty figure of the page's style, inches; axes of all rows share their abscissa."""
    with rc_context(_STYLE):
        made = Figure(figsize=(width, height))
        axes = made.subplots(rows, 1, sharex=True, squeeze=False)[:, 0]
        for one in axes:
            one.ticklabel_format(scilimits=(-4, 5))
    return made, list(axes)


def cloud(axes: Axes, x: Array, y: Array, colour: str, size: float, label: str = "") -> None:
    """Samples, as a picture within: each of them as an element would make the page large."""
    axes.plot(
        x,
        y,
        "o",
        color=colour,
        markersize=size,
        markeredgewidth=0.0,
        rasterized=True,
        label=label or "_",
    )


def lines(axes: Axes, curves: Sequence[tuple[Array, Array]], colour: str, label: str) -> None:
    """Several curves as one entry of the legend."""
    gap = np.array([np.nan])
    x, y = (np.concatenate([part for c in curves for part in (c[i], gap)]) for i in (0, 1))
    axes.plot(x, y, color=colour, label=label, linewidth=1.5)


def svg(drawn: Figure, name: str) -> Markup:
    """A figure as a part of a page, with its legend above.

    Args:
        name: unlike that of any other figure of the page.
    """
    buffer = io.StringIO()
    with rc_context(_STYLE | {"svg.hashsalt": name}):
        handles, labels = drawn.axes[0].get_legend_handles_labels()
        if handles:
            drawn.legend(handles, labels, loc="outside upper left", ncols=4)
        drawn.savefig(
            buffer, format="svg", transparent=True, dpi=_RASTER_DPI, metadata={"Date": None}
        )
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r'(<svg[^>]*?) width="[^"]*" height="[^"]*"', r"\1", text, count=1)
    text = re.sub(r' width="[\d.]+pt"| height="[\d.]+pt"', "", text, count=2)
    text = _NUMBERED.sub("", text).replace(_INK, "var(--soft)").replace(_LINE, "var(--line)")
    return Markup(text)
