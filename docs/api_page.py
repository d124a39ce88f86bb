"""The page of the Python interface: a table of all public names.

Run by mkdocs (gen-files) when the site is built; nothing it writes is committed.
"""

import inspect
from ast import get_docstring, parse
from importlib import import_module
from pathlib import Path
from typing import Any

import frictionjoint as fj

GROUPS = {
    "Logs and identification": (
        "read_log", "JointLog", "plot", "close_loop", "identify", "evaluate", "export",
    ),
    "Friction in a model": (
        "FrictionParameters", "install", "uninstall", "load_model", "attach", "enable", "disable",
        "check",
    ),
    "During a simulation": (
        "torque", "mass_matrix", "set_parameters", "forget", "remembered", "temperature",
        "set_temperature", "warmth", "set_warmth",
    ),
    "Without MuJoCo's callback": ("friction_torque", "FrictionBatch", "attach_warp"),
}  # fmt: skip
# modules whose names the pages and examples import
MODULES = (
    "frictionjoint.files",
    "frictionjoint.rivals",
    "frictionjoint.errors",
    "frictionjoint.effects.effect",
    "frictionjoint.report.joint_report",
    "frictionjoint.report.entries",
    "frictionjoint.simulate.carrier",
    "frictionjoint.simulate.gymnasium",
    "frictionjoint.simulate.dm_control",
    "frictionjoint.simulate.sysid",
    "frictionjoint.simulate.mjlab",
)


def public(name: str) -> Any:
    """The function or class of a public name."""
    if name in ("identify", "export"):  # packages that are called like these functions
        return getattr(import_module("frictionjoint.commands"), name)
    return getattr(fj, name)


def call(name: str) -> str:
    """A name with its parameters."""
    parameters = inspect.signature(public(name)).parameters.values()
    shown = [p.name if p.default is p.empty else f"{p.name}=…" for p in parameters]
    few = shown if len(shown) <= 4 else [*[x for x in shown if "=" not in x], "…"]
    return f"`{name}({', '.join(few)})`"


def first_sentence(thing: Any) -> str:
    """The first paragraph of a docstring, without an example below it."""
    text = (inspect.getdoc(thing) or "").split("\n\n")[0]
    return " ".join(text.split()).removesuffix("::").removesuffix(":").rstrip(".") + "."


def summary(module: str) -> str:
    """The first sentence of a module's docstring, which its source states."""
    path = Path(fj.__file__).parent.joinpath(*module.split(".")[1:]).with_suffix(".py")
    text = get_docstring(parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split()).rstrip(":.") + "."


def page() -> str:
    """The page as Markdown."""
    lines = [
        "# API\n",
        "`import frictionjoint as fj` gives these names. `help(fj.close_loop)` prints arguments,",
        "units, results and errors of any of them.\n",
    ]
    for title, names in GROUPS.items():
        lines += [f"## {title}\n", "| Call | What it does |", "|---|---|"]
        lines += [f"| {call(name)} | {first_sentence(public(name))} |" for name in names]
        lines.append("")
    lines += ["## Modules\n", "| Module | Content |", "|---|---|"]
    lines += [f"| `{name}` | {summary(name)} |" for name in MODULES]
    return "\n".join([*lines, ""])


if __name__ != "api_page":  # run by mkdocs, not imported
    import mkdocs_gen_files

    with mkdocs_gen_files.open("api.md", "w") as file:
        file.write(page())
