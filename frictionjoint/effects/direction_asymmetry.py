"""direction-asymmetry: friction levels that differ between the two directions."""

from numba import njit

from frictionjoint.arrays import Vector
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import H, V


@njit(cache=True)
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """(dF |H| + dsigma2 |v|): half the difference between the directions."""
    return P[e] * abs(sig[H]) + P[e + 1] * abs(sig[V])


EFFECT = Effect(
    name="direction-asymmetry",
    effect_id=5,
    coefficients=("level", "viscous"),
    units=("T", "T s/x"),
    cause="gear tooth flanks, seals and preload that act differently each way",
    form="dF |Fh/Fc| + dsigma2 |v|, half the difference between the directions",
    source="Ganseman et al. (1997), own parameters for each direction",
    signature="even in velocity, zero at rest before breakaway, grows with speed",
    separating_motion="both directions at two speeds, with stops in between",
    entry="scales the friction level",
)
