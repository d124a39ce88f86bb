"""The friction torque that is read is the one that acts, part by part."""

import dataclasses

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.effects.rigid_body import SPRING, TORQUE_BIAS
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.rivals import ElastoplasticParameters, LuGreParameters, StaticParameters
from tests.standing import plain_mass

KNOTS = ((1e-2, 1.5), (1e-1, 3.2))
LAWS = {
    "integrated": fj.FrictionParameters.symmetric(
        Fs=1.5, Fc=1.0, Vs=0.05, sigma1=0.3, sigma2=0.2, n=2, knots=KNOTS
    ),
    "lugre": LuGreParameters.symmetric(
        Fs=1.5, Fc=1.0, Vs=0.05, sigma0=300.0, sigma1=0.3, sigma2=0.2
    ),
}


# level 1 N m, with and without presliding of their own
LEVEL = {"Fs": 1.0, "Fc": 1.0, "Vs": 0.05, "sigma2": 20.0}
ONE = [
    fj.FrictionParameters.symmetric(**LEVEL, n=2, knots=((1e-4, 1.0), (1e-3, 2.1))),
    StaticParameters.symmetric(**LEVEL, V0=0.01),
    LuGreParameters.symmetric(**LEVEL, sigma0=1e4, sigma1=0.0),
    ElastoplasticParameters.symmetric(**LEVEL, sigma0=1e4, sigma1=0.0, breakaway=0.8),
]
JOINT = """
<mujoco>
  <option timestep="0.001" gravity="0 0 0"/>
  <worldbody>
    <body><joint name="j" armature="1"/><geom size=".1"/></body>
    <body><joint name="other"/><geom size=".1"/></body>
  </worldbody>
  <sensor><user name="friction" objtype="joint" objname="j" dim="2" needstage="acc"/></sensor>
</mujoco>
"""


def model(law="integrated", effects=()):
    spec = mujoco.MjSpec.from_string(JOINT)
    fj.install(spec, {"j": LAWS[law]}, {"j": list(effects)})
    return spec.compile()


def pushed(m):
    """States after each step of a push that breaks the joint away and turns round."""
    data = mujoco.MjData(m)
    for k in range(400):
        data.qfrc_applied[0] = 2.5 * np.sin(0.02 * k)
        mujoco.mj_step(m, data)
        mujoco.mj_forward(m, data)
        yield data


def acted(m, data):
    """What Newton's law leaves for friction: applied torque less inertia times acceleration."""
    return data.qfrc_applied[0] - (plain_mass(m, data.qpos) @ data.qacc)[0]


@pytest.mark.parametrize("law", LAWS)
def test_the_parts_are_those_of_the_law_and_add_up_to_what_acts(law):
    m = model(law)
    times, path, states = [0.0], [0.0], set()
    with fj.attach(m):
        for data in pushed(m):
            (name, read), *more = fj.torque(m, data).items()
            assert (name, more) == ("j", [])
            assert read.total == pytest.approx(acted(m, data), abs=1e-12)
            assert read.time == data.time
            assert read.viscous == 0.2 * data.qvel[0]
            times.append(data.time)
            path.append(data.qpos[0])
            states.add(read.sticks)
    assert states == {True, False}, "it never broke away"
    parts = read.hysteresis + read.damping + read.viscous + read.implicit
    assert parts == pytest.approx(read.total, rel=1e-14)
    bristles = dataclasses.replace(LAWS[law], sigma1=0.0, sigma2_pos=0.0, sigma2_neg=0.0)
    alone = fj.friction_torque(bristles, times, path)[-1]
    assert read.hysteresis == pytest.approx(alone, rel=1e-9)


def test_effects_are_read_one_by_one():
    effects = [
        SimulatedEffect(TORQUE_BIAS, (), (0.25,)),
        SimulatedEffect(SPRING, (), (0.7, 0.1)),
        SimulatedEffect(TORQUE_BIAS, (), (-0.05,)),
    ]
    m = model(effects=effects)
    with fj.attach(m):
        data = list(pushed(m))[-1]
        read = fj.torque(m, data)["j"]
    assert list(read.effects) == ["torque-bias", "spring", "torque-bias_2"]
    assert read.effects["torque-bias"] == 0.25
    assert read.effects["torque-bias_2"] == -0.05
    assert read.effects["spring"] == pytest.approx(0.7 * data.qpos[0] + 0.1)
    assert read.total == pytest.approx(acted(m, data), rel=1e-12)


@pytest.mark.parametrize("load", [0.6, 1.02])
@pytest.mark.parametrize("law", ONE, ids=lambda law: law.law)
def test_a_joint_that_drifts_does_not_stick(law, load):
    """Below breakaway it sticks and stays; beyond it goes and does not stick, however slowly."""
    spec = mujoco.MjSpec.from_string(JOINT)
    fj.install(spec, {"j": law})
    m, still = spec.compile(), []
    data = mujoco.MjData(m)
    data.qfrc_applied[0] = load
    with fj.attach(m):
        mujoco.mj_step(m, data, nstep=3000)
        begin = data.qpos[0]
        for _ in range(1000):
            mujoco.mj_step(m, data)
            read = fj.torque(m, data)["j"]
            still.append(read.sticks)
    assert read.time == pytest.approx(data.time - m.opt.timestep)
    went = abs(data.qpos[0] - begin)
    assert all(still) if load < 1.0 else not any(still)
    assert went < 1e-6 if load < 1.0 else went > 1e-4
