"""Packages that can be called like the function of the same name.

``frictionjoint.identify`` is both a package and the function of the command `identify`. Python
binds a package to its name when one of its modules is imported, replacing a function of that name;
so the package itself is made callable.
"""

import inspect
import sys
from types import ModuleType
from typing import Any


class _CallablePackage(ModuleType):
    def __call__(self, *arguments: Any, **named: Any) -> Any:
        return _function(self)(*arguments, **named)

    @property
    def __signature__(self) -> inspect.Signature:
        return inspect.signature(_function(self))


def make_callable(name: str) -> None:
    """Forward calls of a package to the function of its name in `frictionjoint.commands`."""
    sys.modules[name].__class__ = _CallablePackage


def _function(package: ModuleType) -> Any:
    from frictionjoint import commands

    return getattr(commands, package.__name__.rpartition(".")[2])
