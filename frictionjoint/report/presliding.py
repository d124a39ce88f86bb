"""What the report shows of presliding: the law's loops, and the log behind its turning points."""

from itertools import pairwise

import numpy as np
from matplotlib.figure import Figure

from frictionjoint.arrays import Array
from frictionjoint.diagnose.report_data import Curve, Report
from frictionjoint.law.motion import friction_torque
from frictionjoint.parameters import Friction
from frictionjoint.report.figure import AFTER, HALF, MEASURED, cloud, figure, lines
from frictionjoint.report.plots import stages

# Turning points shown, samples a window has at least, and its length over that of presliding.
_MOST_TURNS, _LEAST_SAMPLES, _REACH = 12, 10, 6.0
_SLOW = 1e-6
# Turns of a loop after the first pull, alone or with two loops inside.
PLAIN = (0.0, 1.0, -1.0, 1.0)
NESTED = (0.0, 1.0, -1.0, 0.5, -0.5, 0.2, -0.2, 1.0, -1.0)


def length(law: Friction) -> float:
    """Displacement, rad, behind a turn until friction has made nine tenths of its change."""
    x = np.geomspace(1e-9, 1.0, 2000)
    q = np.concatenate([[0.0], x, x[-1] - x])
    F = friction_torque(law, np.arange(len(q)) / _SLOW, q)
    back = F[len(x) + 1 :]
    return float(x[np.argmax(back <= F[len(x)] + 0.9 * (back[-1] - F[len(x)]))])


def loops(report: Report) -> Figure:
    """Slow loops of two sizes, the larger with two nested, of the law before and after."""
    size = max(length(law) for law in report.laws)
    made, (axes,) = figure(HALF, 3.5)
    laws = dict(zip(("before", "after"), report.laws, strict=True))
    for name, stage, colour in stages(report):
        curves = [loop(laws[stage], 0.6 * size, NESTED), loop(laws[stage], 0.2 * size, PLAIN)]
        lines(axes, curves, colour, name)
    axes.set_xlabel(f"displacement, {report.units[1]}")
    axes.set_ylabel(f"torque of the law, {report.units[0]}")
    return made


def loop(law: Friction, amplitude: float, corners: tuple[float, ...]) -> tuple[Array, Array]:
    """Displacement and torque along slow turns at fractions of an amplitude, shape (n,)."""
    legs = [np.linspace(a, b, 60, endpoint=False) for a, b in pairwise(corners)]
    q = amplitude * np.concatenate([*legs, corners[-1:]])
    time = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(q)))]) / _SLOW
    return q, friction_torque(law, time, q)


def behind_turns(report: Report) -> Figure | None:
    """Friction, measured and by the law, against displacement behind turning points; None without.

    Measured friction is what the rest of the final model leaves of the measured torque. All turns
    are drawn as if the joint went on in the positive direction.
    """
    size = _REACH * length(report.laws[1])
    found = [(c, window) for c in report.curves for window in turns(c, size)]
    if not found:
        return None
    # the slowest: there presliding has the most samples
    found.sort(key=lambda f: _displacement(*f) / (f[1].stop - f[1].start))
    made, (axes,) = figure(HALF, 3.5)
    gone, measured, law = [], [], []
    for c, w in found[:_MOST_TURNS]:
        sign = np.sign(c.position[w.stop - 1] - c.position[w.start])
        gone.append(np.abs(c.position[w] - c.position[w.start]))
        measured.append(sign * (c.measured - c.after + c.friction)[w])
        law.append(sign * c.friction[w])
    cloud(axes, np.concatenate(gone), np.concatenate(measured), MEASURED, 3.0, "measured")
    lines(axes, list(zip(gone, law, strict=True)), AFTER, stages(report)[-1][0])
    axes.set_xlabel(f"displacement since the turning point, {report.units[1]}")
    axes.set_ylabel(f"friction, {report.units[0]}")
    return made


def turns(c: Curve, size: float) -> list[slice]:
    """Samples from each turning point on until the joint has gone `size`, or turned again."""
    step = np.diff(c.position)
    moving = np.flatnonzero(step != 0.0)
    # a gap in the samples is no turn
    even = np.diff(c.time) < 1.5 * np.median(np.diff(c.time))
    found = []
    for a, b in pairwise(moving):
        if step[a] * step[b] >= 0.0 or not even[a : b + 1].all():
            continue
        end = b + 1
        while end < len(step) and even[end] and step[end] * step[b] > 0.0:
            end += 1
            enough = end - b >= _LEAST_SAMPLES
            if enough and abs(c.position[end] - c.position[b]) >= size:
                found.append(slice(int(b), int(end) + 1))
                break
    return found


def _displacement(c: Curve, window: slice) -> float:
    return float(abs(c.position[window.stop - 1] - c.position[window.start]))
