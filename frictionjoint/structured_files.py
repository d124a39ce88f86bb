"""Content of TOML and JSON files, with one error for a file that is missing or damaged."""

import dataclasses
import json
import math
import tomllib
from collections.abc import Iterator
from pathlib import Path
from types import UnionType
from typing import Any, Literal, get_args, get_origin, get_type_hints

from frictionjoint.errors import ParameterError


def read_toml(path: Path, fix: str = "") -> dict[str, Any]:
    """Content of a TOML file.

    Args:
        fix: what the user should do if there is no such file, after its reason.
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
        raise ParameterError(f"{path}: not TOML: {error}") from None


def read_json(path: Path, fix: str) -> Any:
    """Content of a JSON file.

    Args:
        fix: what the user should do if it is no JSON.
    Raises:
        ParameterError: the file is missing, or no JSON.
    """
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ParameterError(f"{path}: cannot be read: {error.strerror}") from None
    except (ValueError, RecursionError):
        raise ParameterError(f"{path}: not JSON: {fix}") from None


def misfits(x: Any, form: Any, place: str) -> Iterator[str]:
    """Each entry of a JSON file's content that has another form, and the form it must have.

    Args:
        form: a type, a Literal, a dataclass; forms by key, where "key?" may be missing; or, in a
            list, the form of all entries of a list.
        place: of `x` in the file.
    """
    kind, inner = get_origin(form) or form, get_args(form)
    if dataclasses.is_dataclass(form):
        types, fields, unset = get_type_hints(form), dataclasses.fields(form), dataclasses.MISSING
        form = {f.name + "?" * (f.default != unset): types[f.name] for f in fields}
    if isinstance(form, dict) or kind is dict:
        if not isinstance(x, dict):
            yield f"{place} is {x!r:.40}: it must be a table"
            return
        for key, own in (form if isinstance(form, dict) else dict.fromkeys(x, inner[1])).items():
            name = key.removesuffix("?")
            if name in x:
                yield from misfits(x[name], own, f"{place}.{name}")
            elif name == key:
                yield f"{place}.{name} is missing"
    elif isinstance(form, list) or kind in (list, tuple):
        for i, entry in enumerate(x if isinstance(x, list) else ()):
            yield from misfits(entry, (inner or form)[0], f"{place}.{i}")
        if not isinstance(x, list):
            yield f"{place} is {x!r:.40}: it must be a list"
    elif kind is UnionType:
        if all(any(misfits(x, one, place)) for one in inner):
            yield from misfits(x, inner[0], place)
    elif kind is Literal:
        if x not in inner:
            yield f"{place} is {x!r:.40}: it must be one of {', '.join(map(repr, inner))}"
    elif kind is float:
        if isinstance(x, bool) or not isinstance(x, int | float) or not math.isfinite(x):
            yield f"{place} is {x!r:.40}: it must be a finite number"
    elif form is not Any and not isinstance(x, kind):
        yield f"{place} is {x!r:.40}: it must be {'text' if kind is str else kind.__name__}"
