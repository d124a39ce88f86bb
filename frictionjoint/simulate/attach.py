"""Let friction act: for one model (`attach`), or for every model of the process (`enable`)."""

import warnings

import mujoco

from frictionjoint.arguments import require_model
from frictionjoint.errors import ModelError
from frictionjoint.simulate.block import blocks
from frictionjoint.simulate.carrier import resolve
from frictionjoint.simulate.installed import (
    Backend,
    Hold,
    forget_warning,
    hold,
    release,
    require_callback,
)
from frictionjoint.simulate.mechanism import require_flags
from frictionjoint.simulate.native_friction import counts_twice, native_friction

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
        forget_warning(model)
        _attached[model._address] = self

    def __repr__(self) -> str:
        joints = ", ".join(blocks(self.model))
        state = "acting" if self._hold else "detached"
        return f"Attached({state}, friction of {joints})"

    def detach(self) -> None:
        """Stop the friction; a previous callback acts alone again. A second call does nothing."""
        if self._hold is None:
            return
        release(self._hold)
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

    MuJoCo has one passive callback, and it serves every model with friction in the process; models
    without friction are unaffected. So several models may be attached at once and detached in any
    order, and a model that is compiled or copied meanwhile has its friction too. An existing
    passive callback keeps working: it is called before ours.

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
    return Attached(model, hold(backend))


def enable(backend: Backend = "native") -> None:
    """Turn on friction in every model of this process that contains it.

    This includes models that other code loads and steps: the viewer, dm_control, Gymnasium, a
    trainer. Call it once, before or after they are loaded. A model whose friction cannot act
    (damaged, or too little user data) is named in a warning when it is first stepped. Models with
    both spring and damper flags disabled are never called back.

    Args:
        backend: as in `attach`.
    Raises:
        ModelError: an unknown backend.
    """
    if not _enabled:
        _enabled.append(hold(backend))


def disable() -> None:
    """Undo `enable`; attached models keep their friction. Without `enable` it does nothing."""
    while _enabled:
        release(_enabled.pop())
