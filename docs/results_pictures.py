"""Plots of the results page, drawn from the tables in lab/notes.

Run by mkdocs (gen-files) when the site is built; nothing it writes is committed.
"""

import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import pictures
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

NOTES = Path(__file__).resolve().parents[1] / "lab" / "notes"
GREEN, ORANGE, GREY = "#1b9e77", "#d95f02", "#8a8f98"


def rows(page: str, first: str) -> list[list[str]]:
    """Cells of the table whose first heading is `first`."""
    lines = (NOTES / page).read_text().splitlines()
    (start,) = (i for i, line in enumerate(lines) if line.startswith(f"| {first} |"))
    table = []
    for line in lines[start + 2 :]:
        if not line.startswith("|"):
            break
        table.append([cell.strip() for cell in line.strip("|").split("|")])
    return table


def number(cell: str) -> float:
    """The first number in a cell."""
    found = re.search(r"\d+(?:\.\d+)?(?:e[-+]?\d+)?", cell)
    assert found, cell
    return float(found.group())


def joints() -> Figure:
    """Torque error of measured joints before and after."""
    table = rows("real_logs.md", "machine")
    figure, axes = plt.subplots(figsize=(7, 6.2), layout="constrained")
    for y, cells in enumerate(reversed(table)):
        before, after = number(cells[4]), number(cells[5])
        axes.plot([after, before], [y, y], color=GREY, lw=2, zorder=1)
        axes.plot(before, y, "o", color=ORANGE, zorder=2)
        axes.plot(after, y, "o", color=GREEN, zorder=3)
    axes.set_yticks(range(len(table)), [f"{c[0]} {c[1]}" for c in reversed(table)], fontsize=9)
    axes.plot([], [], "o", color=ORANGE, label="friction law alone")
    axes.plot([], [], "o", color=GREEN, label="with the effects that were found")
    axes.set(xscale="log", xlabel="torque error on held-out data, % of rms torque")
    axes.set_xticks([1, 2, 5, 10, 20, 50], ["1", "2", "5", "10", "20", "50"])
    axes.xaxis.set_minor_locator(plt.NullLocator())
    axes.legend(fontsize=9, frameon=False, loc="lower left")
    return figure


def servos() -> Figure:
    """STS3215: BAM's models and ours."""
    table = rows("servo_logs.md", "model")
    figure, axes = plt.subplots(figsize=(7, 2.8), layout="constrained")
    names = ["ours" if c[0].startswith("ours") else c[0] for c in table]
    errors = [number(c[-1]) for c in table]
    colours = [GREEN if name == "ours" else GREY for name in names]
    axes.barh(names[::-1], errors[::-1], color=colours[::-1])
    axes.set(xlabel="mean absolute position error, rad (STS3215, gain 8 held out)")
    return figure


def p_values() -> Figure:
    """Distribution of p-values where nothing is hidden."""
    text = (NOTES / "trials.md").read_text()
    counts = [int(n) for n in re.findall(r"^\d\.\d to \d\.\d +(\d+)", text, re.MULTILINE)]
    assert len(counts) == 10, counts
    figure, axes = plt.subplots(figsize=(7, 2.6), layout="constrained")
    axes.bar([0.05 + 0.1 * i for i in range(10)], counts, width=0.095, color=GREEN)
    axes.axhline(sum(counts) / 10, color=GREY, ls=":", lw=1.5, label="uniform")
    axes.set(xlabel="p-value", ylabel="logs of 500", xlim=(0, 1))
    axes.legend(fontsize=9, frameon=False)
    return figure


for drawing in (joints, servos, p_values):
    pictures.write(f"img/results/{drawing.__name__}", drawing)
