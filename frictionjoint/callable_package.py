"""Packages that can be called like the function of the same name.

``frictionjoint.identify`` is both a package and the function of the command `identify`. Python
binds a package to its name when one of its modules is imported, replacing a function of that name;
so the package itself is made callable.
"""

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from inspect import Signature

_CALLABLE = ("export", "identify")


class _CallablePackage(ModuleType):
    def __call__(self, *arguments: Any, **named: Any) -> Any:
        return _function(self)(*arguments, **named)

    @property
    def __signature__(self) -> "Signature":
        from inspect import signature

        return signature(_function(self))


class _Parent(ModuleType):
    def __setattr__(self, name: str, value: Any) -> None:
        if name in _CALLABLE and isinstance(value, ModuleType):
            value.__class__ = _CallablePackage
        super().__setattr__(name, value)


def make_callable(name: str) -> None:
    """Make packages in the package `name` callable as functions of `frictionjoint.commands`."""
    sys.modules[name].__class__ = _Parent


def _function(package: ModuleType) -> Any:
    from frictionjoint import commands

    return getattr(commands, package.__name__.rpartition(".")[2])
