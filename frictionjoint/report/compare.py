"""Comparison of laws and parameter sets along the same three motions.

Every law is driven by `friction_torque`, so any law with a parameter file can be compared. Effects
beyond the law depend on more than the joint's own motion; they are named, not drawn.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.catalogue import title
from frictionjoint.export.sliding import stribeck_velocity
from frictionjoint.joint_friction import JointFriction
from frictionjoint.law.motion import friction_torque
from frictionjoint.parameters import Friction
from frictionjoint.report.charts import LAW_COLOURS, Chart, Series, sliding
from frictionjoint.report.html import fill
from frictionjoint.report.summary import Summary
from frictionjoint.report.wording import quantity

KINDS = (".html", ".png", ".svg")
# Panels: what is drawn, with its axes.
PANELS = (
    ("Sliding: torque against velocity", "velocity, rad/s", "torque, N m"),
    ("Presliding: torque against displacement", "displacement in a loop, rad", "torque, N m"),
    ("Breakaway: a slow pull from rest", "displacement of a slow pull, rad", "torque, N m"),
)
# A pull so slow and so long that every law in reach of a joint breaks away in it, rad and rad/s.
_PULLED = np.concatenate([[0.0], np.geomspace(1e-9, 1.0, 4000)])
_SLOW = 1e-9


@dataclass(frozen=True)
class Compared:
    """One parameter set."""

    name: str  # of its file
    # (x, y) of the first of `PANELS`, shape (n,) each: all three, only sliding for a law without
    # presliding, none without a scale in N m
    curves: tuple[tuple[Array, Array], ...]
    figures: dict[str, float | str]  # by name with its unit; text or a number


def compared(read: Mapping[str, JointFriction]) -> list[Compared]:
    """Drive each set of parameters through the three motions, the same for all of them."""
    if not read:
        return []
    # a law without a stiffness creeps at rest: it has no presliding to draw
    pulls = {n: _pull(x.parameters) for n, x in read.items() if x.parameters.stiffness > 0.0}
    lengths = [length for _, length in pulls.values()]
    # sliding is drawn up to ten Stribeck velocities, where friction falls with speed
    fastest = max(10.0 * (stribeck_velocity(x.parameters) or 0.1) for x in read.values())
    return [_one(name, joint, pulls.get(name), lengths, fastest) for name, joint in read.items()]


def report_figures(content: Mapping[str, Any]) -> dict[str, float | str]:
    """Verdict, errors and friction numbers of a report, as text by name."""
    s = Summary(content)
    missing = [x.title for x in s.effects] + [
        f"dependence on {quantity(name)}" for name, _ in s.unexplained
    ]
    found: dict[str, float | str] = {
        "joint": s.joint,
        "verdict": s.verdict.replace("-", " "),
        "missing": ", ".join(missing) or "nothing found",
    }
    where = "held-out" if s.role == "held_out" else "fitted"
    for e in s.errors:
        found[f"{e.quantity} error {e.stage}, {where} logs"] = e.text(s.role)
    return found | {x.meaning: x.qualified for x in s.friction}


def _one(
    name: str,
    joint: JointFriction,
    pull: tuple[Array, float] | None,
    lengths: list[float],
    fastest: float,
) -> Compared:
    speed, torque = sliding(joint.parameters, fastest, 60)
    curves = [(speed, torque)]
    figures: dict[str, float | str] = {
        "law": joint.parameters.law,
        "at rest": "sticks" if pull else "creeps",
    }
    if pull:
        F, length = pull
        q, loop = _reversals(joint.parameters, 0.5 * min(lengths))
        shown = 3.0 * max(lengths) >= _PULLED
        curves += [(q, loop), (_PULLED[shown], F[shown])]
        figures |= {
            "breakaway torque, N m": float(F.max()),
            "breakaway displacement, rad": length,
            "presliding stiffness, N m/rad": joint.parameters.stiffness,
            # of the last whole loop
            "work of one presliding loop, J": float(np.trapezoid(loop[-401:], q[-401:])),
        }
    least = int(np.argmin(torque[speed > 0]))
    figures |= {
        "least sliding torque, N m": float(torque[speed > 0][least]),
        "at velocity, rad/s": float(speed[speed > 0][least]),
        f"torque at {fastest:.3g} rad/s, N m": float(torque[-1]),
        f"torque at -{fastest:.3g} rad/s, N m": float(torque[0]),
        "effects, not drawn": ", ".join(title(e.effect.name) for e in joint.effects) or "none",
    }
    return Compared(name, tuple(curves), figures)


def _pull(parameters: Friction) -> tuple[Array, float]:
    """Torque along a slow pull from rest, and the displacement at which the joint breaks away."""
    F = friction_torque(parameters, _PULLED / _SLOW, _PULLED)
    # laws approach their largest torque slowly: 99% of it counts as reached
    return F, float(_PULLED[int(np.argmax(0.99 * F.max() <= F))])


def _reversals(parameters: Friction, amplitude: float) -> tuple[Array, Array]:
    """Two large loops with a small one inside, before sliding and very slowly."""
    corners = amplitude * np.array([0.0, 1.0, -1.0, 0.2, -0.4, 1.0, -1.0, 1.0])
    legs = [np.linspace(a, b, 200, endpoint=False) for a, b in pairwise(corners)]
    q = np.concatenate([*legs, corners[-1:]])
    time = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(q)))]) / _SLOW
    return q, friction_torque(parameters, time, q)


def rows(found: list[Compared]) -> list[tuple[str, list[str]]]:
    """The figures as text, one row each with a cell per parameter set; a dash if a law has none."""
    names = dict.fromkeys(name for x in found for name in x.figures)
    return [(name, [_cell(x.figures.get(name)) for x in found]) for name in names]


def _cell(value: float | str | None) -> str:
    if value is None:
        return "-"
    return f"{value:.4g}" if isinstance(value, float) else value


def panels(found: list[Compared]) -> tuple[Chart, ...]:
    """The curves of all parameter sets, one chart per motion."""
    return tuple(
        Chart(
            *panel,
            tuple(
                Series(x.name, *x.curves[k], LAW_COLOURS[i % len(LAW_COLOURS)])
                for i, x in enumerate(found)
                if len(x.curves) > k
            ),
        )
        for k, panel in enumerate(PANELS)
    )


def draw(found: list[Compared], kind: str) -> str | bytes:
    """The three panels as a page (.html) or a picture (.png, .svg)."""
    names = [x.name for x in found]
    if kind != ".html":
        # matplotlib takes a quarter of a second
        from frictionjoint.report.picture import draw_charts, picture

        title = f"friction laws: {', '.join(names)}"
        return picture(draw_charts(panels(found), title), kind.removeprefix("."))
    return fill("compare.html.j2", {}, names=names, panels=panels(found), figures=rows(found))
