"""`frictionjoint.plot`: logs as a matplotlib figure."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.readers import read_log

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot(log: JointLog | str | Path, joint: str | None = None) -> "Figure":
    """Draw a log as measured, before anything is fitted.

    A report has its own method, ``report.plot()``.

    Args:
        log: a log or its file. joint: its name, if the file contains several.
    Returns:
        a matplotlib figure: position, velocity and drive over time, drive against both.
    Raises:
        LogError: see `read_log`.
    """
    from frictionjoint.report.log_plot import described, log_charts
    from frictionjoint.report.picture import draw_charts

    found = log if isinstance(log, JointLog) else read_log(log, joint)
    return draw_charts(log_charts(found), described(found))


def plot_text(logs: Sequence[JointLog], kind: str) -> str | bytes:
    """Logs as a page (".html") or a picture (".png", ".svg").

    Raises:
        LogError: a picture of more than one log.
    """
    from frictionjoint.report.html import fill
    from frictionjoint.report.log_plot import described, log_charts
    from frictionjoint.report.picture import picture

    if kind != ".html":
        if len(logs) != 1:
            raise LogError(f"a {kind} picture has one log: end --out in .html for several")
        return picture(plot(logs[0]), kind.removeprefix("."))
    rows: list[tuple[str, Any, Any]] = [(described(x), x.notes, log_charts(x)) for x in logs]
    names = ", ".join(dict.fromkeys(x.name for x in logs))
    return fill("log.html.j2", {}, title=names, logs=rows)
