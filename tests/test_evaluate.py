"""How far a model is from logs, whatever friction it has. The logs are MuJoCo simulations."""

import json
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from command_line import run
from hypothesis import given, settings
from hypothesis import strategies as st

import frictionjoint as fj
from frictionjoint.errors import FrictionJointError
from frictionjoint.measured.log import JointLog

STEP, EVERY, SECONDS = 5e-4, 4, 8.0
TIME = STEP * np.arange(int(SECONDS / STEP))
TWO_SINES = 1.1 * np.sin(3.0 * TIME) + 0.6 * np.sin(7.1 * TIME + 1.0)
ARM = """<mujoco><option timestep="0.0005" integrator="implicitfast"/><worldbody><body>
<joint name="elbow" axis="0 1 0" {joint}/><inertial pos="0.2 0 0" mass="0.5" diaginertia="1e-3 1e-3
1e-3"/>{more}</body></worldbody>{end}</mujoco>"""


def arm(joint: str = "", more: str = "", end: str = "") -> str:
    return ARM.format(joint=joint, more=more, end=end)


NONE = arm()
COULOMB = arm(
    'frictionloss="0.3" damping="0.05" solimpfriction="0.99 0.999 0.001" solreffriction="0.001 1"'
)
LUGRE = arm(
    end='<actuator><dcmotor name="f" joint="elbow" input="none" motorconst="1e-6" resistance="1" '
    'lugre="300 0.5 0.3 0.35 0.1"/></actuator>'
)
YIELD = arm(
    end='<tendon><fixed stiffness="300" springlength="0" springyield="0.001"><joint joint="elbow" '
    'coef="1"/></fixed></tendon>'
)

# a link behind a spring, and behind a gap of 0.02 rad
BEHIND = '<joint name="elbow_deflection" axis="0 1 0" {}/>'
ELASTIC, PLAY = (
    arm('armature="0.02" damping="0.3"', BEHIND.format(more))
    for more in (
        'stiffness="60" damping="0.05"',
        'limited="true" range="-0.573 0.573" solimplimit="0.0001 0.0001 1 0.5 1" '
        'solreflimit="-10000 -80"',
    )
)


def simulated(mjcf: str, drive: str = "torque", course: np.ndarray = TWO_SINES) -> JointLog:
    """A log of an arm under a torque that moves it past both directions, or under its control."""
    model = mujoco.MjModel.from_xml_string(mjcf)
    data = mujoco.MjData(model)
    given, position = course.copy(), np.empty_like(TIME)
    for k in range(len(TIME)):
        position[k] = data.qpos[0]
        if drive == "torque":
            # gravity compensated, so that the motion stays in reach
            given[k] += data.qfrc_bias[0]
            data.qfrc_applied[0] = given[k]
        else:
            data.ctrl[0] = given[k]
        mujoco.mj_step(model, data)
    kept = slice(None, None, EVERY)
    driven = {drive: given[kept]}
    return JointLog(name="log", joint="elbow", time=TIME[kept], position=position[kept], **driven)


@pytest.mark.parametrize("name", ["none", "coulomb", "lugre", "yield", "elastic", "play"])
def test_a_model_that_made_the_log_is_near_it_and_another_is_not(name: str) -> None:
    if name == "yield" and not hasattr(mujoco.MjModel, "jnt_springyield"):
        pytest.skip("yield springs need MuJoCo 4.0")
    models = {"none": NONE, "coulomb": COULOMB, "lugre": LUGRE, "yield": YIELD}
    model = (models | {"elastic": ELASTIC, "play": PLAY})[name]
    log = simulated(model)
    own = fj.evaluate(model, [log]).joints["elbow"]
    other = fj.evaluate(NONE if name != "none" else COULOMB, [log]).joints["elbow"]
    assert own.torque_percent < 6.0
    assert other.torque_percent > 4.0 * own.torque_percent
    assert other.torque_rms > 0.2
    assert own.replay_rms < 0.25 * other.replay_rms
    words = {
        "none": "none",
        "coulomb": "frictionloss 0.3 and damping 0.05",
        "lugre": "dcmotor f with LuGre friction",
        "yield": "1 yield spring",
        "elastic": "damping 0.3",
        "play": "damping 0.3",
    }
    assert own.friction == words[name]


def test_our_friction_is_evaluated_as_any_other(tmp_path: Path) -> None:
    spec = mujoco.MjSpec.from_string(NONE)
    friction = fj.FrictionParameters.symmetric(
        Fs=0.4, Fc=0.3, Vs=0.1, sigma2=0.05, knots=((0.0005, 0.5), (0.002, 0.8))
    )
    fj.install(spec, {"elbow": friction})
    mjcf = spec.to_xml()
    fj.enable()
    try:
        log = simulated(mjcf)
    finally:
        fj.disable()
    own = fj.evaluate(mjcf, [log]).joints["elbow"]
    assert own.friction == "frictionjoint law integrated"
    assert own.torque_percent < 4.0
    other = fj.evaluate(NONE, [log]).joints["elbow"]
    assert other.torque_percent > 20.0
    assert own.replay_rms < 0.1 * other.replay_rms


def test_a_voltage_is_the_control_of_the_motor_in_the_model() -> None:
    motor = arm(
        'damping="0.3"',
        end='<actuator><dcmotor name="m" joint="elbow" motorconst="0.8" resistance="0.5"/>'
        "</actuator>",
    )
    log = simulated(motor, "voltage")
    found = fj.evaluate(motor, [log]).joints["elbow"]
    assert found.torque_percent < 5.0
    assert found.drive_rms > 0.3
    with pytest.raises(FrictionJointError, match="contains a voltage and the model"):
        fj.evaluate(NONE, [log])


def test_a_target_needs_a_controller_and_gives_a_closed_loop() -> None:
    servo = arm(
        'damping="0.2"',
        end='<actuator><position name="s" joint="elbow" kp="30" kv="1"/></actuator>',
    )
    log = simulated(servo, "target", 0.6 * np.sin(2.0 * TIME))
    found = fj.evaluate(servo, [log]).joints["elbow"]
    assert found.closed_loop_mae < 1e-3
    assert found.replay_rms is None
    assert found.torque_percent < 2.0
    jitter = np.random.default_rng(3).uniform(-2e-8, 2e-8, len(log.time))
    shaken = replace(log, time=log.time + jitter)
    assert fj.evaluate(servo, [shaken]).joints["elbow"].closed_loop_mae == pytest.approx(
        found.closed_loop_mae, rel=0.05
    )
    stiff = servo.replace('damping="0.2"', 'damping="2"')
    assert fj.evaluate(stiff, [log]).joints["elbow"].closed_loop_mae > 0.01
    with pytest.raises(FrictionJointError, match="--controller FILE"):
        fj.evaluate(NONE, [log])


@settings(max_examples=12, deadline=None)
@given(
    size=st.sampled_from([0.0, 1e-12, 1e-6, 1e-3, 1.0, 1e3]),
    off=st.floats(0.0, 1.0),
    at_rest=st.floats(0.0, 0.95),
    model=st.sampled_from([NONE, COULOMB]),
)
def test_no_figure_is_impossible(size: float, off: float, at_rest: float, model: str) -> None:
    """A drive of nothing, one that is off for a while, a part without motion: said or left out."""
    log = simulated(COULOMB)
    n = len(log.time)
    position, torque = log.position.copy(), size * log.torque
    position[: int(at_rest * n)] = position[int(at_rest * n)]
    torque[n - int(off * n) :] = 0.0
    odd = JointLog(name="a", joint="elbow", time=log.time, position=position, torque=torque)
    try:
        found = fj.evaluate(model, [odd])
    except FrictionJointError:
        return
    judged = found.joints["elbow"]
    figures = (judged.torque_rms, judged.torque_percent, judged.replay_rms)
    assert all(x is None or np.isfinite(x) for x in figures)
    if judged.torque_percent is None:
        assert any("known drive" in x or "next to nothing" in x for x in found.notes)
    else:
        assert judged.torque_percent <= 1000.0
        said = any("more than the whole drive" in x for x in found.notes)
        assert said == (judged.torque_percent > 100.0)
    if judged.replay_rms is not None:
        assert judged.replay_rms <= np.ptp(position)


def test_the_command_writes_a_page_and_prints_json(tmp_path: Path) -> None:
    log = simulated(COULOMB)
    rows = np.column_stack([log.time, np.degrees(log.position), log.torque])
    path = tmp_path / "a.csv"
    np.savetxt(
        path, rows, delimiter=",", header="time_s,position_rad,torque_nm", comments="", fmt="%.9g"
    )
    (tmp_path / "arm.xml").write_text(COULOMB)
    out = tmp_path / "out"
    given = ("evaluate", tmp_path / "arm.xml", path, "--unit", "position=deg", "--out", out)
    done = run(*given, "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found == json.loads((out / "evaluation.json").read_text())
    assert found["joints"]["elbow"]["torque_percent"] < 6.0
    assert "needed by the model" in (out / "evaluation.html").read_text()
    wrong = run("evaluate", "arm.xml", "a.csv", "--joint", "wrist", cwd=tmp_path)
    assert wrong.returncode == 2
    assert "no hinge or slide joint 'wrist' in the model: it has elbow" in wrong.stderr
