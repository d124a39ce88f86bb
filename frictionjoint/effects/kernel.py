"""One entry point for all effects, for logs and simulations.

A block ``P[e:]`` contains the number of effects, then per effect its id, the count of its numbers
and the numbers (shape first, then coefficients). Memory ``X[x:]`` has `MEMORY` numbers per effect.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled, define, pointer, room
from frictionjoint.effects.catalogue import SIMULATED
from frictionjoint.effects.signals import RAISED, SHARE

MEMORY = 3


# A kernel cannot use a table of functions, so a chain of conditions selects that of an effect.
_KERNELS = {e.effect_id: e.kernel for e in sorted(SIMULATED, key=lambda e: e.effect_id)}
_HEAD = '''
@compiled
def effect_torque(effect_id: int, P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """Torque of one effect, selected by its id."""
'''
_CHOICE = """    if effect_id == {0}:
        return kernel_{0}(P, e, sig, X, x)
"""
_space: dict[str, Any] = {
    **{"compiled": compiled, "Vector": Vector, "np": np, "__name__": __name__},
    **{f"kernel_{number}": kernel for number, kernel in _KERNELS.items()},
}
_SCALES = """
@compiled
def scales_level(effect_id: int) -> bool:
    return bool({})
"""
_scaling = [e.effect_id for e in SIMULATED if e.entry == "scales the friction level"]
_text = "".join([_HEAD, *map(_CHOICE.format, _KERNELS), "    return np.nan\n"])
_text += _SCALES.format(" or ".join(f"effect_id == {number}" for number in sorted(_scaling)))
define(_text, f"effect_torque of {__name__}", _space)
effect_torque: Callable[[int, Vector, int, Vector, Vector, int], float] = _space["effect_torque"]
"""Torque of one effect, selected by its id: arguments effect_id, P, e, sig, X, x."""
scales_level: Callable[[int], bool] = _space["scales_level"]
"""Whether an effect has a torque proportional to that of the law, see `Effect.entry`."""


@compiled
def total_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int, each: int) -> float:
    """Sum over the block's effects in a simulation; X[each:] becomes the torque of each, and
    sig[RAISED] is filled.

    Effects that act through the mechanism or the sensors add no torque.
    """
    total = 0.0
    at = e + 1
    for i in range(int(P[e])):
        effect_id = int(P[at])
        X[each + i] = 0.0
        if effect_id != 14 and effect_id != 19 and effect_id != 20:
            sig[SHARE] = 1.0
            X[each + i] = effect_torque(effect_id, P, at + 2, sig, X, x + MEMORY * i)
            if scales_level(effect_id):
                sig[RAISED] += sig[SHARE] * X[each + i]
        total += X[each + i]
        at += 2 + int(P[at + 1])
    return total


# releases the GIL: a search computes columns in parallel
@compiled
def _fill(effect_id: int, numbers: Array, signals: Array, out: Array) -> None:
    """Torque of one effect; column j of `out` uses row j of its numbers."""
    X, start = room(MEMORY), 0
    for c in range(len(numbers)):
        P = pointer(numbers, c * numbers.shape[1])
        for i in range(MEMORY):
            X[i] = 0.0
        for k in range(signals.shape[0]):
            sig = pointer(signals, k * signals.shape[1])
            out[k, c] = effect_torque(effect_id, P, start, sig, X, start)
    if effect_id == 19:
        # means over the interval before each sample become means around each sample
        for k in range(len(out) - 1):
            for c in range(out.shape[1]):
                out[k, c] = 0.5 * (out[k, c] + out[k + 1, c])


def torques(effect_id: int, shape: tuple[float, ...], coefficients: Array, signals: Array) -> Array:
    """Torque along a log, shape (n, m).

    Args:
        coefficients: linear ones, shape (m, k). signals: shape (n, N_SIGNALS).
    """
    numbers = np.empty((len(coefficients), len(shape) + coefficients.shape[1]))
    numbers[:, : len(shape)], numbers[:, len(shape) :] = shape, coefficients
    out = np.empty((len(signals), len(coefficients)))
    _fill(effect_id, numbers, np.ascontiguousarray(signals), out)
    return out


def columns(effect_id: int, shape: tuple[float, ...], n_coefficients: int, signals: Array) -> Array:
    """Torque per unit of each coefficient along a log, shape (n, n_coefficients)."""
    return torques(effect_id, shape, np.eye(n_coefficients), signals)
