"""Controllers that are the model's own position servos."""

import mujoco
import numpy as np
import pytest

from frictionjoint.control import Controller
from frictionjoint.control.controller_file import controller_of
from frictionjoint.control.reconstruct import commands
from frictionjoint.errors import ParameterError
from frictionjoint.measured.log import JointLog

MODEL = """
<mujoco><worldbody><body><joint name="j" axis="0 1 0" {joint}/>
<geom size="0.05" pos="0 0 -0.2" mass="0.5"/>
<body pos="0 0 -0.3"><joint name="free"/><geom size="0.01"/></body></body></worldbody>
<actuator>{actuator}</actuator></mujoco>"""
SERVO = '<position name="a" joint="j" kp="20" kv="1.5" forcerange="-3 3" gear="2"/>'


def model(actuator: str, joint: str = "") -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(MODEL.format(actuator=actuator, joint=joint))


def test_a_servo_has_its_gains_at_the_joint():
    """Through a gear, the joint's stiffness grows with its square, the torque with the gear."""
    found = controller_of("mjcf", "j", [model(SERVO)])
    expected = Controller(output="torque_nm", kp=80.0, kd=6.0, limit=6.0, source="the MJCF")
    assert found == expected
    limited = controller_of("mjcf", "j", [model(SERVO, 'actuatorfrcrange="-4 4"')])
    assert limited.limit == 4.0


def test_its_drive_is_that_of_the_simulation():
    made = model(SERVO)
    data = mujoco.MjData(made)
    n, h = 800, made.opt.timestep
    target = 0.5 * np.sin(12.0 * h * np.arange(n))
    q, v, torque = np.zeros((3, n))
    for k in range(n):
        q[k], v[k], data.ctrl[0] = data.qpos[0], data.qvel[0], 2.0 * target[k]
        mujoco.mj_step(made, data)
        torque[k] = data.qfrc_actuator[0]
    assert np.ptp(torque) > 1.0
    log = JointLog(
        name="log", joint="j", time=h * np.arange(n), position=q, velocity=v, target=target
    )
    found = commands(log, controller_of("mjcf", "j", [made])).drive()
    # a controller reads its velocity from the positions, which is that of half a step before
    assert found[5:-5] == pytest.approx(torque[5:-5], abs=0.02 * np.ptp(torque))


@pytest.mark.parametrize(
    ("actuator", "message"),
    [
        ("", "no actuator on joint 'j'"),
        (SERVO + SERVO.replace('"a"', '"b"'), "2 actuators on joint 'j'"),
        ('<motor name="a" joint="j"/>', "'a' of joint 'j' is no position servo"),
        ('<velocity name="a" joint="j" kv="2"/>', "'a' of joint 'j' is no position servo"),
        (SERVO.replace("/>", ' timeconst="0.1"/>'), "without dynamics of its own"),
        (SERVO.replace("-3 3", "-3 5"), "forcerange of joint 'j' is -3 to 5"),
    ],
)
def test_what_is_no_such_controller_is_refused(actuator, message):
    with pytest.raises(ParameterError, match=message) as found:
        controller_of("mjcf", "j", [model(actuator)])
    assert "\n" not in str(found.value)


def test_loads_have_the_same_servo():
    stiffer = model(SERVO.replace('"20"', '"30"'))
    with pytest.raises(ParameterError, match="different servos at joint 'j'"):
        controller_of("mjcf", "j", [model(SERVO), stiffer])
