"""What a claim of the paper comes down to: words, numbers, a figure."""

from dataclasses import dataclass
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

OURS, OTHER, THIRD, GREY = "#1b9e77", "#d95f02", "#7570b3", "0.55"


@dataclass(frozen=True)
class Claim:
    """One section of the page.

    Attributes:
        name: of the figure's file. title: of the section.
        text: what the paper says, and what is found here; Markdown.
        numbers: JSON values by name, units in the names.
    """

    name: str
    title: str
    text: str
    numbers: dict[str, Any]
    figure: Figure


def panels(columns: int = 1, height: float = 3.2) -> tuple[Figure, list[Axes]]:
    """A row of plots of one size for the whole page."""
    figure = Figure(figsize=(3.6 * max(columns, 1.6), height), layout="constrained")
    axes = figure.subplots(1, columns, squeeze=False)[0]
    for ax in axes:
        ax.grid(alpha=0.25)
    return figure, list(axes)


def table(header: list[str], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines) + "\n"
