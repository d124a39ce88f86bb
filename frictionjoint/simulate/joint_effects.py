"""Torque of the effects beyond the law, as added by the callbacks."""

import numpy as np

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, in_line, room
from frictionjoint.effects import signals
from frictionjoint.effects.catalogue import SIMULATED
from frictionjoint.effects.heating import EFFECT as HEATING
from frictionjoint.effects.kernel import MEMORY, total_torque
from frictionjoint.law import bristle
from frictionjoint.law.kernel import coulomb_level, hysteresis_torque, levels_at, presliding
from frictionjoint.law.kernel import row_size as law_row_size
from frictionjoint.law.stribeck import SIGMA2
from frictionjoint.simulate import row

_HEATING = float(HEATING.effect_id)
_LOADED = tuple(
    float(effect.effect_id)
    for effect in SIMULATED
    if effect.acts == "torque" and {signals.LOAD, signals.GEAR} & {*effect.needs}
)


@compiled
def effects_torque(
    P: Vector,
    p: int,
    effects: int,
    X: Vector,
    x: int,
    t: float,
    q: float,
    v: float,
    bias: float,
    inertia: float,
    armature: float,
    gx: float,
    gy: float,
    asked: float,
) -> float:
    """Torque of a block's effects at one instant; writes the evaluated memory, and adds the
    implicit part of effects that raise the friction level to the GAIN of the row.

    The gear transmits `bias` (forces of gravity, of the motion of other joints and of contacts)
    plus the inertia behind the gear (the joint's inertia without its armature) times the
    acceleration since the committed point. The load of the joint also contains the armature times
    this acceleration. `asked` is the torque command of the joint's motors before saturation. An
    effect `heating` is evaluated first, with the friction loss since the committed point.
    """
    sig = room(signals.N_SIGNALS)
    dt = t - X[x + row.T_COMMITTED]
    sig[signals.TIME] = t
    sig[signals.Q] = q
    sig[signals.V] = v
    sig[signals.A] = (v - X[x + row.V_COMMITTED]) / dt if dt > 0.0 else 0.0
    sig[signals.GEAR] = bias + inertia * sig[signals.A]
    sig[signals.LOAD] = sig[signals.GEAR] + armature * sig[signals.A]
    sig[signals.GX] = gx
    sig[signals.GY] = gy
    sig[signals.DT] = dt
    sig[signals.HALT] = (inertia + armature) / dt if dt > 0.0 else 0.0
    sig[signals.ASKED] = asked
    sig[signals.TEMP] = np.nan  # until `heating` says it
    sig[signals.RAISED] = 0.0
    law = x + row.FRONT
    level = coulomb_level(P, p)
    K, _sigma1 = presliding(P, p)
    Fh = hysteresis_torque(P, p, X, law)
    sig[signals.H] = Fh / level
    sig[signals.ONSET] = level / K
    n = MEMORY * int(P[effects])
    memory = law + law_row_size(P, p)
    for i in range(n):
        X[memory + n + i] = X[memory + i]
    heats = P[effects + 1] == _HEATING
    if heats:
        # the work of the last step over its time; its second number is the torque of the effects
        acted = X[x + row.TORQUE_COMMITTED] + X[x + row.GAIN_COMMITTED] * v + X[memory + 1]
        sig[signals.LOSS] = acted * (q - X[x + row.Q_COMMITTED]) / dt if dt > 0.0 else 0.0
    total = total_torque(P, effects, sig, X, memory + n, memory + 2 * n)
    if heats:
        X[memory + n + 1] = total
    # a torque proportional to that of the law is a spring as the law is, implicit with it
    levels = levels_at(P, p)
    if sig[signals.RAISED] * Fh > 0.0:
        damping = P[levels] + P[bristle.side(levels, v) + SIGMA2]
        X[x + row.GAIN] += max(0.0, X[x + row.GAIN] - damping) * sig[signals.RAISED] / Fh
    return total


@compiled
def asks_for_load(P: Vector, effects: int) -> int:
    """Index of the first effect of the block at P[effects] that depends on the load, or -1."""
    at = effects + 1
    for i in range(int(P[effects])):
        for k in range(len(_LOADED)):
            if P[at] == _LOADED[k]:
                return i
        at += 2 + int(P[at + 1])
    return -1


@in_line
def coupled_load(
    P: Vector, p: int, X: Vector, x: int, effect: int, later: bool, others: float
) -> float:
    """Contribution of other joints and contacts to the load of a gear, N m.

    The first call at a later time stores `others`, which is computed from the accelerations and
    constraint forces that MuJoCo still stores from the last step, in the part of the memory of
    `effect` that this effect does not use. At a start it is zero.
    """
    at = x + row.FRONT + law_row_size(P, p) + MEMORY * effect + MEMORY - 1
    if later and X[x + row.T_EVALUATED] > X[x + row.T_COMMITTED]:
        X[at] = others
    return X[at]


@compiled
def unit_gravity(
    axes: Vector, world: Vector, at: int, gravity: Vector, R: Vector, r: int
) -> tuple[float, float]:
    """Torque to hold 1 kg at 1 m along each of the body's two axes across the joint.

    axes[at:at+3] the joint's axis in the body, world[at:at+3] in the world, R[r:r+9] the body's
    rotation. The two axes are those of ``identify.rigid_body``.
    """
    ax, ay, az = axes[at], axes[at + 1], axes[at + 2]
    wx, wy, wz = world[at], world[at + 1], world[at + 2]
    gx, gy, gz = gravity[0], gravity[1], gravity[2]
    # helper: the coordinate axis the joint's axis leans on least
    hx = hy = hz = 0.0
    if abs(ax) <= abs(ay) and abs(ax) <= abs(az):
        hx = 1.0
    elif abs(ay) <= abs(az):
        hy = 1.0
    else:
        hz = 1.0
    e1x, e1y, e1z = ay * hz - az * hy, az * hx - ax * hz, ax * hy - ay * hx
    norm = (e1x * e1x + e1y * e1y + e1z * e1z) ** 0.5
    e1x, e1y, e1z = e1x / norm, e1y / norm, e1z / norm
    e2x, e2y, e2z = ay * e1z - az * e1y, az * e1x - ax * e1z, ax * e1y - ay * e1x
    tx, ty, tz = gy * wz - gz * wy, gz * wx - gx * wz, gx * wy - gy * wx
    bx = tx * R[r] + ty * R[r + 3] + tz * R[r + 6]
    by = tx * R[r + 1] + ty * R[r + 4] + tz * R[r + 7]
    bz = tx * R[r + 2] + ty * R[r + 5] + tz * R[r + 8]
    return (-(bx * e1x + by * e1y + bz * e1z), -(bx * e2x + by * e2y + bz * e2z))
