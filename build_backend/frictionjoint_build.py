"""setuptools' build backend, which asks for a C compiler from PyPI where the machine has none."""

import os
import shutil
from typing import Any

from setuptools import build_meta
from setuptools.build_meta import *  # noqa: F403  the hooks that stay as they are


def _compiler() -> list[str]:
    own = os.environ.get("CC") or next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), "")
    other = os.environ.get("FRICTIONJOINT_TARGET")
    return ["ziglang>=0.13"] if other or not own else []


def get_requires_for_build_wheel(config_settings: Any = None) -> list[str]:
    """What a wheel needs beyond ``[build-system] requires``."""
    return [*build_meta.get_requires_for_build_wheel(config_settings), *_compiler()]


def get_requires_for_build_editable(config_settings: Any = None) -> list[str]:
    """The same of an editable install."""
    return [*build_meta.get_requires_for_build_editable(config_settings), *_compiler()]
