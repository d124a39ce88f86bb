"""A joint under a load in continuous time, by scipy: motion and law as one differential equation.

Written from the equations alone, with reversals, closings, resets and knots as events; variant
`ganseman1997`, first loading literal, both directions alike.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

RESET_MARGIN = 1e-3
# s to pass an event, so that it does not fire again at once
_PAST = 1e-9


class _Law:
    """What the law remembers; torques are mirrored, so that every motion is an upward one."""

    def __init__(self, p: Any, way: float) -> None:
        assert p.variant == "ganseman1997"
        assert p.virgin == "literal"
        self.p, self.way, self.base, self.virgin = p, way, 0.0, True
        self.tops: dict[float, list[float]] = {1.0: [], -1.0: []}  # maxima, mirrored minima
        z, self.Fd = np.array([(0.0, 0.0), *p.knots]).T
        self.slopes = np.diff(self.Fd) / np.diff(z)

    def level(self, speed: float) -> float:
        p = self.p
        return p.Fc_pos + (p.Fs_pos - p.Fc_pos) * np.exp(-((speed / p.Vs_pos) ** p.delta_pos))

    def rate(self, f: float, speed: float) -> float:
        """dz/dq."""
        r = (f - self.base) / (self.level(speed) - self.base)
        # trial steps of the solver may overshoot r = 1 by far
        return 1.0 - np.sign(r) * min(abs(r), 3.0) ** self.p.n

    def stiffness(self, f: float) -> float:
        k = int(np.searchsorted(self.Fd[1:], max(f - self.base, 0.0)))
        return self.slopes[min(k, len(self.slopes) - 1)]

    def outer(self) -> None:
        """The curve goes on from where it started."""
        self.base = -self.tops[-self.way][-1] if self.tops[-self.way] else -self.p.Fs_pos

    def reverse(self, f: float) -> float:
        self.tops[self.way].append(f)
        self.way, self.virgin, self.base = -self.way, False, -f
        return -f

    def close(self) -> float:
        f = self.tops[self.way].pop()
        if self.tops[-self.way]:
            self.tops[-self.way].pop()
        self.outer()
        return f

    def reset(self) -> None:
        self.tops[1.0].clear()
        self.tops[-1.0].clear()
        self.virgin = False
        self.outer()


def driven(
    p: Any, inertia: float, load: Callable[[float, float], float], time: np.ndarray
) -> np.ndarray:
    """Position and velocity of a joint that never moved, shape (2, n), at the times given, s.

    Args: load: N m, of time and position; at first it pulls the positive way.
    """
    law = _Law(p, 1.0)

    def slope(t, y):
        q, v, f = y
        speed = max(law.way * v, 0.0)
        rate = law.rate(f, speed)
        friction = law.way * f + (p.sigma1 * rate + p.sigma2_pos) * v
        return [v, (load(t, q) - friction) / inertia, law.stiffness(f) * rate * speed]

    def reversal(t, y):
        return law.way * y[1]

    def closing(t, y):
        return y[2] - law.tops[law.way][-1] if law.tops[law.way] else -1.0

    def reset(t, y):
        wiped = not (law.virgin or law.tops[1.0] or law.tops[-1.0])
        return -1.0 if wiped else y[2] - (1.0 - RESET_MARGIN) * law.level(law.way * y[1])

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
