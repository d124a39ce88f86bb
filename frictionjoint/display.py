"""Small tables of results for Jupyter."""

from collections.abc import Iterable, Sequence
from html import escape


def table(title: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table as HTML; all texts are escaped."""
    cells = "".join(f"<th>{escape(x)}</th>" for x in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(x)}</td>" for x in row) + "</tr>" for row in rows)
    return f"<table><caption>{escape(title)}</caption><tr>{cells}</tr>{body}</table>"


def number_table(title: str, values: Iterable[tuple[str, object]]) -> str:
    """Numbers by name, to five figures; anything else as its text."""
    return table(title, ("parameter", "value"), [(name, _text(x)) for name, x in values])


def _text(x: object) -> str:
    if isinstance(x, list | tuple):
        return f"({', '.join(_text(y) for y in x)})"
    return f"{x:.5g}" if isinstance(x, float) else str(x)
