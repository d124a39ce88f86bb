"""The law in continuous time along a smooth motion, by scipy: what ever finer steps tend to.

Only the terms in Fh; written from the equations, with reversals, closings and resets as events.
"""

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

RESET_MARGIN = 1e-3


def continuous_torque(p, velocity: Callable[[float], float], time: np.ndarray) -> np.ndarray:
    """Fh, N m, of a joint that never moved, at the times given, s; velocity in rad/s of t."""
    z, Fd = np.array([(0.0, 0.0), *p.knots]).T
    slopes = np.diff(Fd) / np.diff(z)
    tops: dict[float, list[float]] = {1.0: [], -1.0: []}  # maxima, mirrored minima, no limits
    state = {"base": 0.0, "virgin": True, "s": float(np.sign(velocity(time[0] + 1e-9)))}

    def side(name: str, s: float) -> float:
        return getattr(p, f"{name}_{'pos' if s > 0 else 'neg'}")

    def level(t: float) -> float:
        s = state["s"]
        Fs, Fc = side("Fs", s), side("Fc", s)
        return Fc + (Fs - Fc) * np.exp(-((abs(velocity(t)) / side("Vs", s)) ** side("delta", s)))

    def outer_base() -> float:
        """Where the present curve started, mirrored."""
        s = state["s"]
        return -tops[-s][-1] if tops[-s] else -side("Fs", -s)

    def slope(t, y):
        f, b, S = y[0], state["base"], level(t)
        d = max(f - b, 0.0)
        scale = 0.5 if state["virgin"] and p.virgin == "masing" else 1.0
        K = slopes[min(int(np.searchsorted(Fd[1:] * scale, d)), len(slopes) - 1)]
        r = f / S if p.variant == "lampaert2002" else (f - b) / (S - b)
        # trial steps of the solver may overshoot r = 1 by far
        return [K * abs(velocity(t)) * (1.0 - np.sign(r) * min(abs(r), 2.0) ** p.n)]

    def reversal(t, y):
        return state["s"] * velocity(t)

    def closing(t, y):
        return y[0] - tops[state["s"]][-1] if tops[state["s"]] else -1.0

    def reset(t, y):
        wiped = not (state["virgin"] or tops[1.0] or tops[-1.0])
        return -1.0 if wiped else y[0] - (1.0 - RESET_MARGIN) * level(t)

    for event in (reversal, closing, reset):
        event.terminal = True
    reversal.direction, closing.direction, reset.direction = -1, 1, 1

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
            out[first : first + len(found.t)] = state["s"] * found.y[0]
        hit = next((i for i, x in enumerate(found.t_events) if len(x)), None)
        if hit is None:
            break
        t, f = float(found.t_events[hit][0]), float(found.y_events[hit][0, 0])
        s = state["s"]
        if hit == 0:
            tops[s].append(f)
            if state["virgin"] and p.virgin == "masing":
                tops[-s].append(f)
            state.update(s=-s, virgin=False)
            f = -f
            state["base"] = f
        elif hit == 1:
            f = tops[s].pop()
            if tops[-s]:
                tops[-s].pop()
            state["base"] = outer_base()
        else:
            tops[1.0].clear()
            tops[-1.0].clear()
            state["virgin"] = False
            state["base"] = outer_base()
        # past the event, so that it does not fire again at once
        t += 1e-13
    return out
