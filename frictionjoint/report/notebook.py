"""A report in Jupyter: verdict, friction numbers, picture."""

from base64 import b64encode
from html import escape

from frictionjoint.display import table
from frictionjoint.report.joint_report import Report
from frictionjoint.report.picture import draw, picture
from frictionjoint.report.summary import summarise


def report_html(report: Report) -> str:
    """HTML without a style sheet that loads nothing."""
    s = summarise(report.to_dict())
    lines = "".join(f"<p><b>{escape(k)}:</b> {escape(text)}</p>" for k, text in s.verdict_lines)
    rows = [(x.meaning, x.qualified) for x in s.friction]
    numbers = table(f"friction of joint {report.joint}", ("", "value"), rows)
    image = b64encode(picture(draw(report), "png")).decode()
    return f'{lines}{numbers}<img style="max-width: 60rem" src="data:image/png;base64,{image}">'
