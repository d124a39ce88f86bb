"""A lone joint that carries more than its MJCF says: simulated, logged, and told."""

import re
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from frictionjoint import close_loop
from frictionjoint.files import toml_text
from frictionjoint.measured.log import JointLog

LOSS, DAMPING, ARMATURE = 0.3, 0.05, 0.02
MODEL = """
<mujoco><option timestep="0.002" integrator="implicitfast"/><worldbody><body>
<joint name="j" axis="0 1 0" armature="{armature}" damping="{damping}" frictionloss="{loss}"/>
<inertial pos="0.15 0 0" mass="{mass}" diaginertia="{turn} {turn} {turn}"/>{more}
</body></worldbody><actuator><motor joint="j"/></actuator></mujoco>"""


def joint(mass=1.0, armature=ARMATURE, damping=DAMPING, loss=LOSS, more=""):
    turn = 0.004 * mass
    return MODEL.format(
        mass=mass, turn=turn, armature=armature, damping=damping, loss=loss, more=more
    )


BELIEVED = joint(damping=0.0, loss=0.0)
PAYLOAD = (
    '<body pos="0.2 0 0.2"><inertial pos="0 0 0" mass="0.25" diaginertia="1e-4 1e-4 1e-4"/></body>'
)


def driven(xml: str, seed: int, gain: float = 1.0, seconds: float = 12.0) -> JointLog:
    """The joint led along sines, its torque logged with noise and a gain."""
    rng = np.random.default_rng(seed)
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    f, phase = rng.uniform(0.1, 1.2, 4), rng.uniform(0.0, 6.28, 4)
    a, w = rng.uniform(0.1, 0.4, 4) / np.sqrt(f), 2.0 * np.pi * f
    t, q, torque = (np.zeros(int(seconds / model.opt.timestep)) for _ in range(3))
    for k in range(len(t)):
        angle = w * data.time + phase
        goal, speed = float(a @ np.sin(angle)), float((a * w) @ np.cos(angle))
        data.ctrl[0] = 60.0 * (goal - data.qpos[0]) + 4.0 * (speed - data.qvel[0])
        t[k], q[k], torque[k] = data.time, data.qpos[0], gain * data.ctrl[0]
        mujoco.mj_step(model, data)
    torque += 0.02 * rng.standard_normal(len(t))
    return JointLog(name=f"log{seed}", joint="j", time=t, position=q, torque=torque)


def told(xml: str, gain: float = 1.0) -> list[set[str]]:
    """Of each effect that is named, its name and those that it is tied with."""
    logs = [driven(xml, seed, gain) for seed in (1, 2, 3)]
    report = close_loop(logs[:2], BELIEVED, "j", logs[2:])
    assert report.after_torque.held_out < 0.05 * LOSS
    return [{step.effect, *step.evidence.ties} for step in report.added]


def test_a_payload_beside_the_link_is_a_mass_and_its_inertia():
    mass, inertia = told(joint(more=PAYLOAD))
    assert mass == {"gravity-error"}
    # beside a mass that is not known a gain of the torque says what an inertia does
    assert inertia == {"inertia-error", "torque-gain"}


def test_an_encoder_zero_that_is_off_is_said_and_so_is_a_knock():
    logs = [driven(joint(), seed) for seed in (1, 2, 3)]
    logs = [replace(log, position=log.position + 0.5) for log in logs]
    knock = 0.6 * (np.abs(logs[1].time - 5.25) < 0.1)
    logs[1] = replace(logs[1], torque=logs[1].torque + knock)
    report = close_loop(logs[:2], BELIEVED, "j", logs[2:])
    (step,) = report.added
    assert step.effect == "gravity-error"
    assert "joint-offset" in step.evidence.ties
    notes = "\n".join(report.notes)
    assert "encoder that reads 0.5 rad too much" in notes
    assert re.search(r"log2: \d+% of the squared error lies in 0.5 s, at 5.[123]", notes)


def test_a_wrong_motor_constant_is_no_mass():
    """It makes the armature's torque too large as well."""
    assert told(joint(), gain=1.15) == [{"torque-gain"}]


def test_with_a_wrong_motor_constant_friction_is_said_to_be_in_the_unit_of_the_log():
    report = close_loop([driven(joint(), 1, 1.2), driven(joint(), 2, 1.2)], BELIEVED, "j")
    assert report.final["Fc_pos"].value == pytest.approx(1.2 * LOSS, rel=0.05)
    (note,) = (note for note in report.notes if "unit of the log" in note)
    assert re.match(
        r"By this fit the logged torque is 1\.(19|2)\d* ± 0\.\d+ times the true one", note
    )
    assert "the logged torque, in whose unit friction is stated" in report.mjcf
    assert "in whose unit friction is stated" in report.summary()
    text = toml_text(report.carried.parameters, report.carried.effects)
    assert "# The unit of torques is that of the log" in text
