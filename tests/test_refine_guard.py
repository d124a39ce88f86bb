"""Kinds of logs that the guard leaves out, and derivatives kept up to date by steps."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest

from frictionjoint.refine.guard import clearly_less, kinds, of_logs, without_each


def log(n=10, **figures):
    return SimpleNamespace(position=np.zeros(n), figures=figures)


def groups(courses):
    """Numbers of the logs that each mask leaves out, all of their samples."""
    ends = np.cumsum([0, *(len(c.position) for c in courses)])
    found = []
    for mask in kinds(courses):
        parts = [mask[a:b] for a, b in itertools.pairwise(ends)]
        assert all(part.all() or not part.any() for part in parts)
        found.append([i for i, part in enumerate(parts) if part.all()])
    return found


def test_every_gain_every_rig_and_every_motion_is_left_out_once():
    courses = [
        log(n=5 + i + j, kp=kp, mass=mass, length=length, motion=motion, vin=12.0)
        for i, (mass, length) in enumerate([(0.5, 0.1), (1.0, 0.15)])
        for j, kp in enumerate([4.0, 16.0, 32.0])
        for motion in ("steps", "sines")
    ]
    found = groups(courses)
    # mass and length are one kind, the supply is none
    by_gain = [[0, 1, 6, 7], [2, 3, 8, 9], [4, 5, 10, 11]]
    by_rig = [list(range(6)), list(range(6, 12))]
    by_motion = [list(range(0, 12, 2)), list(range(1, 12, 2))]
    assert sorted(found) == sorted([*by_gain, *by_rig, *by_motion])


def test_logs_of_no_kind_are_left_out_one_by_one_and_a_single_one_at_its_end():
    assert groups([log(kp=8.0) for _ in range(3)]) == [[0], [1], [2]]
    assert len(kinds([log(number=float(i)) for i in range(40)])) == 6
    (last,) = kinds([log(n=90)])
    assert last.sum() == 30
    assert last[60:].all()


class Line:
    """Errors of a straight line through points, as an objective has them; no prior to speak of."""

    bounds = np.full(2, -np.inf), np.full(2, np.inf)

    def __init__(self, x, y):
        self.A, self.y = np.column_stack([np.ones_like(x), x]), y
        self.courses = [log(n=len(y))]

    def of(self, courses):
        assert courses == self.courses
        return self

    def errors(self, z):
        return self.A @ z - self.y

    def __call__(self, z):
        return np.concatenate([self.errors(z), 1e-9 * z])


def test_what_is_left_out_is_predicted_by_the_rest_alone():
    x = np.linspace(0.0, 1.0, 21)
    y = 2.0 + 3.0 * x
    mask = x > 0.8
    y[mask] += 0.7  # what no other sample tells
    line = Line(x, y)
    J = np.vstack([line.A, 1e-9 * np.eye(2)])
    z = np.linalg.lstsq(line.A, y, rcond=None)[0]
    _, left = without_each(line, z, J, [mask])
    assert np.array_equal(np.isfinite(left), [mask])
    assert np.abs(left[0, mask]) == pytest.approx(0.7, rel=1e-6)
    # a log that is alone counts in parts
    assert of_logs(left[:, mask], [log(n=int(mask.sum()))]) == pytest.approx([0.7] * 4, rel=1e-6)
    # the fit to all of them flatters itself
    assert np.mean(np.abs(line.errors(z)[mask])) < 0.5 * 0.7


def test_errors_are_clearly_less_beyond_their_scatter():
    before = np.array([1.0, 1.2, 0.8, 1.1])
    assert clearly_less(0.8 * before, before)
    assert not clearly_less(before + np.array([-0.5, 0.3, -0.3, 0.45]), before)
    assert not clearly_less(before, before)
    # a log of rest that both repeat exactly says nothing
    assert clearly_less(np.append(0.8 * before, 0.0), np.append(before, 0.0))
