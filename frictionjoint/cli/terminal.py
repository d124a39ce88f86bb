"""What a person sees while a command runs and when it ends; silent and plain where it is piped."""

import contextlib
import re
import warnings
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

if TYPE_CHECKING:  # the command line starts in a moment: what computes is imported by its command
    from frictionjoint.diagnose.report_data import Report
    from frictionjoint.diagnose.rms import Rms
    from frictionjoint.identify.result import Estimate

# "fit: start 3 of 12": work that says how much is left gets a bar
_COUNTED = re.compile(r"(\d+) of (\d+)")
_PIPED_WIDTH = 120


def console() -> Console:
    """Standard output; wide enough for tables where it goes into a file."""
    out = Console()
    return out if out.is_terminal else Console(width=_PIPED_WIDTH)


@contextlib.contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """A line on stderr that says what is being done and what is left of it."""
    err = Console(stderr=True)
    bar = BarColumn(bar_width=24)
    columns = (SpinnerColumn(), TextColumn("{task.description}"), bar, TimeElapsedColumn())
    with Progress(*columns, console=err, transient=True, disable=not err.is_terminal) as shown:
        task = shown.add_task("reading", total=None)

        def tell(text: str) -> None:
            counted = _COUNTED.search(text)
            done, total = (int(counted[1]) - 1, int(counted[2])) if counted else (0, None)
            shown.update(task, description=text, completed=done, total=total)

        yield tell


@contextlib.contextmanager
def warnings_afterwards() -> Iterator[None]:
    """Show warnings of the block when it has succeeded, each once: an error is a line alone."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    for text in dict.fromkeys(str(warning.message) for warning in caught):
        warnings.warn(text, RuntimeWarning, stacklevel=3)


def show_report(report: "Report") -> None:
    """Errors before and after, what was added and why, the verdict, what to record next."""
    from frictionjoint.report.wording import drive, interval, known_as, sentence

    unit, position = report.units
    table = Table(f"{drive(report)} rms", "fitted logs", "held out", "95% interval")
    stages = (("before", report.before_torque), ("after", report.after_torque))
    for (name, rms), pair in zip(stages, report.torque_interval or (None, None), strict=True):
        table.add_row(name, *_errors(rms, unit), interval(pair))
    out = console()
    out.print(table)
    if report.result_loops:
        table = Table("position in closed loop, mean absolute error", "fitted logs", "held out")
        for name, loops in zip(("before", "after"), report.result_loops, strict=True):
            table.add_row(name, *_errors(loops.mae, position))
        out.print(table)
    for added in report.added:
        ties = f", or {', '.join(added.evidence.ties)}" if added.evidence.ties else ""
        out.print(
            f"added {known_as(added.effect)}{ties}: "
            f"cross-validated gain {added.evidence.held_out_gain:.1%}, "
            f"p {added.evidence.p_value:.2g}, runner-up {added.evidence.runner_up}"
        )
    out.print(sentence(report), soft_wrap=True)
    for text in (*report.notes, *report.proposals):
        out.print(f"* {text}", soft_wrap=True, markup=False)


def _errors(pair: "Rms", unit: str) -> list[str]:
    """Cells of the logs fitted and of those held out."""
    return ["-" if x is None else f"{x:.4g} {unit}" for x in (pair.fit, pair.held_out)]


def show_estimates(rows: "list[tuple[str, Estimate]]") -> None:
    """Parameters with their errors and units."""
    from frictionjoint.report.wording import three, unit, value

    table = Table("parameter", "value", "standard error", "unit")
    for name, x in rows:
        table.add_row(name, value(x), three(x.stderr), unit(x.unit))
    console().print(table)
