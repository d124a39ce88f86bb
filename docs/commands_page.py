"""The page of commands, from the help of the command line itself.

Run by mkdocs (gen-files) when the site is built; nothing it writes is committed.
"""

from collections import Counter
from typing import Any

import mkdocs_gen_files
import typer

from frictionjoint.cli import app

# an option of so many commands is explained once
_COMMON = 3


def name_of(parameter: Any) -> str:
    """Names of an argument or an option, and what it takes."""
    if parameter.param_type_name == "argument":
        names, takes = f"`{parameter.metavar or parameter.name.upper()}`", ""
    else:
        names = ", ".join(f"`{name}`" for name in parameter.opts)
        takes = f" `{parameter.metavar}`" if parameter.metavar and not parameter.is_flag else ""
    return f"{names}{takes}"


def option(parameter: Any) -> str:
    """One line for an argument or an option with its help."""
    return f"* {name_of(parameter)}: {' '.join((parameter.help or '').split())}"


def parameters_of(command: Any) -> list[Any]:
    """Arguments and options that help shows."""
    return [p for p in command.params if not getattr(p, "hidden", False) and p.name != "help"]


def leaves(command: Any) -> list[Any]:
    """The commands below a group."""
    below = getattr(command, "commands", {}).values()
    return [x for each in below for x in leaves(each)] if below else [command]


def section(name: str, command: Any, level: int, common: list[str]) -> list[str]:
    """A command, its options, and the commands below it."""
    lines = [f"{'#' * level} {name}\n"]
    for paragraph in (command.help or "").replace("\b", "").split("\n\n"):
        if paragraph.strip().startswith(("frictionjoint ", "*")):
            lines.append(f"{paragraph.strip()}\n")
        else:
            lines.append(f"{' '.join(paragraph.split())}\n")
    for below, each in getattr(command, "commands", {}).items():
        lines += section(f"{name} {below}", each, level + 1, common)
    if not hasattr(command, "commands"):
        own = [(p, option(p)) for p in parameters_of(command)]
        lines += [text for _, text in own if text not in common]
        also = [f"`{p.opts[0]}`" for p, text in own if text in common]
        lines += [f"* [Common options](#common-options): {', '.join(also)}"] if also else []
        lines.append("")
    return lines


def main() -> None:
    """The page."""
    lines = [
        "# Commands\n",
        "Every command prints this text with `--help`. `--json` prints results for a script. Bad",
        "input ends in one line and exit code 2, and writes nothing. An interruption ends with",
        "exit code 130. `check --strict` ends with exit code 1 if anything is outside its",
        "limits.\n",
    ]
    root = typer.main.get_command(app)
    counts = Counter(
        option(p) for each in leaves(root) for p in parameters_of(each) if p.opts[0][0] == "-"
    )
    common = [text for text, count in counts.items() if count >= _COMMON]
    for name, command in root.commands.items():
        lines += section(name, command, 2, common)
    lines += ["## Common options\n", *common]
    with mkdocs_gen_files.open("commands.md", "w") as file:
        file.write("\n".join(lines))


main()
