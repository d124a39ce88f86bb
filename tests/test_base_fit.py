"""The law alone: found from where a linear fit shows it, also where a bristle is another law.

The friction is LuGre's (Canudas de Wit et al. 1995), integrated here along a given motion.
"""

import numpy as np
import pytest

from frictionjoint.identify.base_fit import base_fit, with_last_freedoms
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.log import JointLog

INERTIA, STEP, EVERY, SECONDS = 0.05, 1e-4, 20, 12.0
JOINT = f"""<mujoco><worldbody><body><joint name="j" axis="0 0 1"/>
<inertial mass="1" pos="0 0 0" diaginertia="{INERTIA} {INERTIA} {INERTIA}"/>
</body></worldbody></mujoco>"""


def motion(rng):
    """Time, position, velocity and acceleration along three waves."""
    t = np.arange(0.0, SECONDS, STEP)
    rates = np.array([0.11, 0.37, 0.9]) * rng.uniform(0.9, 1.1, 3)
    angle = 2.0 * np.pi * rates[:, None] * t + rng.uniform(0.0, 6.28, (3, 1))
    size = np.array([[0.5], [0.15], [0.05]])
    q = np.sum(size * np.sin(angle), axis=0)
    v = np.gradient(q, t)
    return t, q, v, np.gradient(v, t)


def log(Fs, Fc, Vs, stiffness, damping, viscous, noise, seed):
    """A bristle's log of 500 Hz; Vs is that of positive and of negative motion."""
    rng = np.random.default_rng(seed)
    t, q, v, a = motion(rng)
    level = Fc + (Fs - Fc) * np.exp(-((v / np.where(v > 0.0, *Vs)) ** 2))
    rubs = stiffness * np.abs(v) / level
    z, friction = 0.0, np.empty_like(t)
    for k in range(len(t)):
        before, z = z, (z + STEP * v[k]) / (1.0 + STEP * rubs[k])
        friction[k] = stiffness * z + damping * (z - before) / STEP
    some = slice(None, None, EVERY)
    torque = (INERTIA * a + friction + viscous * v)[some]
    torque += noise * rng.standard_normal(len(torque))
    return JointLog(name=f"{seed}", joint="j", time=t[some], position=q[some], torque=torque)


def fitted(*logs):
    prepared, found = base_fit(prepare(list(logs), RigidBody(JOINT, "j")), "integrated")
    _, found = with_last_freedoms(prepared, found)
    return found, law_parameters(found)


def test_a_bristle_is_found_with_its_own_numbers():
    """It is the form of 2002 with n = 1 and a straight curve, whatever other forms come near."""
    own = {"stiffness": 800.0, "damping": 0.3, "viscous": 0.1, "noise": 3e-3}
    found, law = fitted(*(log(0.8, 0.5, (0.05, 0.05), seed=i, **own) for i in (1, 2)))
    assert (law.variant, law.n) == ("lampaert2002", 1.0)
    assert law.Fs_pos == pytest.approx(0.8, rel=0.05)
    assert law.Fc_pos == pytest.approx(0.5, rel=0.02)
    assert law.Vs_pos == law.Vs_neg == pytest.approx(0.05, rel=0.1)
    assert law.sigma2_pos == pytest.approx(0.1, rel=0.05)
    assert law.stiffness == pytest.approx(800.0, rel=0.1)
    assert found.rms_in_motion < 1.2 * 3e-3


def test_logs_that_hardly_exceed_the_stribeck_velocity_show_it():
    own = {"stiffness": 800.0, "damping": 0.3, "viscous": 0.5, "noise": 3e-3}
    _, law = fitted(*(log(0.9, 0.5, (0.5, 0.5), seed=i, **own) for i in (1, 2)))
    assert law.Vs_pos == pytest.approx(0.5, rel=0.1)
    assert law.Fs_pos == pytest.approx(0.9, rel=0.03)
    assert law.sigma2_pos == pytest.approx(0.5, rel=0.1)


def test_a_contact_that_is_damped_much_hides_no_friction():
    """Breakaway is ten times what the joint slides with, and hardly shows for the damping."""
    own = {"stiffness": 500.0, "damping": 8.0, "viscous": 0.02, "noise": 1e-4}
    found, law = fitted(*(log(0.5, 0.05, (0.02, 0.02), seed=i, **own) for i in (1, 2)))
    assert law.Fc_pos == pytest.approx(0.05, rel=0.03)
    assert law.sigma2_pos == pytest.approx(0.02, rel=0.03)
    assert law.Fs_pos > 3.0 * law.Fc_pos
    assert law.sigma1 == pytest.approx(8.0, rel=0.3)
    assert found.rms_in_motion < 0.04 * 0.05


def test_a_stribeck_velocity_may_differ_by_direction():
    own = {"stiffness": 3000.0, "damping": 0.3, "viscous": 0.1, "noise": 2e-3}
    found, law = fitted(*(log(0.8, 0.5, (0.12, 0.03), seed=i, **own) for i in (1, 2)))
    assert law.Vs_pos == pytest.approx(0.12, rel=0.15)
    assert law.Vs_neg == pytest.approx(0.03, rel=0.15)
    assert found.rms_in_motion < 1.3 * 2e-3
