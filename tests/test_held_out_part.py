"""The end of a log held out: as warm as what came before left the joint, at the log's own time."""

import numpy as np
import pytest

from frictionjoint.diagnose.joint_logs import prepare_kept_back
from frictionjoint.effects.warm_up_drift import BY_LOSS
from frictionjoint.effects.warm_up_drift import EFFECT as BY_TIME
from frictionjoint.errors import LogError
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.start import predict
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.measured.log import JointLog, split_in_time

DT, SECONDS, TAU, LEVEL, INERTIA = 2e-3, 30.0, 8.0, 0.5, 0.3
BODY = RigidBody(
    f"""<mujoco><option gravity="0 0 0"/><worldbody><body><joint name="arm" axis="0 0 1"/>
    <inertial pos="0 0 0" mass="1" diaginertia=".2 .2 {INERTIA}"/></body></worldbody></mujoco>""",
    "arm",
)


def warming() -> JointLog:
    """Friction that falls to half while the joint works."""
    t = DT * np.arange(int(SECONDS / DT))
    parts = [(0.5, 2.0, 0.0), (0.3, 3.3, 1.0), (0.2, 5.1, 2.0)]
    q = sum(a * np.sin(w * t + p) for a, w, p in parts)
    v = sum(a * w * np.cos(w * t + p) for a, w, p in parts)
    acceleration = sum(-a * w**2 * np.sin(w * t + p) for a, w, p in parts)
    level = LEVEL * (1.0 + np.exp(-t / TAU))
    torque = INERTIA * acceleration + level * np.tanh(v / 0.02)
    noise = 1e-3 * np.random.default_rng(1).normal(size=len(t))
    return JointLog(name="warming", joint="arm", time=t, position=q, torque=torque + noise)


@pytest.mark.parametrize("effect", [BY_TIME, BY_LOSS])
def test_what_warmed_up_stays_warm_in_the_part_held_out(effect):
    first, last = split_in_time(warming(), 0.3)
    fitted_on = prepare([first], BODY)
    kept_back = prepare_kept_back([last], BODY, fitted_on)
    shape = (TAU,) if effect is BY_TIME else (TAU, 10.0)
    fitted = fit(fitted_on, (EffectTerm(effect, shape),))
    left = predict(kept_back, fitted).error
    # taken as cold it is half of the level
    assert np.sqrt(np.mean(left**2)) < 0.1 * LEVEL


def test_a_part_of_next_to_no_samples_tests_nothing():
    first, last = split_in_time(warming(), 0.004)
    fitted_on = prepare([first], BODY)
    with pytest.raises(LogError, match=r"independent samples: hold out a longer part or log"):
        prepare_kept_back([last], BODY, fitted_on)
