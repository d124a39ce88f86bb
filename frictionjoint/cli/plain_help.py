"""Types of options and arguments in help texts, in words: FILE, INTEGER, none for a switch."""

from functools import partial
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

_WORDS = {"path": "FILE", "file": "FILE", "int": "INTEGER", "float": "NUMBER", "str": "TEXT"}


class _PlainTypes:
    """A command whose help names the type of each parameter in one word."""

    def get_params(self, ctx: Any) -> list[Any]:
        found: list[Any] = super().get_params(ctx)  # type: ignore[misc]
        for parameter in found:
            # where this version of typer does not ask for them they change nothing
            vars(parameter).update(
                display_type_rich=partial(_type_of, parameter),
                _get_number_range_help_str=lambda: None,
            )
        return found


class PlainCommand(_PlainTypes, TyperCommand):
    """A command of this kind."""


class PlainGroup(_PlainTypes, TyperGroup):
    """A group of commands of this kind."""


def _type_of(parameter: Any, ctx: Any) -> str | None:
    """The word for the type of a parameter; None for a switch."""
    if getattr(parameter, "is_flag", False):
        return None
    is_argument = parameter.param_type_name == "argument"
    if parameter.metavar is not None and not is_argument:
        return str(parameter.metavar)
    raw = str(parameter.display_type(ctx)).strip("<>").removesuffix(" range")
    several = raw.startswith("list[")
    raw = raw.removeprefix("list[").removesuffix("]").lower()
    return _WORDS.get(raw, raw.upper() if raw.isalpha() else raw) + ("..." if several else "")


def option(metavar: str, text: str, *names: str, **more: Any) -> Any:
    """An option with a value, called like its parameter or by `names`; `text` is its help."""
    return typer.Option(*names, metavar=metavar, help=text, **more)


def argument(metavar: str, text: str) -> Any:
    """An argument; `text` is its help."""
    return typer.Argument(metavar=metavar, help=text)
