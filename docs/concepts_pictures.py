"""Pictures of the concepts page, drawn from the law itself, for light and dark pages.

Run by mkdocs (gen-files) when the site is built; nothing it writes is committed.
"""

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).parent))
import pictures
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from frictionjoint import FrictionParameters, friction_torque
from frictionjoint.law.kernel import commit, row_size, start_row, step_row
from frictionjoint.law.memory import CAPACITY, FH, HEADER, N_MAX, N_MIN
from frictionjoint.simulate.carrier import load_model, read_friction
from frictionjoint.simulate.stick_slip import JOINT, kuka_model, stick_slip

Array = NDArray[np.float64]
GREEN, ORANGE, VIOLET = "#1b9e77", "#d95f02", "#7570b3"
# A joint whose loops close to the eye: n large, three segments.
LAW = FrictionParameters.symmetric(
    Fs=1.5, Fc=1.0, Vs=0.05, sigma2=0.8, n=50, knots=((5e-5, 1.0), (2e-4, 2.0), (6e-4, 3.1))
)
# A slow pull up to A, back to B, up to C, back to D, up through C and A into sliding: mrad.
TURNS = (0.0, 0.1, -0.1, 0.06, 0.0, 0.2)


def transition() -> Figure:
    """Fd with its segments and knots."""
    figure, axes = plt.subplots(figsize=(7, 3.4), layout="constrained")
    z, F = np.array([(0.0, 0.0), *LAW.knots]).T
    for i, colour in enumerate((GREEN, ORANGE, VIOLET)):
        K = (F[i + 1] - F[i]) / (z[i + 1] - z[i])
        name = f"segment {i + 1}: {1e-3 * K:.3g} N m/mrad"
        axes.plot(1e3 * z[i : i + 2], F[i : i + 2], color=colour, lw=2.5, label=name)
        axes.plot(-1e3 * z[i : i + 2], -F[i : i + 2], color=colour, lw=2.5)
    axes.plot(1e3 * z[1:], F[1:], "o", color=GREEN, ms=5, mfc="none")
    axes.axhline(2 * LAW.Fs_pos, ls=":", lw=1, color="0.55")
    axes.annotate("Fs+ + Fs−: the curve must reach it", (-0.6, 2 * LAW.Fs_pos - 0.3), fontsize=9)
    axes.legend(fontsize=9, loc="lower right", frameon=False)
    axes.set(xlabel="z, mrad", ylabel="Fd(z), N m")
    return figure


def memory() -> Figure:
    """Nested presliding loops, and what the stacks hold at each turn."""
    q, Fh, turns, stacks = nested_loops()
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(10, 4.4), sharey=True, layout="constrained", width_ratios=(3, 2)
    )
    left.plot(1e3 * q, Fh, color=GREEN, lw=1.8)
    for name, k in zip("ABCD", turns[1:5], strict=True):
        left.plot(1e3 * q[k], Fh[k], "o", color=ORANGE, ms=6)
        left.annotate(name, (1e3 * q[k], Fh[k]), xytext=(6, -4), textcoords="offset points")
    left.set(xlabel="q, mrad", ylabel="Fh, N m", title="the path")
    for i, (minima, maxima) in enumerate(stacks.values()):
        for levels, colour, shift in ((maxima, GREEN, 0.14), (minima, VIOLET, -0.14)):
            for level in levels:
                right.plot([i + shift - 0.12, i + shift + 0.12], [level] * 2, color=colour, lw=3)
    right.set_xticks(range(len(stacks)), list(stacks), fontsize=9)
    right.plot([], [], color=GREEN, lw=3, label="M, maxima")
    right.plot([], [], color=VIOLET, lw=3, label="m, minima")
    right.legend(fontsize=9, loc="lower right", frameon=False, bbox_to_anchor=(1.0, 0.08))
    right.set(title="what the stacks hold then")
    return figure


def nested_loops() -> tuple[Array, Array, list[int], dict[str, tuple[Array, Array]]]:
    """Position and Fh along `TURNS`, the samples of the turns, and the stacks (m, M) after legs.

    Looked at on every leg, on the last one also past each closing and in sliding.
    """
    legs = [np.linspace(a, b, 400, endpoint=False) for a, b in pairwise(TURNS)]
    q = 1e-3 * np.concatenate([*legs, TURNS[-1:]])
    turns = [400 * i for i in range(len(TURNS))]
    P, X = LAW.pack(), np.zeros(row_size(LAW.pack(), 0))
    start_row(P, 0, X, 0)
    Fh, stacks = np.zeros(len(q)), {}
    last, past = turns[4], [np.argmax(q[turns[4] :] > q[turns[i]]) for i in (3, 1)]
    looks = {"to A": 200, "to B": 600, "to C": 1000, "to D": 1400, "on": last + 60}
    looks |= {"past C": last + past[0] + 9, "past A": last + past[1] + 9, "slides": len(q) - 1}
    for k in range(1, len(q)):
        step_row(P, 0, X, 0, q[k] - q[k - 1], 1e-3, 0.0)
        commit(P, 0, X, 0)
        Fh[k] = X[FH]
        for name in (name for name, at in looks.items() if at == k):
            m = X[2 * HEADER : 2 * HEADER + int(X[N_MIN])].copy()
            M = X[2 * HEADER + CAPACITY : 2 * HEADER + CAPACITY + int(X[N_MAX])].copy()
            stacks[name] = (m, M)
    return q, Fh, turns, stacks


def stribeck() -> Figure:
    """The sliding curve, and stick-slip running along it."""
    run = stick_slip(kuka_model())
    law = read_friction(load_model(kuka_model()))[JOINT].parameters
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
    v = np.concatenate([-np.geomspace(1.0, 1e-4, 80), np.geomspace(1e-4, 1.0, 80)])
    q = np.concatenate([[0.0], np.geomspace(1e-7, 10.0, 800)])
    steady = [friction_torque(law, q / abs(s), np.sign(s) * q)[-1] for s in v]
    F = friction_torque(law, run.time, run.position)
    for side in (v < 0, v > 0):
        left.plot(v[side], np.array(steady)[side], color=GREEN, lw=2)
    left.plot([], [], color=GREEN, lw=2, label="S(v) + σ₂ v, steady sliding")
    left.plot(run.velocity, F, color=ORANGE, lw=0.9, label="stick-slip, 12 s")
    left.set(xlim=(-0.4, 0.4))
    left.set(xlabel="velocity, rad/s", ylabel="friction torque, N m", title="Stribeck curve")
    left.legend(fontsize=9, frameon=False)
    right.plot(run.time, run.target, color="0.55", lw=1, label="target, 0.1 rad/s")
    right.plot(run.time, run.position, color=ORANGE, lw=1.6, label="KUKA IR 361, joint 1")
    right.set(xlabel="time, s", ylabel="position, rad", title="stick-slip")
    right.legend(fontsize=9, frameon=False)
    return figure


def loop() -> Figure:
    """The closed loop as boxes."""
    figure, axes = plt.subplots(figsize=(10, 2.1), layout="constrained")
    axes.set(xlim=(0, 100), ylim=(0, 22))
    axes.axis("off")
    names = ("log\n+ MJCF", "balance of\ntorques", "base fit\nof the law", "residual", "search")
    names += ("add or drop,\nrefit", "report,\nmodel.xml")
    for i, name in enumerate(names):
        x = 7 + 14.3 * i
        axes.text(x, 15, name, ha="center", va="center", fontsize=10, bbox=BOX)
        if i:
            axes.annotate("", (x - 5.6, 15), (x - 8.9, 15), arrowprops=ARROW)
    curve = ARROW | {"connectionstyle": "arc3,rad=-0.35"}
    axes.annotate("", (7 + 14.3 * 3, 10.5), (7 + 14.3 * 5, 10.5), arrowprops=curve)
    axes.text(7 + 14.3 * 4, 2.2, "until nothing is justified", ha="center", fontsize=9)
    return figure


BOX = {"boxstyle": "round,pad=0.5", "fc": "none", "ec": GREEN, "lw": 1.5}
ARROW = {"arrowstyle": "-|>", "color": ORANGE, "lw": 1.5}


for drawing in (transition, memory, stribeck, loop):
    pictures.write(f"img/concepts/{drawing.__name__}", drawing)
