"""Install the friction callback for a while: ``with attach(model): ...``."""

import contextlib
import functools
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

import mujoco

from frictionjoint.errors import ModelError
from frictionjoint.simulate.callback import build_native, link_what_acts, python_callback
from frictionjoint.simulate.carrier import resolve
from frictionjoint.simulate.layout import LayoutMismatchError

Backend = Literal["native", "python"]


@dataclass
class _Attached:
    """A model attached now, by the address of its C structure, and the callback it replaced."""

    address: int
    previous: Any


# outermost first; a second attach of one model is a mistake
_attached: list[_Attached] = []


@functools.lru_cache(maxsize=1)
def _native() -> Any:
    return build_native()


def _callback(backend: Backend, model: mujoco.MjModel, blocks: Iterable[int]) -> Any:
    if backend == "python":
        return python_callback
    try:
        native = _native()
        link_what_acts(model, blocks)
        return native.ctypes
    except LayoutMismatchError as error:
        warnings.warn(f"{error}: using the slower backend='python'", RuntimeWarning, stacklevel=4)
        return python_callback


@contextlib.contextmanager
def attach(model: mujoco.MjModel, backend: Backend = "native") -> Iterator[mujoco.MjModel]:
    """Friction of `model` acts inside the block; the previous callback returns after it.

    The callback serves every model in the process that carries friction and leaves all others
    alone, so several models may be attached at once, and left in any order.

    Args:
        model: carries friction, see `install`.
        backend: "native" (a C function, no GIL) or "python" (same kernel, slower).
    Raises:
        ModelError: no friction in the model, attached already, spring and damper flags both
            disabled (MuJoCo then never calls back), or an unknown backend.
    """
    if backend not in ("native", "python"):
        raise ModelError(f"unknown backend {backend!r}: use 'native' or 'python'")
    if any(entry.address == model._address for entry in _attached):
        raise ModelError("this model is attached already: leave the first attach before")
    off = mujoco.mjtDisableBit.mjDSBL_SPRING | mujoco.mjtDisableBit.mjDSBL_DAMPER
    if (model.opt.disableflags & off) == off:
        raise ModelError(
            "spring and damper flags are both disabled, so MuJoCo calls no passive force: "
            "enable one of them in <option><flag>"
        )
    found = resolve(model)
    if not found:
        raise ModelError("the model carries no friction: use frictionjoint.install on its spec")
    callback = _callback(backend, model, found.values())
    entry = _Attached(model._address, mujoco.get_mjcb_passive())
    mujoco.set_mjcb_passive(callback)
    _attached.append(entry)
    try:
        yield model
    finally:
        _leave(entry)


def _leave(entry: _Attached) -> None:
    """Undo one attach. Environments end in any order, so one below the top only hands down."""
    at = next(i for i, other in enumerate(_attached) if other is entry)
    if at + 1 < len(_attached):
        _attached[at + 1].previous = entry.previous
    else:
        mujoco.set_mjcb_passive(entry.previous)
    del _attached[at]
