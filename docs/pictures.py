"""What the site's drawing scripts share: a figure as SVG, for light pages and for dark ones."""

import io
from collections.abc import Callable

import matplotlib
import mkdocs_gen_files

matplotlib.use("svg")
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

INKS = {"": "#333333", "-dark": "#d0d4d8"}


def write(name: str, draw: Callable[[], Figure]) -> None:
    """Draw into `name`.svg and `name`-dark.svg, names relative to the site's docs folder."""
    for suffix, ink in INKS.items():
        names = ("text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color", "ytick.color")
        style = dict.fromkeys(names, ink) | {"axes.titlesize": 11, "svg.hashsalt": name}
        style |= {"axes.spines.top": False, "axes.spines.right": False}
        with plt.rc_context(style):
            figure = draw()
            for axes in figure.axes:
                axes.grid(alpha=0.25)
            text = io.StringIO()
            figure.savefig(text, format="svg", transparent=True)
            plt.close(figure)
        with mkdocs_gen_files.open(f"{name}{suffix}.svg", "w") as file:
            file.write(text.getvalue())


def shown(name: str, text: str) -> str:
    """Markdown that shows the one that suits the page."""
    return f"![{text}]({name}.svg#only-light)\n![{text}]({name}-dark.svg#only-dark)\n"
