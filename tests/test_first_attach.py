"""The first attach of a process."""

import subprocess
import sys

PREAMBLE = """
import mujoco, numpy as np, frictionjoint as fj
from frictionjoint.effects import torque_bias
from frictionjoint.rivals import LuGreParameters
from frictionjoint.joint_friction import SimulatedEffect

LUGRE = LuGreParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, sigma0=300.0)
BIAS = [SimulatedEffect(torque_bias.EFFECT, (), (0.2,))]

def model(*install):
    spec = mujoco.MjSpec.from_string(
        "<mujoco><worldbody><body><joint name='j' armature='1'/><geom size='0.1'/></body>"
        "</worldbody></mujoco>"
    )
    if install:
        fj.install(spec, *install)
    return spec.compile()

def run(m):
    d = mujoco.MjData(m)
    d.qfrc_applied[0] = 1.2
    mujoco.mj_step(m, d, 100)
    return d.qpos[0]
"""


def process(script):
    run = subprocess.run(
        [sys.executable, "-c", PREAMBLE + script], check=True, capture_output=True, text=True
    )
    return run.stdout.split("\n")


def test_a_law_that_no_attached_model_has_acts_all_the_same():
    """A model that is not attached, with what no attached one has, is served all the same."""
    late = """
from frictionjoint.simulate.carrier import resolve
plain = fj.FrictionParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, n=2, knots=((0.01, 1.5), (1, 3)))
other = model({"j": plain})
m = model({"j": LUGRE}, {"j": BIAS})
resolve(m)
with fj.attach(other):
    print(run(m))
"""
    early = """
m = model({"j": LUGRE}, {"j": BIAS})
with fj.attach(m):
    print(run(m))
print(run(model()))
"""
    with_friction, without, _ = process(early)
    assert process(late)[0] == with_friction != without
