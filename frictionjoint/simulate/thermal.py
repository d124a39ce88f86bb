"""Read and set the thermal state of joints with temperature-dependent friction.

`temperature-dependent` and `motor-temperature` stay at their references until `set_temperature`
changes them, or follow `heating`. The state of `warm-up-drift` is the fraction of the warm-up that
has happened.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import mujoco

from frictionjoint.arguments import require_data
from frictionjoint.arrays import Array
from frictionjoint.effects import heating, warm_up_drift
from frictionjoint.effects.catalogue import SIMULATED
from frictionjoint.effects.kernel import MEMORY
from frictionjoint.effects.signals import TEMP
from frictionjoint.errors import ModelError
from frictionjoint.law.kernel import row_size as law_row_size
from frictionjoint.simulate.block import EFFECTS, HEAD, ROW, effects_of
from frictionjoint.simulate.carrier import resolve
from frictionjoint.simulate.row import FRONT, STEP


class _Kind(NamedTuple):
    """Thermal state from (numbers, memory, time) of an effect, and memory with the state given."""

    read: Callable[[Array, float, float], float]
    write: Callable[[Array, float, float], float]


def _warm(i: int, timed: float = 0.0) -> _Kind:
    """Warmth that approaches 1 with the constant P[i], by loss or, if `timed` is 1, by time."""
    return _Kind(
        lambda P, x, t: -math.expm1(-(timed * t + x) / P[i]),
        lambda P, warm, t: -P[i] * math.log1p(-warm) - timed * t,
    )


_ABOVE = _Kind(lambda P, x, t: float(P[0]) + x, lambda P, celsius, t: celsius - float(P[0]))
# by the state, the effects that have it
_KINDS = {
    "temperature": {
        float(effect.effect_id): _ABOVE
        for effect in SIMULATED
        if effect is heating.EFFECT or TEMP in effect.needs
    },
    "warmth": {
        float(warm_up_drift.EFFECT.effect_id): _warm(0, timed=1.0),
        float(warm_up_drift.BY_LOSS.effect_id): _warm(1),
        float(warm_up_drift.BY_WHOLE_LOSS.effect_id): _warm(0),
    },
}


def temperature(model: mujoco.MjModel, data: mujoco.MjData) -> dict[str, float]:
    """Temperature, deg C, of each joint with `heating` or a temperature-dependent effect.

    Args:
        model: with friction. data: of that model, evaluated at least once.
    Raises:
        ModelError: no joint has a temperature, or the data have not been evaluated.
        TypeError: no MjModel or MjData.
    """
    return _read(model, data, "temperature")


def temperature_setters(
    model: mujoco.MjModel, data: mujoco.MjData
) -> dict[str, Callable[[float], None]]:
    """By joint with a temperature: a function that sets it, deg C, faster than `set_temperature`,
    in data that were evaluated at least once."""
    if not any(_of_block(model.numeric_data, b, "temperature") for b in resolve(model).values()):
        return {}
    found = _places(model, data, "temperature")
    return {name: partial(_put, data, places) for name, places in found.items()}


def set_temperature(model: mujoco.MjModel, data: mujoco.MjData, joint: str, celsius: float) -> None:
    """Set the temperature of a joint; `heating` continues from it.

    Raises: as `temperature`; ModelError, if the joint has none.
    """
    _write(model, data, "temperature", joint, celsius)


def temperature_of(P: Array, block: int, X: Array) -> float | None:
    """Temperature, deg C, of the joint whose block is at P[block:]; None if it has none."""
    for kind, numbers, _, evaluated in _of_block(P, block, "temperature"):
        return kind.read(numbers, float(X[evaluated]), math.nan)  # it depends on no time
    return None


def warmth(model: mujoco.MjModel, data: mujoco.MjData) -> dict[str, float]:
    """Warm-up state of each joint with `warm-up-drift`: 0 cold, 1 fully warm.

    Args, Raises: as `temperature`.
    """
    return _read(model, data, "warmth")


def set_warmth(model: mujoco.MjModel, data: mujoco.MjData, joint: str, warm: float) -> None:
    """Set the warm-up state of a joint with `warm-up-drift`, 0 to below 1.

    Raises: as `temperature`; ModelError, if the joint has none, or a value is outside [0, 1).
    """
    if not 0.0 <= warm < 1.0:
        raise ModelError(f"joint {joint!r}: warmth is {warm}: give 0 or more, below 1")
    _write(model, data, "warmth", joint, warm)


class _Place(NamedTuple):
    """An effect with a thermal state: its numbers, and the two places of its memory."""

    kind: _Kind
    numbers: Array
    committed: int
    evaluated: int


def _places(model: mujoco.MjModel, data: mujoco.MjData, what: str) -> dict[str, list[_Place]]:
    """The effects of each joint with a state."""
    require_data(data, model, what)
    P, found = model.numeric_data, {}
    for name, block in resolve(model).items():
        places = _of_block(P, block, what)
        if places and data.userdata[int(P[block + ROW]) + STEP] == 0.0:
            raise ModelError(
                f"joint {name!r} has no {what} yet: attach the model and call mj_forward first"
            )
        if places:
            found[name] = places
    if not found:
        raise ModelError(f"no joint of the model has an effect that depends on {what}")
    return found


def _of_block(P: Array, block: int, what: str) -> list[_Place]:
    found, kinds = effects_of(P, block + int(P[block + EFFECTS])), _KINDS[what]
    memory = int(P[block + ROW]) + FRONT + int(law_row_size(P, block + HEAD))
    return [
        _Place(kinds[effect], P[at:], memory + MEMORY * i, memory + MEMORY * (i + len(found)))
        for i, (effect, at) in enumerate(found)
        if effect in kinds
    ]


def _read(model: mujoco.MjModel, data: mujoco.MjData, what: str) -> dict[str, float]:
    return {
        name: kind.read(numbers, float(data.userdata[evaluated]), data.time)
        for name, [(kind, numbers, _, evaluated), *_] in _places(model, data, what).items()
    }


def _write(model: mujoco.MjModel, data: mujoco.MjData, what: str, joint: str, value: float) -> None:
    found = _places(model, data, what)
    if joint not in found:
        raise ModelError(f"joint {joint!r} has no {what}: choose from {', '.join(found)}")
    _put(data, found[joint], value)


def _put(data: mujoco.MjData, places: list[_Place], value: float) -> None:
    for kind, numbers, committed, evaluated in places:
        x = kind.write(numbers, value, data.time)
        data.userdata[committed] = data.userdata[evaluated] = x
