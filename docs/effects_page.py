"""The page of effects: a schematic, and each effect with its torque along one motion.

Run by mkdocs (gen-files) when the site is built; nothing it writes is committed.
"""

import sys
from functools import partial
from pathlib import Path

import mkdocs_gen_files
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
import pictures
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from frictionjoint.arrays import Array
from frictionjoint.effects import signals as s
from frictionjoint.effects.catalogue import CATALOGUE, title
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.kernel import MEMORY, effect_torque
from frictionjoint.report.wording import known_as


def motion() -> Array:
    """Two periods of q = sin t with every signal an effect may look at, shape (2000, N_SIGNALS)."""
    t = np.linspace(0.0, 4.0 * np.pi, 2000)
    rows = np.zeros((len(t), s.N_SIGNALS))
    q, v = np.sin(t), np.cos(t)
    H = np.tanh(v / 0.05)
    rows[:, s.TIME], rows[:, s.DT] = t, t[1] - t[0]
    rows[0, s.DT] = 0.0
    rows[:, s.Q], rows[:, s.V], rows[:, s.A] = q, v, -q
    rows[:, s.LOAD], rows[:, s.GX], rows[:, s.GY] = 5.0 * q, 9.81 * np.sin(q), 9.81 * np.cos(q)
    rows[:, s.GEAR] = rows[:, s.MOTOR] = rows[:, s.LOAD]
    rows[:, s.TEMP] = 25.0 + 10.0 * t / t[-1]
    rows[:, s.H] = H
    rows[:, s.DTAU] = np.gradient(5.0 * q + H, t)
    rows[:, s.RATE] = 1.0 - np.abs(H)
    return rows


def torque(effect: Effect, rows: Array) -> Array:
    """Torque with coefficients one, or the nearest their bounds allow; shape (n,)."""
    bounds = effect.bounds or ((-np.inf, np.inf),) * len(effect.coefficients)
    ones = [float(np.clip(1.0, low, high)) for low, high in bounds]
    grid = effect.shapes(rows)
    shape = grid[len(grid) // 2] if grid and grid[0] else (4.0,) * len(effect.shape)
    # a number that is still to be estimated is zero on the grid
    P = np.array([*(x or 1.0 for x in shape), *ones])
    X = np.zeros(MEMORY)
    return np.array([effect_torque(effect.effect_id, P, 0, row, X, 0) for row in rows])


def picture(effect: Effect, rows: Array) -> Figure:
    """The torque against position, velocity and time."""
    figure, axes = plt.subplots(1, 3, figsize=(9, 2.4), sharey=True, layout="constrained")
    values = torque(effect, rows)
    labels = {s.Q: "position", s.V: "velocity", s.TIME: "time"}
    for axis, (column, label) in zip(axes, labels.items(), strict=True):
        axis.plot(rows[:, column], values, lw=1.2, color="#1b9e77")
        axis.set_xlabel(label)
    axes[0].set_ylabel("torque, coefficients one")
    return figure


# Where in the drive train an effect acts, for the schematic
PLACES = {
    "controller": ("command-delay", "command-rate", "deadband", "gain-error"),
    "drive": ("drive-limit", "duty-drop", "supply-sag", "back-emf"),
    "motor": ("torque-gain", "torque-bias", "motor-saturation", "motor-temperature"),
    "gear": ("load-dependent", "position-periodic", "backlash", "joint-elasticity"),
    "joint": (
        "direction-asymmetry", "nonlinear-viscous", "frictional-lag", "dwell-time",
        "temperature-dependent", "warm-up-drift", "spring", "end-stop",
    ),
    "link": ("inertia-error", "gravity-error"),
    "sensors": ("measurement-delay",),
}  # fmt: skip


def schematic() -> Figure:
    """The drive train with the effects below the part in which they act."""
    figure, axes = plt.subplots(figsize=(10, 3.2), layout="constrained")
    axes.set(xlim=(-0.55, len(PLACES) - 0.45), ylim=(-2.4, 0.5))
    axes.axis("off")
    box = {"boxstyle": "round,pad=0.5", "fc": "none", "ec": "#1b9e77", "lw": 1.5}
    arrow = {"arrowstyle": "-|>", "color": "#d95f02", "lw": 1.5}
    for i, (place, names) in enumerate(PLACES.items()):
        axes.text(i, 0, place, ha="center", va="center", fontsize=11, bbox=box)
        if i:
            axes.annotate("", (i - 0.36, 0), (i - 0.64, 0), arrowprops=arrow)
        text = "\n".join(names)
        axes.text(i, -0.5, text, ha="center", va="top", fontsize=8, linespacing=1.6)
    return figure


def described(forms: list[Effect], rows: Array) -> list[str]:
    """An effect: its cause, its forms with pictures, and how to recognise it."""
    first = forms[0]
    lines = [f"{first.cause[0].upper()}{first.cause[1:]}.\n"]
    for effect in forms:
        picture_name = f"img/effects/{effect.effect_id}"
        pictures.write(picture_name, partial(picture, effect, rows))
        if effect.cause != first.cause:
            lines.append(f"Or: {effect.cause}.\n")
        lines += [
            pictures.shown(picture_name, f"Torque of {effect.name}"),
            f"`{effect.form}` ({effect.entry}).\n",
        ]
    return [
        *lines,
        f"* Signature: {first.signature}.",
        f"* Record to distinguish it: {first.separating_motion}.",
        f"* Source: {first.source}\n",
    ]


def main() -> None:
    """Page and pictures."""
    rows = motion()
    unplaced = {e.name for e in CATALOGUE} - {name for names in PLACES.values() for name in names}
    assert not unplaced, f"give a place in the schematic: {unplaced}"
    pictures.write("img/effects/schematic", schematic)
    lines = [
        "# Effects\n",
        "An effect is a cause of torque beyond the friction law. The schematic shows where each",
        "effect acts. The effects of the controller and the drive are described in",
        "[robots and servos](robots.md#servos-and-legs-without-torque-sensors).\n",
        pictures.shown("img/effects/schematic", "The drive train and where effects act"),
        "The plots show the torque of each effect along q = sin t with all coefficients equal to",
        "one, against position, velocity and time. They show the shape, not the size.\n",
    ]
    for name in dict.fromkeys(effect.name for effect in CATALOGUE):
        lines.append(f"## {known_as(name, title(name))}\n")
        lines += described([effect for effect in CATALOGUE if effect.name == name], rows)
    with mkdocs_gen_files.open("effects.md", "w") as file:
        file.write("\n".join(lines))


main()
