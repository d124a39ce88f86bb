"""The catalogue's page: each effect's own words, and its torque along one and the same motion.

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
from frictionjoint.effects.catalogue import CATALOGUE
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


def described(effect: Effect, rows: Array) -> list[str]:
    """What there is to say of an effect, with its picture."""
    picture_name = f"img/effects/{effect.effect_id}"
    pictures.write(picture_name, partial(picture, effect, rows))
    sizes = () if effect.of_load else zip(effect.coefficients, effect.units, strict=True)
    units = [f"{c} ({u})" for c, u in sizes]
    units += [f"{c} ({u})" for c, u in zip(effect.shape, effect.shape_units, strict=True)]
    return [
        f"{effect.cause[0].upper()}{effect.cause[1:]}.\n",
        pictures.shown(picture_name, f"Torque of {effect.name}"),
        f"* Form: `{effect.form}`; {effect.entry}",
        f"* Numbers: {', '.join(units)}",
        f"* Signature: {effect.signature}",
        f"* Record to distinguish it: {effect.separating_motion}",
        f"* Source: {effect.source}\n",
    ]


def main() -> None:
    """Page and pictures."""
    rows = motion()
    lines = [
        "# Effects\n",
        "What a joint may have besides its friction law. The pictures show each effect's torque",
        "along q = sin t with all coefficients one, against position, velocity and time; they show",
        "shape, not size. T stands for N m or N, x for rad or m.\n",
    ]
    for name in dict.fromkeys(effect.name for effect in CATALOGUE):
        forms = [effect for effect in CATALOGUE if effect.name == name]
        lines.append(f"## {known_as(name)}\n")
        for number, effect in enumerate(forms, 1):
            if len(forms) > 1:
                lines.append(f"**Form {number} of {len(forms)}**\n")
            lines += described(effect, rows)
    with mkdocs_gen_files.open("effects.md", "w") as file:
        file.write("\n".join(lines))


main()
