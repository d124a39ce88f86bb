"""The loss that MuJoCo's issue 3528 proposes for gears: it grows with the torque transmitted, times
a state that turns over with the motion as Dahl's does. Four numbers: level, growth with the torque,
length, viscosity. Here it is Dahl's law and friction that grows with load."""

import numpy as np
import pytest
from numba import njit

from frictionjoint import friction_torque
from frictionjoint.diagnose.trace import trace
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import law_parameters, term_estimates
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.readers import read_log

LEVEL, GROWTH, STIFFNESS, VISCOSITY = 0.8, 0.08, 400.0, 0.3
MASS, LENGTH, OWN_INERTIA = 3.0, 0.2, 0.18
INERTIA, WEIGHT = OWN_INERTIA + MASS * LENGTH**2, MASS * 9.81 * LENGTH
XML = f"""<mujoco><worldbody><body><joint name="joint" axis="0 1 0"/>
<inertial pos="0 0 {-LENGTH}" mass="{MASS}"
diaginertia="{OWN_INERTIA} {OWN_INERTIA} {OWN_INERTIA}"/></body></worldbody></mujoco>"""
# s of a sample, and steps in one
SAMPLE, STEPS = 0.004, 80


@njit
def led(target):
    """Position and torque of the joint under a PD controller, by semi-implicit Euler steps."""
    h, q, v, turned, a = SAMPLE / STEPS, target[0], 0.0, 0.0, 0.0
    position, torque = np.empty(len(target)), np.empty(len(target))
    for k in range(len(target)):
        drive = 300.0 * (target[k] - q) - 20.0 * v
        position[k], torque[k] = q, drive
        for _ in range(STEPS):
            hanging = WEIGHT * np.sin(q)
            for _ in range(3):  # the loss takes of the acceleration that it depends on
                transmitted = abs(INERTIA * a + hanging)
                loss = (LEVEL + GROWTH * transmitted) * turned + VISCOSITY * v
                a = (drive - hanging - loss) / INERTIA
            v += h * a
            q += h * v
            direction = 1.0 if v > 0.0 else -1.0
            turned = direction - (direction - turned) * np.exp(-STIFFNESS * h * abs(v))
    return position, torque


def test_it_is_dahls_law_and_friction_that_grows_with_load(tmp_path):
    (tmp_path / "joint.xml").write_text(XML)
    rng, logs = np.random.default_rng(1), []
    time = SAMPLE * np.arange(3000)
    for i in range(2):
        waves = zip((0.45, 0.32, 0.26, 0.22), (0.13, 0.31, 0.57, 0.93), strict=True)
        target = sum(a * np.sin(2.0 * np.pi * (f * time + rng.random())) for a, f in waves)
        position, torque = led(target)
        position = position + rng.normal(0.0, 1e-6, len(time))
        torque = torque + rng.normal(0.0, 0.01, len(time))
        path = tmp_path / f"log{i}.csv"
        rows = np.column_stack([time, position, torque])
        np.savetxt(path, rows, "%.8g", ",", header="time_s,position_rad,torque_nm", comments="")
        logs.append(read_log(path, "joint"))
    found = trace(prepare(logs, RigidBody(tmp_path / "joint.xml", "joint")))
    assert [f.term.name for f in found.findings] == ["load-dependent"]
    cov = stated_covariance(found.prepared, found.final)
    growth = term_estimates(found.final, cov, 0, slide=False)["c"]
    assert growth.value == pytest.approx(GROWTH, rel=0.01)
    assert abs(growth.value - GROWTH) <= 2.0 * growth.stderr
    law = law_parameters(found.final)
    assert law.Fc_pos == pytest.approx(LEVEL, rel=0.005)
    assert law.sigma2_pos == pytest.approx(VISCOSITY, rel=0.02)
    # the loop after a slow reversal: laws divide it between stiffness, breakaway and exponent
    back = np.linspace(0.0, 0.02, 400)
    path = np.concatenate([np.linspace(0.0, 0.1, 2000), 0.1 - back])
    torque = friction_torque(law, 0.05 * np.arange(len(path)), path)[-len(back) :]
    true = LEVEL * (2.0 * np.exp(-STIFFNESS * back) - 1.0)
    assert np.sqrt(np.mean((torque - true) ** 2)) < 0.2 * LEVEL
