"""How a change of the friction level reaches the torque: by motion, not by time.

The level bounds what a stuck contact can bear; it does not move the contact. While the joint
stands still the torque stays, however the level changes, and follows it over the presliding
distance once the joint moves. To first order in the change this is what LuGre's bristle does:
with dz/dx = 1 - sigma0 z/S, a level S + s adds the torque E with dE/d|x| = (s h - E) sigma0/S,
where h = sigma0 z/S.
"""

import math

from numba import njit


@njit(cache=True)
def approached(E: float, target: float, dq: float, reach: float) -> float:
    """E after a displacement dq on its way to `target`, over the length `reach`."""
    return E - (target - E) * math.expm1(-abs(dq) / reach)
