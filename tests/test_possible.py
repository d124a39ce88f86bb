"""An effect whose number the logs take beyond what is possible is another thing."""

import numpy as np
import pytest

from frictionjoint.diagnose.blocks import make_blocks
from frictionjoint.diagnose.possible import impossible
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import needed
from frictionjoint.effects.nonlinear_viscous import EFFECT
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import refit
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.measured.log import JointLog

MODEL = """<mujoco><worldbody><body><joint name="j" axis="0 0 1"/>
<inertial pos="0 0 0" mass="1" diaginertia="1 1 0.05"/></body></worldbody></mujoco>"""
LIMIT = EFFECT.shape_bounds[0][1]


@pytest.fixture(scope="module", params=[3.0, LIMIT + 3.0], ids=["possible", "beyond"])
def joint(request, tmp_path_factory):
    """Logs of a joint whose torque has a power of the speed, with the law alone fitted."""
    p, rng = request.param, np.random.default_rng(7)
    t = np.arange(0.0, 40.0, 2e-3)
    lines = [(0.9, 0.31), (0.5, 0.73), (0.3, 1.31)]
    q, v, a = (
        sum(
            A * (2 * np.pi * f) ** k * np.sin(2 * np.pi * f * t + 0.5 * np.pi * k) for A, f in lines
        )
        for k in range(3)
    )
    speed = np.abs(v) / np.abs(v).max()
    torque = 0.05 * a + np.sign(v) * (0.5 * np.minimum(np.abs(v) / 0.02, 1.0) + speed**p)
    torque += rng.normal(0.0, 0.02, len(t))
    file = tmp_path_factory.mktemp("model") / "j.xml"
    file.write_text(MODEL)
    log = JointLog(name="log", joint="j", time=t, position=q, torque=torque)
    prepared = prepare([log], RigidBody(file, "j"))
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
    assert needed(now, without) == (p < LIMIT)
