"""The page of an evaluation: a table, and per joint torque and position as curves."""

import numpy as np
from markupsafe import Markup

from frictionjoint.evaluation.run import Evaluation, JointCurves, JointEvaluation
from frictionjoint.report.figure import AFTER, MEASURED, WIDE, cloud, figure, svg
from frictionjoint.report.html import fill

# samples drawn of a curve at most
_DRAWN = 4000


def page(evaluation: Evaluation) -> str:
    """HTML that stands alone."""
    pictures = {
        name: [_torque(name, joint), *_loop(name, joint)]
        for name, joint in evaluation.joints.items()
    }
    return fill("evaluation.html.j2", {"figures": figures}, e=evaluation, pictures=pictures)


def figures(x: float | None, unit: str = "") -> str:
    """A number of three figures, or a dash."""
    return "–" if x is None else f"{x:.3g}{unit and ' '}{unit}"


def _torque(name: str, joint: JointEvaluation) -> Markup:
    """The log that is furthest off over time, and the error of all over velocity."""
    worst = max(joint.curves, key=lambda c: float(np.sum(c.torque_error**2)))
    drawn, axes = figure(WIDE, 3.2)
    every = _every(worst)
    time = worst.time[::every]
    axes[0].plot(time, worst.drive[::every], color=MEASURED, label=f"acted, {worst.log}")
    axes[0].plot(time, worst.needed[::every], color=AFTER, label="needed by the model", linewidth=1)
    axes[0].set(xlabel="time, s", ylabel=f"torque, {joint.unit}")
    over, other = figure(WIDE, 2.8)
    for curves in joint.curves:
        every = _every(curves)
        velocity = curves.velocity[curves.known][::every]
        cloud(other[0], velocity, curves.torque_error[::every], AFTER, 1.5)
    other[0].set(
        xlabel=f"velocity, {joint.position_unit}/s", ylabel=f"needed - acted, {joint.unit}"
    )
    return svg(drawn, f"{name} torque") + svg(over, f"{name} error")


def _loop(name: str, joint: JointEvaluation) -> list[Markup]:
    """Simulated and measured position of the log that is furthest off."""
    runs = [(c, c.closed_loop) for c in joint.curves if c.closed_loop is not None]
    if not runs:
        return []
    worst, simulated = max(runs, key=lambda run: float(np.mean(np.abs(run[1] - run[0].position))))
    drawn, axes = figure(WIDE, 3.2)
    every = _every(worst)
    time = worst.time[::every]
    axes[0].plot(time, worst.position[::every], color=MEASURED, label=f"measured, {worst.log}")
    axes[0].plot(time, simulated[::every], color=AFTER, label="simulated", linewidth=1)
    axes[0].set(xlabel="time, s", ylabel=f"position, {joint.position_unit}")
    return [svg(drawn, f"{name} loop")]


def _every(curves: JointCurves) -> int:
    return max(1, len(curves.time) // _DRAWN)
