"""The law in continuous time along a smooth motion, by scipy: what ever finer steps tend to.

Only the terms in Fh; written from the equations, with reversals, closings and resets as events.
"""

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

RESET_MARGIN = 1e-3


class ContinuousLaw:
    """What the law remembers; torques are mirrored, so that every motion is an upward one."""

    def __init__(self, p, way: float) -> None:
        self.p, self.way, self.base, self.virgin = p, way, 0.0, True
        self.tops: dict[float, list[float]] = {1.0: [], -1.0: []}  # maxima, mirrored minima
        z, self.Fd = np.array([(0.0, 0.0), *p.knots]).T
        self.slopes = np.diff(self.Fd) / np.diff(z)
        self.masing = p.virgin == "masing"

    def _of(self, name: str, way: float) -> float:
        return getattr(self.p, f"{name}_{'pos' if way > 0 else 'neg'}")

    def level(self, speed: float) -> float:
        Fs, Fc, Vs, delta = (self._of(name, self.way) for name in ("Fs", "Fc", "Vs", "delta"))
        return Fc + (Fs - Fc) * np.exp(-((speed / Vs) ** delta))

    def rate(self, f: float, speed: float) -> float:
        """dz/dq."""
        S, b = self.level(speed), self.base
        r = f / S if self.p.variant == "lampaert2002" else (f - b) / (S - b)
        # trial steps of the solver may overshoot r = 1 by far
        return 1.0 - np.sign(r) * min(abs(r), 2.0) ** self.p.n

    def stiffness(self, f: float) -> float:
        scale = 0.5 if self.virgin and self.masing else 1.0
        k = int(np.searchsorted(self.Fd[1:] * scale, max(f - self.base, 0.0)))
        return self.slopes[min(k, len(self.slopes) - 1)]

    def beyond_closing(self, f: float) -> float:
        return f - self.tops[self.way][-1] if self.tops[self.way] else -1.0

    def beyond_reset(self, f: float, speed: float) -> float:
        wiped = not (self.virgin or self.tops[1.0] or self.tops[-1.0])
        return -1.0 if wiped else f - (1.0 - RESET_MARGIN) * self.level(speed)

    def reverse(self, f: float) -> float:
        self.tops[self.way].append(f)
        if self.virgin and self.masing:
            self.tops[-self.way].append(f)
        self.way, self.virgin, self.base = -self.way, False, -f
        return -f

    def close(self) -> float:
        f = self.tops[self.way].pop()
        if self.tops[-self.way]:
            self.tops[-self.way].pop()
        self._outer()
        return f

    def reset(self) -> None:
        self.tops, self.virgin = {1.0: [], -1.0: []}, False
        self._outer()

    def _outer(self) -> None:
        """The curve goes on from where it started."""
        tops = self.tops[-self.way]
        self.base = -tops[-1] if tops else -self._of("Fs", -self.way)


def continuous_torque(p, velocity: Callable[[float], float], time: np.ndarray) -> np.ndarray:
    """Fh, N m, of a joint that never moved, at the times given, s; velocity in rad/s of t."""
    law = ContinuousLaw(p, float(np.sign(velocity(time[0] + 1e-9))))

    def slope(t, y):
        speed = abs(velocity(t))
        return [law.stiffness(y[0]) * speed * law.rate(y[0], speed)]

    def reversal(t, y):
        return law.way * velocity(t)

    def closing(t, y):
        return law.beyond_closing(y[0])

    def reset(t, y):
        return law.beyond_reset(y[0], abs(velocity(t)))

    for event, way in ((reversal, -1), (closing, 1), (reset, 1)):
        event.terminal, event.direction = True, way

    out = np.zeros(len(time))
    t, f = time[0], 0.0
    while t < time[-1]:
        wanted = time[time > t]
        found = solve_ivp(
            slope,
            (t, time[-1]),
            [f],
            method="DOP853",
            max_step=0.02,
            t_eval=wanted,
            rtol=1e-8,
            atol=1e-9 * p.Fs_pos,
            events=(reversal, closing, reset),
        )
        if len(found.t):  # none where the event comes before the next of the times
            first = len(time) - len(wanted)
            out[first : first + len(found.t)] = law.way * found.y[0]
        hit = next((i for i, x in enumerate(found.t_events) if len(x)), None)
        if hit is None:
            break
        t, f = float(found.t_events[hit][0]), float(found.y_events[hit][0, 0])
        if hit == 0:
            f = law.reverse(f)
        elif hit == 1:
            f = law.close()
        else:
            law.reset()
        # past the event, so that it does not fire again at once
        t += 1e-13
    return out
