"""A report as Jupyter shows it: the verdict, the errors, what was added, the log over time."""

from html import escape

from frictionjoint.diagnose.report_data import Report
from frictionjoint.display import table
from frictionjoint.report import plots, wording
from frictionjoint.report.figure import svg
from frictionjoint.report.page import errors

# a page's colours, readable on light and on dark
_COLOURS = "--soft: #808080; --line: rgba(128, 128, 128, 0.3)"


def report_html(report: Report) -> str:
    """HTML that needs no style sheet and fetches nothing."""
    added = [
        (
            wording.known_as(x.effect),
            f"{x.evidence.held_out_gain:.1%}",
            ", ".join(f"{n} {wording.value(e, True)} {e.unit}" for n, e in x.parameters.items()),
        )
        for x in report.added
    ]
    head = ("rms error", "fitted logs", "held-out logs", "95% interval")
    parts = [
        f"<p><b>{escape(wording.sentence(report))}</b></p>",
        table(f"joint {report.joint}", head, errors(report)),
    ]
    if added:
        parts.append(table("added", ("effect", "cross-validated gain", "parameters"), added))
    parts += [f"<p>{escape(note)}</p>" for note in report.notes]
    picture = svg(plots.over_time(report, wide=True), f"notebook-{report.joint}")
    return "".join(parts) + f'<div style="max-width: 60rem; {_COLOURS}">{picture}</div>'
