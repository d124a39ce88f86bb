"""Packages that can be called like the function of their name.

``frictionjoint.identify`` is a package and, as the command of this name, a function. Python binds a
package to its name when one of its modules is imported, whatever stood there before; so the package
itself takes the call.
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
    """Let calls of a package be calls of the function in `frictionjoint.commands` of its name."""
    sys.modules[name].__class__ = _CallablePackage


def _function(package: ModuleType) -> Any:
    from frictionjoint import commands

    return getattr(commands, package.__name__.rpartition(".")[2])
