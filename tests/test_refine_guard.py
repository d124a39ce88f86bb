"""Kinds of logs that the guard leaves out, and derivatives kept up to date by steps."""

import itertools
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import norm
from scipy.stats import t as student

from frictionjoint.control.kernel import BLOCK, COUNT
from frictionjoint.refine.guard import (
    clearly_less,
    held,
    kinds,
    missing_width,
    of_logs,
    on_each,
    spread,
    uncertain,
    without_each,
)
from frictionjoint.refine.secant import Secant


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


def test_numbers_fitted_without_each_kind_are_judged_by_another_measure_too():
    line, steeper = Line(np.arange(4.0), np.zeros(4)), Line(2.0 * np.arange(4.0), np.zeros(4))
    masks = [np.array([True, True, False, False]), np.array([False, False, True, True])]
    moved = np.array([[0.0, 1.0], [1.0, 0.0]])
    left = on_each(line, moved, masks)
    assert left[0, :2] == pytest.approx([0.0, 1.0])
    assert left[1, 2:] == pytest.approx([1.0, 1.0])
    assert np.array_equal(np.isnan(left), ~np.array(masks))
    assert on_each(steeper, moved, masks)[0, :2] == pytest.approx([0.0, 2.0])


class Bent(Line):
    """Errors of z + z^3 at each sample, whose derivative at one place says little of another."""

    bounds = np.full(1, -np.inf), np.full(1, np.inf)

    def __init__(self, y):
        self.y = y
        self.courses = [log(n=len(y))]

    def errors(self, z):
        return z[0] + z[0] ** 3 - self.y


def test_numbers_without_a_kind_are_searched_however_far_away_they_are():
    # nine samples say 2, of which the derivative at 0 knows nothing, and one says 0
    mask = np.arange(10) == 9
    bent = Bent(np.where(mask, 0.0, 10.0))
    J = np.vstack([np.ones((10, 1)), [[1e-9]]])
    moved, left = without_each(bent, np.zeros(1), J, [mask])
    assert moved[0, 0] == pytest.approx(2.0, rel=0.02)
    assert left[0, mask] == pytest.approx([10.0], rel=0.05)


class Levels:
    """Errors of one level for logs of some samples each; remembers which logs it was asked for."""

    bounds = np.full(1, -np.inf), np.full(1, np.inf)

    def __init__(self, courses, asked):
        self.courses, self.asked = courses, asked

    def of(self, courses):
        return Levels(courses, self.asked)

    def errors(self, z):
        return np.concatenate([z[0] - c.position for c in self.courses])

    def __call__(self, z):
        self.asked.append([c.figures["number"] for c in self.courses])
        return np.concatenate([self.errors(z), 1e-9 * z])


def test_a_log_that_is_left_out_is_not_simulated_to_find_numbers_without_it():
    courses = [log(n=n, number=n) for n in (3, 4, 5)]
    for c, level in zip(courses, (1.0, 2.0, 6.0), strict=True):
        c.position += level
    asked = []
    levels = Levels(courses, asked)
    z = np.array([np.mean(np.concatenate([c.position for c in courses]))])
    moved, left = without_each(levels, z, np.append(np.ones((12, 1)), [[1e-9]], 0), kinds(courses))
    assert {tuple(names) for names in asked} == {(4, 5), (3, 5), (3, 4)}
    assert moved[:, 0] == pytest.approx([38 / 9, 33 / 8, 11 / 7], rel=1e-6)
    assert left[0, :3] == pytest.approx(np.full(3, 38 / 9 - 1.0), rel=1e-6)


def test_a_refined_model_is_taken_where_logs_left_out_say_so_beyond_their_scatter():
    before = np.array([1.0, 1.2, 0.8, 1.1])
    assert clearly_less(0.8 * before, before)
    assert not clearly_less(before + np.array([-0.5, 0.3, -0.3, 0.45]), before)
    assert not clearly_less(before, before)


def test_standard_errors_are_widened_until_bands_hold_what_was_left_out():
    line = Line(np.linspace(0.0, 1.0, 2001), np.zeros(2001))
    run = SimpleNamespace(block=np.zeros(BLOCK))
    line.courses = [SimpleNamespace(position=np.zeros(2001), run=run)]

    def cov(wider):
        """The line may be off by 0.01, everywhere alike."""
        return wider**2 * np.diag([0.01**2, 1e-12])

    errors = np.random.default_rng(0).normal(0.0, 0.03, (1, 2001))
    errors[0, :200] = np.nan  # not of this kind
    # of the ten parts of a log alone: Student's band
    wider = 3.0 * student.ppf(0.975, 9) / norm.ppf(0.975)
    assert missing_width(line, np.zeros(2), cov, errors) == pytest.approx(wider, rel=0.05)
    assert missing_width(line, np.zeros(2), cov, 0.1 * errors) == 1.0
    # what a count of the encoder hides asks for nothing
    run.block[COUNT] = 1.0
    assert missing_width(line, np.zeros(2), cov, errors) == 1.0


def test_what_logs_do_not_tell_stays_as_the_prior_has_it():
    J = np.column_stack([np.full(100, 3.0), np.zeros(100)])  # of the second number they say nothing
    one, wide = (uncertain(J.T @ J, np.zeros((2, 2)), w) for w in (1.0, 20.0))
    assert np.diag(one) == pytest.approx([1.0 / 901.0, 1.0])
    assert np.diag(wide) == pytest.approx([1.0 / (900.0 / 400.0 + 1.0), 1.0])
    # and no width of the logs' errors asks for more than the prior allows
    line = Line(np.linspace(0.0, 1.0, 2001), np.zeros(2001))
    line.courses = [
        SimpleNamespace(position=np.zeros(2001), run=SimpleNamespace(block=np.zeros(BLOCK)))
    ]
    far = np.full((1, 2001), 1e6)
    wider = missing_width(line, np.zeros(2), partial(uncertain, J.T @ J, np.zeros((2, 2))), far)
    assert np.diag(uncertain(J.T @ J, np.zeros((2, 2)), wider)) == pytest.approx(
        [1.0, 1.0], rel=1e-4
    )


def test_a_band_holds_readings_of_a_true_prediction_however_coarse_the_encoder():
    rng = np.random.default_rng(0)
    true = rng.normal(0.0, 1.0, 20000)
    for count in (0.01, 0.7, 5.0, 100.0):
        read = count * np.round(true / count)
        low, high = norm.cdf(read - 0.5 * count), norm.cdf(read + 0.5 * count)
        assert np.mean(held(low, high)) == pytest.approx(0.95, abs=0.01)
    # and none of what lies elsewhere
    assert held(np.array([0.0]), np.array([1e-9])) == 0.0


def test_what_an_encoder_rounds_does_not_hide_that_bands_are_too_narrow():
    line = Line(np.linspace(0.0, 1.0, 2001), np.zeros(2001))
    block = np.zeros(BLOCK)
    block[COUNT] = 0.02
    line.courses = [SimpleNamespace(position=np.zeros(2001), run=SimpleNamespace(block=block))]

    def cov(wider):
        return wider**2 * np.diag([0.003**2, 1e-12])

    true = np.random.default_rng(0).normal(0.0, 0.03, (1, 2001)) + np.linspace(0.0, 1.0, 2001)
    errors = 0.02 * np.round(true / 0.02) - np.linspace(0.0, 1.0, 2001)
    wider = 10.0 * student.ppf(0.975, 9) / norm.ppf(0.975)
    assert missing_width(line, np.zeros(2), cov, errors) == pytest.approx(wider, rel=0.05)


def test_steps_keep_derivatives_up_to_date_and_differences_mend_them():
    calls = []

    def residual(z):
        calls.append(z)
        return np.array([z[0] ** 2 + z[1], z[0] * z[1], np.sin(3.0 * z[1])])

    def exact(z):
        return np.array([[2 * z[0], 1.0], [z[1], z[0]], [0.0, 3 * np.cos(3 * z[1])]])

    jacobian = Secant(residual, (np.full(2, -9.0), np.full(2, 9.0)))
    z = np.array([1.0, 0.2])
    # differences over 0.02 of functions whose second derivative is at most 9
    assert jacobian(z) == pytest.approx(exact(z), abs=0.09)
    calls.clear()
    moved = z + np.array([0.1, 0.0])
    updated = jacobian(moved)
    assert len(calls) == 1
    assert updated @ (moved - z) == pytest.approx(residual(moved) - residual(z), abs=1e-12)
    far = np.array([1.0, 1.2])
    assert not jacobian.new
    calls.clear()
    assert jacobian(far) == pytest.approx(exact(far), abs=0.09)
    assert len(calls) == 3
    assert jacobian.new


def test_derivatives_that_tell_some_of_a_step_are_kept():
    """A residual with a fine ripple, which small differences see and steps do not."""
    calls = []

    def residual(z):
        calls.append(z)
        return z + 0.02 * np.sin(40.0 * z)

    jacobian = Secant(residual, (np.full(1, -9.0), np.full(1, 9.0)))
    jacobian(np.array([0.0]))
    calls.clear()
    for x in (0.9, 1.7, 2.4):
        jacobian(np.array([x]))
    assert len(calls) == 3
    assert jacobian(np.array([2.4])) == pytest.approx(1.0, abs=0.1)


def test_the_spread_of_a_mean_over_kinds_is_that_of_their_means():
    # a number that is the mean of four kinds: without one it is the mean of the three others
    means = np.array([1.0, 2.0, 4.0, 9.0])
    z = np.array([means.mean()])
    moved = np.array([[np.delete(means, k).mean()] for k in range(4)])
    masks = [np.arange(8) // 2 == k for k in range(4)]
    expected = np.var(means, ddof=1) / 4
    assert spread(z, moved, masks) == pytest.approx(expected)
    # the same kinds in two ways tell no more
    twice = spread(z, np.vstack([moved, moved]), [*masks, *masks])
    assert twice == pytest.approx(expected)
