"""Let friction act: for one model (`attach`), in the viewer, or in the whole process (`enable`).

MuJoCo has one ``mjcb_passive``, and our kernel serves every model with friction. A callback that
was there before is called first, at every evaluation, and is restored when the last hold ends. A
model with friction that is stepped without our callback is named in a warning.
"""

import importlib
import warnings
import weakref
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, cast

import mujoco

from frictionjoint.arguments import require_model
from frictionjoint.compiled import PLAIN, c_address
from frictionjoint.errors import FrictionJointError, ModelError
from frictionjoint.model_files import is_c
from frictionjoint.simulate.block import ROW, blocks
from frictionjoint.simulate.carrier import load_model, resolve
from frictionjoint.simulate.layout import LayoutMismatchError
from frictionjoint.simulate.mechanism import require_flags
from frictionjoint.simulate.native import CALLBACK, build_both, build_native, python_callback
from frictionjoint.simulate.native_friction import counts_twice, native_friction
from frictionjoint.simulate.row import STEP, T_EVALUATED

Backend = Literal["native", "python"]


@dataclass(eq=False)
class Hold:
    """A reason to keep the callback installed: an attached model, or `enable`.

    Attributes:
        previous: the callback found at its start, None without one. callback: that it installed.
        first, kernel: the user's callback within it, None without one, and ours.
        warned: whether a warning about a replaced callback was given.
    """

    previous: Any
    callback: Any
    first: Any
    kernel: Any
    warned: bool = False


# outermost first
_holds: list[Hold] = []
# models that were warned of, by address
_warned: set[int] = set()
_attached: dict[int, "Attached"] = {}
_enabled: list[Hold] = []


class Attached:
    """Friction of a model, acting until `detach` or the end of a ``with`` block; see `attach`.

    Attributes:
        model: the attached model; it is kept alive.
    """

    def __init__(self, model: mujoco.MjModel, entry: Hold) -> None:
        self.model = model
        self._hold: Hold | None = entry
        _warned.discard(model._address)
        _attached[model._address] = self

    def __repr__(self) -> str:
        joints = ", ".join(blocks(self.model))
        state = "acting" if self._hold else "detached"
        return f"Attached({state}, friction of {joints})"

    def detach(self) -> None:
        """Stop the friction; a previous callback acts alone again. A second call does nothing."""
        if self._hold is None:
            return
        _release(self._hold)
        self._hold = None
        del _attached[self.model._address]

    def __enter__(self) -> mujoco.MjModel:
        return self.model

    def __exit__(self, *raised: object) -> None:
        self.detach()


def attach(model: mujoco.MjModel, backend: Backend = "native") -> Attached:
    """Turn on the friction of `model` until ``detach()`` of the returned handle::

        h = attach(model)
        mujoco.mj_step(model, data)
        h.detach()

        with attach(model):                     # the same, also after an exception
            mujoco.mj_step(model, data)

    MuJoCo has one passive callback, and it serves every model with friction in the process. So
    several models may be attached at once and detached in any order, and a model that is compiled
    or copied meanwhile has its friction too. An existing passive callback is called before ours.

    Args:
        model: with friction, see `install`.
        backend: "native" (a C function, no GIL) or "python" (same kernel, slower). While the
            callback is a Python function, ours or your own, MuJoCo compiles no model.
    Raises:
        ModelError: no friction in the model, attached already, spring and damper flags both
            disabled (MuJoCo then never calls back), a disabled flag that an elastic joint or one
            with backlash needs, or an unknown backend.
        TypeError: `model` is no MjModel.
    """
    require_model(model, "attach")
    if model._address in _attached:
        raise ModelError("this model is attached already: detach it first")
    require_callback(model)
    found = resolve(model)
    if not found:
        raise ModelError("the model has no friction: use frictionjoint.install on its spec")
    for name in found:
        require_flags(model, name)
    native = native_friction(model, found)
    if native:
        warnings.warn(counts_twice(native), RuntimeWarning, stacklevel=2)
    return Attached(model, _hold(backend))


def enable(backend: Backend = "native") -> None:
    """Turn on friction in every model of this process that contains it.

    This includes models that other code loads and steps: the viewer, dm_control, Gymnasium, a
    trainer. Call it once, before or after they are loaded. A model whose friction cannot act
    (damaged, or too little user data) is named in a warning when it is first stepped. Models with
    both spring and damper flags disabled are never called back. For `backend` see `attach`.

    Raises:
        ModelError: an unknown backend.
    """
    if not _enabled:
        _enabled.append(_hold(backend))


def disable() -> None:
    """Undo `enable`; attached models keep their friction. Without `enable` it does nothing."""
    while _enabled:
        _release(_enabled.pop())


def view(path: str | Path) -> None:
    """Open the viewer on an MJCF with friction, until its window is closed.

    Models that are dragged into the window have their friction too.

    Raises:
        ModelError: as `load_model`.
        FrictionJointError: no viewer, or no display.
    """
    model = load_model(path)
    try:
        glfw = importlib.import_module("glfw")
        viewer = importlib.import_module("mujoco.viewer")
    except ImportError as error:
        raise FrictionJointError(
            f"MuJoCo's viewer cannot be loaded ({error}): pip install --force-reinstall mujoco glfw"
        ) from None
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ready = glfw.init()
    if not ready:
        # MuJoCo would end the process here, with no word of where it came from
        reason = f" ({'; '.join(str(w.message) for w in caught)})" if caught else ""
        raise FrictionJointError(
            f"the viewer finds no display{reason}: run it where windows can be opened"
        )
    with attach(model):
        viewer.launch(model, mujoco.MjData(model))


def require_callback(model: Any, caller: str = "MuJoCo") -> None:
    """Raise ModelError if a model's flags keep its simulation from calling a passive force."""
    if callback_is_off(model):
        raise ModelError(
            f"spring and damper flags are both disabled, so {caller} calls no passive force: "
            "enable one of them in <option><flag>"
        )


def callback_is_off(model: Any) -> bool:
    """Whether a model's flags keep MuJoCo from calling a passive force."""
    off = mujoco.mjtDisableBit.mjDSBL_SPRING | mujoco.mjtDisableBit.mjDSBL_DAMPER
    return bool((model.opt.disableflags & off) == off)


def warn_if_idle(model: mujoco.MjModel, data: mujoco.MjData, found: dict[str, int]) -> None:
    """Warn once per resolved model if it was stepped and its friction was not evaluated; `found`:
    addresses of its blocks by joint."""
    off = callback_is_off(model)
    if (_is_installed() and not off) or model._address in _warned:
        return
    row = int(model.numeric_data[next(iter(found.values())) + ROW])
    evaluated = float(data.userdata[row + T_EVALUATED]) if data.userdata[row + STEP] else 0.0
    # an attached model is evaluated at every step
    if data.time - evaluated <= 1.5 * model.opt.timestep:
        return
    _warned.add(model._address)
    weakref.finalize(model, _warned.discard, model._address)
    reason = "call frictionjoint.attach(model) or frictionjoint.enable() before stepping"
    if off:
        reason = (
            "the spring and damper flags are both disabled, so MuJoCo calls no passive force: "
            "enable one of them in model.opt.disableflags"
        )
    elif _replaced():
        reason = (
            "other code replaced MuJoCo's passive callback after frictionjoint set it: set yours "
            "before frictionjoint.attach, which calls it too"
        )
    warnings.warn(
        f"the friction of this model has not acted since {evaluated:.6g} s, and data.time is "
        f"{data.time:.6g} s: {reason}",
        RuntimeWarning,
        stacklevel=3,
    )


def _hold(backend: Backend) -> Hold:
    """Keep our callback installed until `_release`; the user's own is called before it."""
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


def _release(entry: Hold) -> None:
    """Undo one hold, in any order: one below the top passes its previous callback on. A callback of
    other code over ours stays."""
    _warn_if_replaced("the new callback stays")
    at = _holds.index(entry)
    del _holds[at]
    if at < len(_holds):
        if _holds[at].previous is entry.callback:
            _holds[at].previous = entry.previous
    elif mujoco.get_mjcb_passive() is entry.callback:
        mujoco.set_mjcb_passive(entry.previous)


def _is_installed() -> bool:
    """Whether MuJoCo calls our callback directly."""
    current = mujoco.get_mjcb_passive()
    return any(entry.callback is current for entry in _holds)


def _replaced() -> bool:
    """Whether other code has set a passive callback since our last hold began."""
    return bool(_holds) and not _is_installed()


def _warn_if_replaced(what_now: str) -> None:
    if not _replaced() or _holds[-1].warned:
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
    # C supports one user callback at a time
    others = {c_address(x.first) for x in _holds if x.first is not None and is_c(x.first)}
    if is_c(first) and kernel is not python_callback and others <= {c_address(first)}:
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
