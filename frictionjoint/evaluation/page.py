"""The HTML page of an evaluation: a table, and plots of torque and position per joint."""

import numpy as np

from frictionjoint.evaluation.run import Evaluation, JointCurves, JointEvaluation
from frictionjoint.report.charts import Chart, Series
from frictionjoint.report.html import fill


def page(evaluation: Evaluation) -> str:
    """A self-contained HTML page."""
    drawn = {name: _charts(joint) for name, joint in evaluation.joints.items()}
    return fill("evaluation.html.j2", {"figures": figures}, e=evaluation, drawn=drawn)


def figures(x: float | None, unit: str = "") -> str:
    """A number with three significant digits, or a dash."""
    return "–" if x is None else f"{x:.3g}{unit and ' '}{unit}"


def _charts(joint: JointEvaluation) -> list[Chart]:
    """Plots of a joint: torque of the worst log, error of all logs over velocity, closed loop."""
    worst = max(joint.curves, key=lambda c: float(np.sum(c.torque_error**2)))
    every = _every(worst)
    time = worst.time[::every]
    torque = Chart(
        title="torque",
        x_label="time, s",
        y_label=f"torque, {joint.unit}",
        series=(
            Series(f"acted, {worst.log}", time, worst.drive[::every], "measured"),
            Series("needed by the model", time, worst.needed[::every], "after"),
        ),
    )
    error = Chart(
        title="error",
        x_label=f"velocity, {joint.position_unit}/s",
        y_label=f"needed - acted, {joint.unit}",
        series=tuple(
            Series(
                c.log,
                c.velocity[c.known][:: _every(c)],
                c.torque_error[:: _every(c)],
                "after",
                "points",
            )
            for c in joint.curves
        ),
    )
    return [torque, error, *_loop(joint)]


def _loop(joint: JointEvaluation) -> list[Chart]:
    """Simulated and measured position of the log with the largest error."""
    runs = [(c, c.closed_loop) for c in joint.curves if c.closed_loop is not None]
    if not runs:
        return []
    worst, simulated = max(runs, key=lambda run: float(np.mean(np.abs(run[1] - run[0].position))))
    every = _every(worst)
    time = worst.time[::every]
    return [
        Chart(
            title="closed loop",
            x_label="time, s",
            y_label=f"position, {joint.position_unit}",
            series=(
                Series(f"measured, {worst.log}", time, worst.position[::every], "measured"),
                Series("simulated", time, simulated[::every], "after"),
            ),
        )
    ]


def _every(curves: JointCurves) -> int:
    # at most 4000 samples per curve
    return max(1, len(curves.time) // 4000)
