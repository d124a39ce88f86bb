"""Template, style and charts shared by all pages. A page loads nothing from elsewhere."""

import json
import math
import platform
from importlib.metadata import version
from importlib.resources import files
from typing import Any

from jinja2 import Environment, FunctionLoader
from markupsafe import Markup

from frictionjoint.arrays import Array
from frictionjoint.report.charts import Chart


def versions() -> dict[str, str]:
    """Versions of the software that makes a report, by name."""
    found = {name: version(name) for name in ("frictionjoint", "mujoco", "numpy", "scipy")}
    return found | {"Python": platform.python_version()}


def fill(template: str, filters: dict[str, Any], **values: Any) -> str:
    """A page from a template of this folder; text is escaped unless it is `Markup`."""
    loader = FunctionLoader(_text)
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, loader=loader)
    environment.filters |= filters | {"chart": chart_html}
    return environment.get_template(template).render(
        values,
        style=Markup(_text("style.css")),
        charts=Markup(_text("chart.js")),
        versions=", ".join(f"{name} {x}" for name, x in versions().items()),
    )


def chart_html(chart: Chart, small: bool = False) -> Markup:
    """A chart as a part of a page; `chart.js` draws it."""
    data = {
        "x_label": chart.x_label,
        "y_label": chart.y_label,
        "group": chart.group,
        "series": [vars(s) | {"x": _rounded(s.x), "y": _rounded(s.y)} for s in chart.series],
    }
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    # nothing in it may end the element that holds it
    text = text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
    size = "low" if chart.low else "small" if small else ""
    return Markup(
        '<figure class="chart {}"><figcaption>{}</figcaption><div class="legend"></div>'
        '<canvas role="img" aria-label="{}"></canvas>'
        '<script type="application/json">{}</script></figure>'
    ).format(size, chart.title, chart.title, Markup(text))


def _rounded(x: Array) -> list[float | None]:
    """Numbers to five figures; null for missing ones."""
    return [float(f"{v:.5g}") if math.isfinite(v) else None for v in x.tolist()]


def _text(name: str) -> str:
    return files("frictionjoint.report").joinpath(name).read_text(encoding="utf-8")
