"""Content of TOML and JSON files, with one error for a file that is missing or damaged."""

import dataclasses
import json
import tomllib
from pathlib import Path
from types import UnionType
from typing import Any, Literal, get_args, get_origin, get_type_hints

from frictionjoint.errors import ParameterError

# types in words
_WORDS = {dict: "a table", list: "a list", str: "text", float: "a number below 1e100"}


def read_toml(path: Path, fix: str = "") -> dict[str, Any]:
    """Content of a TOML file; `fix`: what the user should do if there is none, after the reason.

    Raises:
        ParameterError: the file is missing, or no TOML.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ParameterError(f"{path}: cannot be read: {error.strerror}{fix}") from None
    except UnicodeDecodeError:
        raise ParameterError(f"{path}: not text in UTF-8, save it as UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise ParameterError(f"{path}: not TOML: {error}{fix}") from None


def read_json(path: Path, fix: str) -> Any:
    """Content of a JSON file; `fix`: what the user should do if it is no JSON.

    Raises:
        ParameterError: the file is missing, or no JSON.
    """
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ParameterError(f"{path}: cannot be read: {error.strerror}") from None
    except (ValueError, RecursionError):
        raise ParameterError(f"{path}: not JSON: {fix}") from None


def require_form(x: Any, form: Any, place: str) -> None:
    """Check the content of a JSON file.

    Args:
        form: a type, a Literal, a dataclass; forms by key, where "key?" may be missing; in a list,
            the form of its entries. Of a union the first type counts, or null.
        place: of `x` in the file.
    Raises:
        ParameterError: the first entry of another form, and the form it must have.
    """
    kind, inner = get_origin(form) or form, get_args(form)
    if dataclasses.is_dataclass(form):
        types, fields, unset = get_type_hints(form), dataclasses.fields(form), dataclasses.MISSING
        form = {f.name + "?" * (f.default != unset): types[f.name] for f in fields}
    base = type(form) if isinstance(form, dict | list) else list if kind is tuple else kind
    if kind is UnionType:
        if x is not None:
            require_form(x, inner[0], place)
        return
    fits = base is Any or (x in inner if kind is Literal else isinstance(x, base))
    if base is float:  # no number of a joint is larger, and the squares of these are finite
        fits = isinstance(x, int | float) and not isinstance(x, bool) and abs(x) < 1e100
    if not fits:
        one = f"one of {', '.join(map(repr, inner))}"
        words = one if kind is Literal else _WORDS.get(base, base.__name__)
        raise ParameterError(f"{place} is {x!r:.40}: it must be {words}")
    if base is dict:
        for key, own in (form if isinstance(form, dict) else dict.fromkeys(x, inner[1])).items():
            name = key.removesuffix("?")
            if name in x:
                require_form(x[name], own, f"{place}.{name}")
            elif name == key:
                raise ParameterError(f"{place}.{name} is missing")
    if base is list:
        for i, entry in enumerate(x):
            require_form(entry, (inner or form)[0], f"{place}.{i}")
