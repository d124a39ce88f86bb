"""A report in Jupyter: verdict, friction numbers, picture."""

from html import escape

from frictionjoint.display import table
from frictionjoint.report.joint_report import Report
from frictionjoint.report.picture import PAGE_STYLE, draw, svg
from frictionjoint.report.summary import summarise

# a page's colours, readable on light and on dark
_COLOURS = "--soft: #808080; --line: rgba(128, 128, 128, 0.3)"


def report_html(report: Report) -> str:
    """HTML without a style sheet that loads nothing."""
    s = summarise(report.to_dict())
    lines = "".join(f"<p><b>{escape(k)}:</b> {escape(text)}</p>" for k, text in s.verdict_lines)
    rows = [(x.meaning, x.qualified) for x in s.friction]
    numbers = table(f"friction of joint {report.joint}", ("", "value"), rows)
    picture = svg(draw(report, PAGE_STYLE), f"notebook-{report.joint}")
    return f'{lines}{numbers}<div style="max-width: 60rem; {_COLOURS}">{picture}</div>'
