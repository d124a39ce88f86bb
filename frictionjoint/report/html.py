"""What all pages have in common: template and style. Reading a page fetches nothing."""

import platform
from importlib.metadata import version
from importlib.resources import files
from typing import Any

from jinja2 import Environment
from markupsafe import Markup

_MADE_BY = ("frictionjoint", "mujoco", "numpy", "scipy", "numba")


def fill(template: str, filters: dict[str, Any], **values: Any) -> str:
    """A page from a template of this folder; whatever is no `Markup` is escaped."""
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= filters
    versions = [f"{name} {version(name)}" for name in _MADE_BY]
    return environment.from_string(_text(template)).render(
        values,
        style=Markup(_text("style.css")),
        versions=", ".join([*versions, f"Python {platform.python_version()}"]),
    )


def _text(name: str) -> str:
    return files("frictionjoint.report").joinpath(name).read_text(encoding="utf-8")
