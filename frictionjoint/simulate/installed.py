"""The single passive callback of the process: the user's, then ours.

MuJoCo has one ``mjcb_passive``. Our kernel serves every model with friction, so it is installed
once, however many models are attached. A callback that was there before is called first, at every
evaluation, and is restored when the last hold ends.
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, cast

import mujoco

from frictionjoint.compiled import PLAIN, c_address
from frictionjoint.errors import ModelError
from frictionjoint.model_files import is_c
from frictionjoint.simulate.callback import python_callback
from frictionjoint.simulate.layout import LayoutMismatchError
from frictionjoint.simulate.native import CALLBACK, build_both, build_native

Backend = Literal["native", "python"]


@dataclass(eq=False)
class Hold:
    """A reason to keep the callback installed: an attached model, or `enable`.

    Attributes:
        previous: the callback found at its start, None without one.
        callback: the callback it installed. first: the user's callback within it, None without one.
        kernel: ours within it. warned: whether a warning about a replaced callback was given.
    """

    previous: Any
    callback: Any
    first: Any
    kernel: Any
    warned: bool = False


# outermost first
_holds: list[Hold] = []


def hold(backend: Backend) -> Hold:
    """Keep our callback installed until `release`; the user's own is called before it.

    Raises:
        ModelError: an unknown backend.
    """
    kernel = _kernel(backend)
    _warn_if_replaced("from now on friction acts again, and the other one is called first")
    current = mujoco.get_mjcb_passive()
    ours = next((entry for entry in _holds if entry.callback is current), None)
    first = ours.first if ours else current
    served = ours is not None and ours.kernel is kernel
    callback = current if served else _in_turn(first, kernel)
    entry = Hold(current, callback, first, kernel)
    mujoco.set_mjcb_passive(callback)
    _holds.append(entry)
    return entry


def release(entry: Hold) -> None:
    """Undo one hold. Holds may end in any order; one below the top passes its previous callback on.

    A callback that other code installed over ours stays.
    """
    _warn_if_replaced("the new callback stays")
    at = _holds.index(entry)
    del _holds[at]
    if at < len(_holds):
        if _holds[at].previous is entry.callback:
            _holds[at].previous = entry.previous
    elif mujoco.get_mjcb_passive() is entry.callback:
        mujoco.set_mjcb_passive(entry.previous)


def is_installed() -> bool:
    """Whether MuJoCo calls our callback directly."""
    current = mujoco.get_mjcb_passive()
    return any(entry.callback is current for entry in _holds)


def replaced() -> bool:
    """Whether other code has set a passive callback since our last hold began."""
    return bool(_holds) and not is_installed()


def _warn_if_replaced(what_now: str) -> None:
    if not replaced() or _holds[-1].warned:
        return
    _holds[-1].warned = True
    warnings.warn(
        "other code replaced MuJoCo's passive callback after frictionjoint set it; since then "
        f"friction acts only if the new callback calls ours: {what_now}",
        RuntimeWarning,
        stacklevel=4,
    )


def _kernel(backend: Backend) -> Any:
    if backend not in ("native", "python"):
        raise ModelError(f"unknown backend {backend!r}: use 'native' or 'python'")
    if backend == "python" or PLAIN:
        return python_callback
    try:
        return build_native()
    except LayoutMismatchError as error:
        warnings.warn(f"{error}: using the slower backend='python'", RuntimeWarning, stacklevel=4)
        return python_callback


def _in_turn(first: Any, kernel: Any) -> Any:
    """One callback that calls two; in C if both are C, so that no thread waits for Python."""
    if first is None:
        return kernel
    if is_c(first) and kernel is not python_callback and _is_free(first):
        return build_both(first)
    calls = tuple(map(_from_python, (first, kernel)))

    def both(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        for call in calls:
            call(model, data)

    return both


def _from_python(callback: Any) -> Callable[[mujoco.MjModel, mujoco.MjData], None]:
    if not is_c(callback):
        return cast("Callable[[mujoco.MjModel, mujoco.MjData], None]", callback)
    function = CALLBACK(c_address(callback))
    return lambda model, data: function(model._address, data._address)


def _is_free(first: Any) -> bool:
    """Whether C can call this callback first; it supports one user callback at a time."""
    others = (hold.first for hold in _holds if hold.first is not None and is_c(hold.first))
    return all(c_address(other) == c_address(first) for other in others)
