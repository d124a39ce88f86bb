"""A drive of known size explains a motion only as far as it acts: without one little is left."""

import numpy as np
import pytest

from frictionjoint.control import Controller
from frictionjoint.diagnose.blocks import make_blocks
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.trace import trace
from frictionjoint.effects.catalogue import DRIVE_EFFECTS
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.terms import DriveTerm
from frictionjoint.measured.log import JointLog

KP, KD, TICK = 20.0, 1.5, 1e-3
CONTROLLER = Controller(output="torque_nm", kp=KP, kd=KD)
BELIEVED, VISCOUS, LEVEL = 0.006, 0.5, 0.25
MODEL = f"""<mujoco><option gravity="0 0 0"/><worldbody><body><joint name="j" axis="0 0 1"/>
<inertial pos="0 0 0" mass="0.1" diaginertia="{BELIEVED} {BELIEVED} {BELIEVED}"/></body>
</worldbody></mujoco>"""
LIMIT = next(effect for effect in DRIVE_EFFECTS if effect.name == "drive-limit")


def leg(inertia: float) -> JointLog:
    """A leg's joint that swings quickly under a PD controller, 16 s at 200 Hz."""
    n = 16_000
    time = TICK * np.arange(n)
    target = 0.3 * np.sin(2.0 * np.pi * 1.3 * time) + 0.15 * np.sin(2.0 * np.pi * 3.1 * time + 0.7)
    position = np.empty(n)
    q = v = 0.0
    for k in range(n):
        position[k] = q
        torque = KP * (target[k] - q) - KD * v
        torque -= VISCOUS * v + LEVEL * np.tanh(v / 0.01)
        v += TICK * torque / inertia
        q += TICK * v
    noise = 2e-4 * np.random.default_rng(3).standard_normal(n)
    kept = slice(None, None, 5)
    return JointLog(
        name="leg", joint="j", time=time[kept], position=(position + noise)[kept],
        target=target[kept],
    )  # fmt: skip


@pytest.fixture(scope="module")
def heavier() -> Prepared:
    """Its MJCF holds a fifth of the inertia: the link, and not what the rotor adds."""
    return prepare([leg(5.0 * BELIEVED)], RigidBody(MODEL, "j"), controller=CONTROLLER)


def test_a_drive_that_hardly_acts_explains_nothing(heavier):
    found = trace(heavier, law="integrated")
    base, blocks = found.base, make_blocks(heavier, found.base)
    none = refit(heavier, (DriveTerm(LIMIT, (1e-4,)),), base.shape, ROUGH)
    # what is left without a drive, in N m, is less than what the missing inertia leaves
    assert none.acting < 1e-3
    assert none.rms < base.rms
    assert scored(none, blocks).gain(scored(base, blocks)) < 0.0


def test_what_the_model_lacks_is_named_and_no_drive_that_does_not_act(heavier):
    found = trace(heavier)
    assert not {f.term.name for f in found.findings} & {effect.name for effect in DRIVE_EFFECTS}
