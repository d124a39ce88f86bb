"""Event-driven reference of the integrated friction law (Ganseman 1997; Lampaert 2002).

Written from the equations alone, slow and plain, to hold the kernel against. Torques are mirrored
so that every stretch is read as an upward one: G = s Fh, B = s Fb, A = s S(v) > 0.
"""

import math
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from reference.relaxation import advance, span

RESET_MARGIN = 1e-3


@dataclass
class _State:
    Fh: float = 0.0
    direction: int = 0
    maxima: list[float] = field(default_factory=list)  # without the limits
    minima: list[float] = field(default_factory=list)
    on_virgin: bool = True  # moving on the first-loading curve
    never_reset: bool = True

    def ahead(self) -> list[float]:
        return self.maxima if self.direction > 0 else self.minima

    def behind(self) -> list[float]:
        return self.minima if self.direction > 0 else self.maxima


class _Solver:
    def __init__(self, parameters):
        self.p = parameters
        self.x = _State()
        self.events = Counter(reversal=0, closing=0, reset=0, several_closings_in_one_step=0)

    def side(self, name: str, s: int) -> float:
        return getattr(self.p, f"{name}_{'pos' if s > 0 else 'neg'}")

    def level(self, v: float, s: int) -> float:
        Fs, Fc = self.side("Fs", s), self.side("Fc", s)
        ratio = abs(v) / self.side("Vs", s)
        with np.errstate(over="ignore"):
            decay = float(np.exp(-(np.float64(ratio) ** self.side("delta", s))))
        return Fc + (Fs - Fc) * decay

    def base(self) -> float:
        """B: the mirrored torque at which the present curve starts."""
        x, s = self.x, self.x.direction
        if x.on_virgin:
            return 0.0
        return s * x.behind()[-1] if x.behind() else -self.side("Fs", -s)

    def curve(self) -> tuple[list[float], list[float]]:
        """Torques at the ends of the segments of the present curve above B, and slopes."""
        half = 0.5 if self.x.on_virgin and self.p.virgin == "masing" else 1.0
        z0 = F0 = 0.0
        ends, slopes = [], []
        for z, F in self.p.knots:
            ends.append(half * F)
            slopes.append((F - F0) / (z - z0))
            z0, F0 = z, F
        ends[-1] = math.inf
        return ends, slopes

    def reverse(self, s: int) -> None:
        x = self.x
        if x.direction == 0:
            x.direction = s
            return
        if s == x.direction:
            return
        self.events["reversal"] += 1
        x.ahead().append(x.Fh)
        if x.on_virgin and self.p.virgin == "masing":
            x.behind().append(-x.Fh)
        x.on_virgin = False
        x.direction = s

    def close(self) -> None:
        x = self.x
        self.events["closing"] += 1
        x.Fh = x.ahead().pop()
        if x.behind():
            x.behind().pop()
        if (
            x.never_reset
            and not (x.maxima and x.minima)
            and (self.p.virgin == "masing" or not (x.maxima or x.minima))
        ):
            x.maxima.clear()
            x.minima.clear()
            x.on_virgin = True

    def reset(self) -> bool:
        x = self.x
        wiped = bool(x.maxima or x.minima or x.on_virgin)
        x.maxima.clear()
        x.minima.clear()
        x.on_virgin = x.never_reset = False
        self.events["reset"] += wiped
        return wiped

    def ratio(self, A: float) -> tuple[float, float, float]:
        """r, and (c, D) such that G = c + D r."""
        B = self.base()
        c, D = (0.0, A) if self.p.variant == "lampaert2002" else (B, A - B)
        return (self.x.direction * self.x.Fh - c) / D, c, D

    def stretch(self, A: float, dx: float) -> float:
        """Move dx > 0 along the direction at constant level A; returns r at the end."""
        x, s, closed = self.x, self.x.direction, 0
        while True:
            G = s * x.Fh
            if G >= (1 - RESET_MARGIN) * A:
                self.reset()
            r, c, D = self.ratio(A)
            if dx <= 0:
                break
            B = self.base()
            ends, slopes = self.curve()
            down = G > A
            y = G - B
            tiny = 1e-13 * max(abs(G), abs(B), A)
            if down:
                i = next(k for k, e in enumerate(ends) if y <= e + tiny)
                floor = B + (ends[i - 1] if i else 0.0)
                target, what = max(A, floor), "knot" if floor > A else "none"
            else:
                i = next(k for k, e in enumerate(ends) if y < e - tiny)
                options = [(B + ends[i], "knot"), (A, "none")]
                if x.ahead():
                    options.append((s * x.ahead()[-1], "close"))
                if x.maxima or x.minima or x.on_virgin:
                    options.append(((1 - RESET_MARGIN) * A, "reset"))
                target, what = min(options)
            if down and i and y <= ends[i - 1] + tiny:
                i -= 1
            need = span(r, (target - c) / D, self.p.n) * D / slopes[i] if target != G else 0.0
            if what == "none" or need > dx:
                G = c + D * advance(r, dx * slopes[i] / D, self.p.n)
                x.Fh, dx = s * G, 0.0
                continue
            x.Fh, dx = s * target, dx - need
            if what == "close":
                self.close()
                closed += 1
        self.events["several_closings_in_one_step"] += closed > 1
        return r

    def step(self, dt: float, dq: float) -> float:
        """Torque at the end of a straight stretch of the motion."""
        if dq == 0:
            return self.x.Fh
        s, v = (1 if dq > 0 else -1), dq / dt
        self.reverse(s)
        r = self.stretch(self.level(v, s), abs(dq))
        with np.errstate(over="ignore"):
            rate = v * (1 - math.copysign(float(np.abs(np.float64(r)) ** self.p.n), r))
        return self.x.Fh + self.p.sigma1 * rate + self.side("sigma2", s) * v


def reference_torque(parameters, time, position) -> tuple[np.ndarray, Counter]:
    """Friction torque, N m, at samples (time s, position rad), and counts of the mechanisms."""
    solver = _Solver(parameters)
    torque = np.zeros(len(time))
    for k in range(1, len(time)):
        torque[k] = solver.step(float(time[k] - time[k - 1]), float(position[k] - position[k - 1]))
    return torque, solver.events
