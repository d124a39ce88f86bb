"""An effect whose number the logs take beyond what is possible is another thing."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from frictionjoint.diagnose.physical_bounds import LEAST_ACTING, exceeding_friction, impossible
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import improves
from frictionjoint.effects.drive import DRIVE_LIMIT as LIMITED
from frictionjoint.effects.friction_level import FRICTIONAL_LAG as LAG
from frictionjoint.effects.nonlinear_viscous import EFFECT
from frictionjoint.effects.warm_up_drift import EFFECT as WARM_UP
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.search import refit
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import DriveTerm, EffectTerm
from tests.three_sines import INERTIA, A, T, V, logged

LIMIT = EFFECT.shape_bounds[0][1]


@pytest.fixture(scope="module", params=[3.0, LIMIT + 3.0], ids=["possible", "beyond"])
def joint(request, tmp_path_factory):
    """Logs of a joint whose torque has a power of the speed, with the law alone fitted."""
    p, rng = request.param, np.random.default_rng(7)
    speed = np.abs(V) / np.abs(V).max()
    torque = INERTIA * A + np.sign(V) * (0.5 * np.minimum(np.abs(V) / 0.02, 1.0) + speed**p)
    torque += rng.normal(0.0, 0.02, len(T))
    prepared = logged(tmp_path_factory.mktemp("model"), torque)
    return p, prepared, fit(prepared)


def test_a_number_on_its_bound_is_impossible_where_the_logs_go_on_beyond_it(joint):
    p, prepared, base = joint
    found = refit(prepared, (EffectTerm(EFFECT, (2.0,)),), base.shape)
    for _ in range(3):  # a search moves a number so far at most
        found = refit(prepared, found.effects, found.shape)
    (end,) = found.effects[0].shape
    beyond = p > LIMIT
    assert end == pytest.approx(LIMIT if beyond else p, abs=0.2)
    assert impossible(found, make_blocks(prepared, found)) == ({EFFECT.name} if beyond else set())


def test_such_an_effect_is_not_needed_however_much_it_explains(joint):
    p, prepared, base = joint
    found = refit(prepared, (EffectTerm(EFFECT, (0.9 * LIMIT,)),), base.shape)
    blocks = make_blocks(prepared, found)
    now, without = scored(found, blocks), scored(base, blocks)
    assert now.gain(without) > 0.5
    assert improves(now, without) == (p < LIMIT)


@pytest.mark.parametrize(("change", "turned"), [(-0.6, False), (-1.6, True)])
def test_a_friction_that_drives_the_joint_is_impossible(change, turned, tmp_path):
    """Each of its numbers has a sign that is possible: together they take more than all away."""
    tau, rng = 0.5 * T[-1], np.random.default_rng(8)
    level = 1.0 + change * np.exp(-T / tau)
    torque = INERTIA * A + level * np.sign(V) * np.minimum(np.abs(V) / 0.02, 1.0)
    prepared = logged(tmp_path, torque + rng.normal(0.0, 0.02, len(T)))
    found = refit(prepared, (EffectTerm(WARM_UP, (tau,)),), fit(prepared).shape)
    assert found.term_coefficients(0)[0] == pytest.approx(change, rel=0.2)
    assert (WARM_UP.name in impossible(found, make_blocks(prepared, found))) == turned


def test_a_drive_of_which_nothing_acts_has_moved_nothing():
    terms = (DriveTerm(LIMITED, (1e-9,)), EffectTerm(EFFECT, (2.0,)))
    nothing = SimpleNamespace(acting=0.1 * LEAST_ACTING, terms=terms)
    assert impossible(nothing, None) == {LIMITED.name}


@pytest.mark.parametrize(("size", "tau"), [(0.4, 0.05), (20.0, 0.005)], ids=["a part", "beyond"])
def test_no_part_of_friction_is_larger_than_all_friction(size, tau, tmp_path):
    """In slow motion a lag is the size times the time constant: little acts of a large one."""
    h = T[1] - T[0]
    slow = np.exp(-((V / (0.2 * np.abs(V).max())) ** 2))
    late = lfilter([h / tau], [1.0, h / tau - 1.0], slow, zi=[slow[0] * (1.0 - h / tau)])[0]
    level = 1.0 + 0.5 * slow + size * (late - slow)
    torque = INERTIA * A + level * np.sign(V) * np.minimum(np.abs(V) / 0.02, 1.0)
    prepared = logged(tmp_path, torque + np.random.default_rng(9).normal(0.0, 0.02, len(T)))
    lag = EffectTerm(LAG, (tau, 0.2 * np.abs(V).max(), 1e-6))
    found = refit(prepared, (lag,), fit(prepared).shape)
    assert [t.name for t in exceeding_friction(found)] == [LAG.name] * (size > 1.5)
