"""MuJoCo 4.0's springs that yield work together with friction."""

import contextlib

import mujoco
import numpy as np
import pytest

import frictionjoint as fj

pytestmark = pytest.mark.skipif(
    not hasattr(mujoco.MjsJoint, "springyield"), reason="springs yield from MuJoCo 4.0 on"
)
TWO = """<mujoco><compiler angle="radian"/>
<option timestep="0.001" gravity="0 0 0" integrator="implicitfast"/><worldbody>
<body><joint name="yields" armature="0.1" {joint}/><geom size=".1" mass=".1"/></body>
<body><joint name="other" armature="0.1"/><geom size=".1" mass=".1"/></body></worldbody>
{tendon}</mujoco>"""
# a spring of 20 N m/rad that yields at 1 N m
SPRING = 'stiffness="20" springyield="0.05"'
TENDON = (
    f'<tendon><fixed {SPRING} springlength="0"><joint joint="yields" coef="1"/></fixed></tendon>'
)
KINDS = {"joint": {"joint": SPRING, "tendon": ""}, "tendon": {"joint": "", "tendon": TENDON}}
FRICTION = fj.FrictionParameters.symmetric(Fs=1.5, Fc=1.2, Vs=0.05, knots=((1e-2, 3.2),))


def path(kind: str, joints: tuple[str, ...], torque: np.ndarray) -> np.ndarray:
    """Position of the joint with the spring and its yielded part, shape (len(torque), 2)."""
    spec = mujoco.MjSpec.from_string(TWO.format(**KINDS[kind]))
    if joints:
        fj.install(spec, dict.fromkeys(joints, FRICTION))
    model = spec.compile()
    data = mujoco.MjData(model)
    found = []
    with fj.attach(model) if joints else contextlib.nullcontext():
        for each in torque:
            data.qfrc_applied[0] = each
            mujoco.mj_step(model, data)
            found.append([data.qpos[0], data.plastic[0]])
    return np.array(found)


@pytest.mark.parametrize("kind", KINDS)
def test_friction_of_another_joint_leaves_a_yielding_spring_as_it_is(kind):
    torque = 1.5 * np.sin(0.006 * np.arange(1500))
    alone = path(kind, (), torque)
    assert np.ptp(alone[:, 1]) > 0.05, "it yields"
    np.testing.assert_array_equal(path(kind, ("other",), torque), alone)


@pytest.mark.parametrize("kind", KINDS)
def test_a_joint_with_both_breaks_away_at_the_sum_of_both_levels(kind):
    torque = np.linspace(0.0, 3.0, 6000)
    position = path(kind, ("yields",), torque)[:, 0]
    away = torque[np.argmax(position > 0.2)]
    assert away == pytest.approx(1.5 + 1.0, abs=0.1)
    held = path(kind, ("yields",), np.minimum(torque, 2.2))[:, 0]
    assert abs(held[-1] - held[-1500]) < 1e-3
