"""The page of commands, from the help of the command line itself.

Run by mkdocs (gen-files) when the site is built; nothing it writes is committed.
"""

from typing import Any

import mkdocs_gen_files
import typer

from frictionjoint.cli import app


def option(parameter: Any) -> str:
    """One line for an argument or an option: its names, what it takes, its help."""
    if parameter.param_type_name == "argument":
        names, takes = f"`{parameter.metavar or parameter.name.upper()}`", ""
    else:
        names = ", ".join(f"`{name}`" for name in parameter.opts)
        takes = f" `{parameter.metavar}`" if parameter.metavar and not parameter.is_flag else ""
    return f"* {names}{takes}: {' '.join((parameter.help or '').split())}"


def section(name: str, command: Any, level: int) -> list[str]:
    """A command, its options, and the commands below it."""
    lines = [f"{'#' * level} {name}\n"]
    for paragraph in (command.help or "").replace("\b", "").split("\n\n"):
        if paragraph.strip().startswith(("frictionjoint ", "*")):
            lines.append(f"{paragraph.strip()}\n")
        else:
            lines.append(f"{' '.join(paragraph.split())}\n")
    for below, each in getattr(command, "commands", {}).items():
        lines += section(f"{name} {below}", each, level + 1)
    if not hasattr(command, "commands"):
        shown = (p for p in command.params if not getattr(p, "hidden", False) and p.name != "help")
        lines += [*map(option, shown), ""]
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
    for name, command in typer.main.get_command(app).commands.items():
        lines += section(name, command, 2)
    with mkdocs_gen_files.open("commands.md", "w") as file:
        file.write("\n".join(lines))


main()
