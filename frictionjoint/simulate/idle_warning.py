"""Warnings about a model with friction that is stepped without our callback."""

import warnings
import weakref

import mujoco

from frictionjoint.simulate.block import ROW
from frictionjoint.simulate.installed import is_installed, replaced
from frictionjoint.simulate.row import STEP, T_EVALUATED

# models that were warned of, by address
_warned: set[int] = set()


def callback_is_off(model: mujoco.MjModel) -> bool:
    """Whether a model's flags keep MuJoCo from calling a passive force."""
    off = mujoco.mjtDisableBit.mjDSBL_SPRING | mujoco.mjtDisableBit.mjDSBL_DAMPER
    return bool((model.opt.disableflags & off) == off)


def warn_if_idle(model: mujoco.MjModel, data: mujoco.MjData, found: dict[str, int]) -> None:
    """Warn once per resolved model if it was stepped and its friction was not evaluated; `found`:
    addresses of its blocks by joint."""
    off = callback_is_off(model)
    if (is_installed() and not off) or model._address in _warned:
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
    elif replaced():
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


def forget_warning(model: mujoco.MjModel) -> None:
    """Allow the warning again for a model at this address, which is attached now."""
    _warned.discard(model._address)
