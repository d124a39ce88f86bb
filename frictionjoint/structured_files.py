"""Content of TOML and JSON files, with one error for a file that is missing or damaged."""

import json
import tomllib
from pathlib import Path
from typing import Any

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
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
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
