"""Terminal output while a command runs and when it ends; plain text if it is redirected."""

import contextlib
import re
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import (
    Progress,
    SpinnerColumn,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Column, Table

if TYPE_CHECKING:  # the command line starts in a moment: what computes is imported by its command
    from frictionjoint.report.joint_report import Report
    from frictionjoint.report.robot_report import RobotReport

# "fit: start 3 of 12": work that says how much is left
_COUNTED = re.compile(r"(\d+)(?: of |/)(\d+)")


def console() -> Console:
    """Standard output, wide enough for tables if redirected to a file."""
    out = Console()
    return out if out.is_terminal else Console(width=120)


@contextlib.contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """A line on stderr: the current step, its progress, and the remaining time, both where a
    message counts ("4 of 12", "4/12"), from the counted steps so far."""
    err = Console(stderr=True)
    columns = SpinnerColumn(), TextColumn("{task.description}"), TaskProgressColumn()
    times = TimeRemainingColumn(), TimeElapsedColumn()
    shown = Progress(
        *columns,
        *times,
        console=err,
        transient=True,
        disable=not err.is_terminal,
        speed_estimate_period=3600.0,
    )
    with shown:
        task, kind = shown.add_task("Reading", total=None), ""

        def tell(text: str) -> None:
            nonlocal kind
            counted = _COUNTED.search(text)
            before, kind = kind, text[: counted.start()] if counted else text
            if kind != before:  # another kind of work is timed anew
                shown.reset(task, start=False, total=None)
            done, total = (int(counted[1]) - 1, int(counted[2])) if counted else (0, None)
            description = text[:1].upper() + text[1:]
            shown.update(task, description=description, completed=done, total=total)

        yield tell


@contextlib.contextmanager
def warnings_afterwards() -> Iterator[None]:
    """Show the warnings of a block after it has succeeded, each once; an error is shown alone."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    for text in dict.fromkeys(str(warning.message) for warning in caught):
        warnings.warn(text, RuntimeWarning, stacklevel=3)


def show_report(report: "Report | RobotReport") -> None:
    """The summary of a report: verdict, friction numbers, at most five notes."""
    console().print(report.summary(), soft_wrap=True, markup=False, highlight=False)


def show_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table; a word that is too long for its column, such as an address, is folded."""
    table = Table(*(Column(text, overflow="fold") for text in head))
    for row in rows:
        table.add_row(*row)
    console().print(table)
