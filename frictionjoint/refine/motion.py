"""Simulated motion of logs, in windows that start from the measured one, or of whole logs."""

from collections.abc import Sequence

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.terms import drive_changes
from frictionjoint.replay.closed_loop import Course, joint_model
from frictionjoint.simulate.one_joint import simulate
from frictionjoint.threads import side_by_side

# s, longest window: a stick that came too early is forgotten with it
LONGEST_WINDOW_S = 1.0


def errors(courses: Sequence[Course], fitted: Fit, window_s: float | None) -> list[Array]:
    """Simulated minus measured position at the samples of each log, rad (m).

    Args:
        window_s: s between restarts from the measured motion; None: whole logs. Where the drive was
            measured, the windows of the course.
    """
    model, changes = joint_model(fitted), drive_changes(fitted.terms)

    def one(course: Course) -> Array:
        run = course.changed(changes)
        length = course.window_s or window_s
        if length is None:
            found = simulate(model, run)
        else:
            window = max(2, round(length / run.step))
            found = simulate(model, run, course.motion, window)
        # rad (m): a run gone astray must not outweigh all others
        e = np.clip(course.at_samples(found) - course.position, -10.0, 10.0)
        return e if course.counts is None else np.where(course.counts, e, 0.0)

    with side_by_side() as each:
        return list(each(one, courses))


def window_squares(courses: Sequence[Course], fitted: Fit) -> Array:
    """Mean square of the errors of each window, rad^2 (m^2), shape (k,)."""
    found = []
    for course, e in zip(courses, errors(courses, fitted, LONGEST_WINDOW_S), strict=True):
        window = ((course.time - course.time[0]) / LONGEST_WINDOW_S).astype(int)
        count = np.bincount(window)
        found.append((np.bincount(window, e**2) / np.maximum(count, 1))[count > 0])
    return np.concatenate(found)
