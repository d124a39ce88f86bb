"""Logs of simulations with MuJoCo's own `frictionloss`: read as what they are."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from frictionjoint import close_loop
from frictionjoint.identify.base_fit import base_fit
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rival_shape import LEAD, ConstraintShape
from frictionjoint.measured.log import JointLog
from frictionjoint.recordings.drift import drift, known_of
from frictionjoint.report.folder import write_report

LOSS, DAMPING = 0.8, 0.3
BELIEVED = """
<mujoco><option timestep="0.001"/><worldbody><body>
<joint name="j" axis="0 1 0" armature="0.01"/>
<inertial pos="0 0 -0.2" mass="1" diaginertia="0.01 0.01 0.01"/>
</body></worldbody><actuator><motor joint="j"/></actuator></mujoco>"""
TRUE = BELIEVED.replace('name="j"', f'name="j" frictionloss="{LOSS}" damping="{DAMPING}"')


def driven(
    seed: int,
    noise: float,
    true: str = TRUE,
    seconds: float = 15.0,
    sizes: tuple[float, ...] = (0.5, 0.3, 0.1),
    frequencies: tuple[float, ...] = (0.13, 0.31, 0.7),
    gains: tuple[float, float] = (40.0, 2.0),
) -> JointLog:
    """The joint led by a controller along sines, its torque logged with noise, N m."""
    rng = np.random.default_rng(seed)
    model = mujoco.MjModel.from_xml_string(true)
    data = mujoco.MjData(model)
    n = int(seconds / model.opt.timestep)
    f, phase = np.array(frequencies), rng.uniform(0.0, 6.28, 3)
    t, q, torque = (np.zeros(n) for _ in range(3))
    for k in range(n):
        goal = float(np.sum(sizes * np.sin(2.0 * np.pi * f * data.time + phase)))
        data.ctrl[0] = gains[0] * (goal - data.qpos[0]) - gains[1] * data.qvel[0]
        t[k], q[k], torque[k] = data.time, data.qpos[0], data.ctrl[0]
        mujoco.mj_step(model, data)
    torque += noise * rng.standard_normal(n)
    return JointLog(name=f"log{seed}", joint="j", time=t, position=q, torque=torque)


@pytest.mark.parametrize("noise", [0.005, 0.0], ids=["noise", "no noise"])
def test_native_friction_is_found_with_its_size_and_nothing_else(noise):
    report = close_loop([driven(1, noise)], BELIEVED, "j", [driven(3, noise)])
    assert not report.added
    assert not report.unexplained
    assert report.final["Fc_pos"].value == pytest.approx(LOSS, rel=0.01)
    assert report.final["sigma2_pos"].value == pytest.approx(DAMPING, rel=0.03)
    (said,) = [note for note in report.notes if "frictionloss does that" in note]
    lead = float(said.partition("direction ")[2].partition(" ms before the velocity")[0])
    # of the constraint's lead half a step of the simulation is lost
    assert lead == pytest.approx(1e3 * (LEAD - 0.5e-3), abs=0.3)
    assert report.after_torque.held_out < 0.01 * LOSS


@pytest.mark.parametrize("solref", ["0.02", "0.004"])
def test_an_unchanged_joint_of_a_simulation_has_not_changed(solref, tmp_path):
    true = TRUE.replace("frictionloss", f'solreffriction="{solref} 1" frictionloss')
    logs = [driven(seed, 0.02, true=true).part(slice(None, None, 5), "") for seed in range(4)]
    noise = 2e-5 * np.random.default_rng(4).standard_normal(len(logs[0].time))
    logs = [replace(log, position=log.position + noise) for log in logs]
    report = close_loop(logs[:2], BELIEVED, "j", logs[2:3])
    write_report(report, tmp_path, "")
    rows = {row["number"]: row["mean"] for row in report.recordings}
    new = {x.number: x for x in drift(known_of(tmp_path), logs[3:])}
    for number, size in (("Fc", LOSS), ("sigma2", DAMPING)):
        assert (rows[number], new[number].now) == pytest.approx((size, size), rel=0.02)
        assert new[number].state == "confirmed"


def test_friction_with_another_lead_than_a_simulation_is_not_taken_for_one():
    t = 1e-3 * np.arange(15000)
    q = 0.5 * np.sin(2.0 * np.pi * 0.31 * t) + 0.2 * np.sin(2.0 * np.pi * 0.7 * t + 1.0)
    v = np.gradient(q, t)
    a = np.gradient(v, t)
    friction = LOSS * np.clip((v + 0.4 * LEAD * a) / 0.02, -1.0, 1.0) + DAMPING * v
    load = 0.06 * a + 9.81 * 0.2 * np.sin(q)
    noise = 0.005 * np.random.default_rng(0).standard_normal(len(t))
    log = JointLog(name="led", joint="j", time=t, position=q, torque=load + friction + noise)
    _, found = base_fit(prepare([log], RigidBody(BELIEVED, "j")), "integrated")
    assert not isinstance(found.shape, ConstraintShape)
