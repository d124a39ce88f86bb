"""Numbers with which a torque leaps: sought in finite steps, with errors that squares tell."""

from dataclasses import replace

import numpy as np
import pytest
from round_trip_drive import nominated, servo_logs
from scipy.optimize import least_squares
from servo_plant import COUNT, PLANT

from frictionjoint.effects import backlash, torque_bias
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.layout import Layout
from frictionjoint.identify.load_coefficients import less_load, with_load, with_sizes
from frictionjoint.identify.nonsmooth_errors import with_leaps
from frictionjoint.identify.pattern_search import pattern_search
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.identify.uncertainty import covariance


def rough(x):
    """A valley of two numbers about (3, 5) with dents 2% wide."""
    u, v = np.log(x[0] / 3.0), np.log(x[1] / 5.0)
    return np.array([u + v, 2.0 * (u - v), 0.1 * np.sin(300.0 * u), 0.1 * np.sin(300.0 * v)])


def test_a_dent_of_a_valley_is_not_its_end():
    x = np.array([3.6, 4.2])
    low, high = np.full(2, 0.1), np.full(2, 100.0)
    stuck = least_squares(rough, x, bounds=(low, high)).x
    found = pattern_search(lambda x: float(np.sum(rough(x) ** 2)), x, (0, 1), low, high)
    assert np.abs(stuck / (3.0, 5.0) - 1.0).max() > 0.05
    np.testing.assert_allclose(found, (3.0, 5.0), rtol=0.03)


def test_a_search_in_steps_stays_in_range_and_moves_what_it_may():
    x, low, high = np.array([2.0, 2.0]), np.array([0.0, 0.0]), np.array([3.0, 9.0])
    found = pattern_search(lambda x: float(np.sum((x - 5.0) ** 2)), x, (0,), low, high)
    np.testing.assert_allclose(found, (3.0, 2.0))


@pytest.mark.parametrize("base", [("Fc",), ("load", "Fc")])
def test_what_changes_the_load_is_as_large_as_the_load(base):
    terms = (EffectTerm(torque_bias.EFFECT), EffectTerm(backlash.EFFECT, (1e-3, 8.0, 0.5, 0.0)))
    layout = Layout(base, (), terms)
    rng = np.random.default_rng(5)
    X = rng.normal(size=(50, len(base) + 2))
    true = rng.uniform(0.5, 2.0, X.shape[1])
    true[-1] = true[0] if "load" in base else 1.0
    y = X @ true
    free = with_load(X, layout)
    assert not free[:, -1].any()
    found = np.linalg.lstsq(free, less_load(X, y, layout), rcond=None)[0]
    np.testing.assert_allclose(with_sizes(found, layout), true, rtol=1e-10)


def test_other_effects_keep_their_sizes():
    layout = Layout(("load", "Fc"), (), (EffectTerm(torque_bias.EFFECT),))
    X, beta = np.ones((4, 3)), np.arange(3.0)
    assert with_load(X, layout) is X
    assert with_sizes(beta, layout) is beta
    assert replace(layout).linear == slice(0, 3)


def test_an_error_reaches_as_far_as_the_squares_do_not_rise():
    believed, made = servo_logs("deadband", 0)
    prepared = prepare(made, RigidBody(PLANT.format(""), "j"), controller=believed)
    _, found = nominated(prepared, "deadband", None)
    at = next(i for i, t in enumerate(found.terms) if t.name == "deadband")
    k = found.layout.numbers(at).start
    block = make_blocks(prepared, found).of_sample
    plain = covariance(prepared, found, block)
    # as if the jacobian knew the number to a thousandth of a count, where no sample tells
    sure = plain.copy()
    sure[k] *= 1e-3 * COUNT / np.sqrt(plain[k, k])
    sure[:, k] *= 1e-3 * COUNT / np.sqrt(plain[k, k])
    error = np.sqrt(with_leaps(prepared, found, sure, block)[k, k])
    assert 0.00125 * COUNT < error < 0.5 * COUNT
    # and never below what the jacobian says
    wide = with_leaps(prepared, found, plain * 1e4, block)
    np.testing.assert_array_equal(wide, plain * 1e4)
