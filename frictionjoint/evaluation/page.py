"""The HTML page of an evaluation: a table, and plots of torque and position per joint."""

import numpy as np

from frictionjoint.evaluation.run import Evaluation, JointEvaluation
from frictionjoint.report.charts import LAW_COLOURS, Chart, cloud, over_time
from frictionjoint.report.html import fill


def page(evaluation: Evaluation) -> str:
    """A self-contained HTML page."""
    drawn = {name: _charts(joint) for name, joint in evaluation.joints.items()}
    return fill("evaluation.html.j2", {"figures": figures}, e=evaluation, drawn=drawn)


def figures(x: float | None, unit: str = "") -> str:
    """A number with three significant digits, or a dash."""
    return "–" if x is None else f"{x:.3g} {unit}".replace(" %", "%").strip()


def _charts(joint: JointEvaluation) -> list[Chart]:
    """Plots of a joint: torque of the worst log, error of all logs over velocity, closed loop."""
    worst = max(joint.curves, key=lambda c: float(np.sum(c.torque_error**2)))
    acted = over_time(f"acted, {worst.log}", worst.time, worst.drive, "measured")
    needed = over_time("needed by the model", worst.time, worst.needed, "after")
    errors = tuple(
        cloud(c.log, c.velocity[c.known], c.torque_error, LAW_COLOURS[i % len(LAW_COLOURS)])
        for i, c in enumerate(joint.curves)
    )
    velocity = f"velocity, {joint.position_unit}/s"
    return [
        Chart("Torque, worst log", "time, s", f"torque, {joint.unit}", (acted, needed)),
        Chart("Error, all logs", velocity, f"needed − acted, {joint.unit}", errors),
        *_loop(joint),
    ]


def _loop(joint: JointEvaluation) -> list[Chart]:
    """Simulated and measured position of the log with the largest error."""
    runs = [(c, c.closed_loop) for c in joint.curves if c.closed_loop is not None]
    if not runs:
        return []
    worst, simulated = max(runs, key=lambda run: float(np.mean(np.abs(run[1] - run[0].position))))
    curves = (
        over_time(f"measured, {worst.log}", worst.time, worst.position, "measured"),
        over_time("simulated", worst.time, simulated, "after"),
    )
    return [Chart("Position in closed loop", "time, s", f"position, {joint.position_unit}", curves)]
