"""A joint under a load in continuous time, by scipy: motion and law as one differential equation.

With reversals, closings, resets and knots as events; viscous friction of the positive direction.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from reference.continuous import ContinuousLaw
from scipy.integrate import solve_ivp

# s to pass an event, so that it does not fire again at once
_PAST = 1e-9


def driven(
    p: Any, inertia: float, load: Callable[[float, float], float], time: np.ndarray
) -> np.ndarray:
    """Position and velocity of a joint that never moved, shape (2, n), at the times given, s.

    Args: load: N m, of time and position; at first it pulls the positive way.
    """
    law = ContinuousLaw(p, 1.0)

    def slope(t, y):
        q, v, f = y
        speed = max(law.way * v, 0.0)
        rate = law.rate(f, speed)
        friction = law.way * f + (p.sigma1 * rate + p.sigma2_pos) * v
        return [v, (load(t, q) - friction) / inertia, law.stiffness(f) * rate * speed]

    def reversal(t, y):
        return law.way * y[1]

    def closing(t, y):
        return law.beyond_closing(y[2])

    def reset(t, y):
        return law.beyond_reset(y[2], max(law.way * y[1], 0.0))

    def knot(t, y):
        away = y[2] - law.base - law.Fd[1:-1]
        return np.prod(np.sign(away)) * np.abs(away).min()

    for event, way in ((reversal, -1), (closing, 1), (reset, 1), (knot, 0)):
        event.terminal, event.direction = True, way
    out, t, y = np.zeros((2, len(time))), time[0], np.zeros(3)
    while t < time[-1]:
        wanted = time[time > t]
        found = solve_ivp(
            slope,
            (t, time[-1]),
            y,
            method="Radau",
            max_step=0.01,
            t_eval=wanted,
            rtol=1e-7,
            atol=[1e-11, 1e-9, 1e-8],
            events=(reversal, closing, reset, knot),
        )
        assert found.status >= 0, found.message
        if len(found.t):
            first = len(time) - len(wanted)
            out[:, first : first + len(found.t)] = found.y[:2]
        hit = next((i for i, x in enumerate(found.t_events) if len(x)), None)
        if hit is None:
            break
        t, y = float(found.t_events[hit][0]), found.y_events[hit][0]
        if hit == 0:
            y[2] = law.reverse(y[2])
            y[1] = 1e-13 * law.way
        elif hit == 1:
            y[2] = law.close()
        elif hit == 2:
            law.reset()
        y = y + _PAST * np.array(slope(t, y))
        t += _PAST
    return out
