"""The band of the torque that a gear transmits, along which friction grows with load."""

import numpy as np
import pytest

from frictionjoint.effects.signals import GEAR, TIME
from frictionjoint.identify.noise import Band
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.lowpass import LowPass, gentle

INERTIA = 0.3
XML = f"""
<mujoco><option gravity="0 0 0"/><worldbody><body><joint name="arm" axis="0 -1 0"/>
<inertial pos="0 0 0" mass="1" diaginertia="0.2 {INERTIA} 0.2"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize("noise", [1e-5, 1e-4, 1e-3])
def test_the_torque_of_the_gear_has_the_band_in_which_it_exceeds_its_noise(noise):
    """Stops within 10 ms: the narrow band blurs them, the wide one lets the noise through."""
    t = 2e-3 * np.arange(10000)
    stops = np.exp(-0.5 * ((t % 1.0 - 0.5) / 0.01) ** 2) * np.where(t % 2.0 < 1.0, -60.0, 60.0)
    q = 2e-3 * np.cumsum(2e-3 * np.cumsum(stops))
    measured = q + np.random.default_rng(3).normal(0.0, noise, len(t))
    log = JointLog(name="stops", joint="arm", time=t, position=measured, torque=INERTIA * stops)
    band = Band(balance=10.0, motion=80.0)
    (segment,) = prepare([log], RigidBody(XML, "arm"), band).segments
    torque, inner = segment.signals[:, GEAR], slice(500, -500)
    true = np.interp(segment.signals[:, TIME], t, INERTIA * stops)

    def error(x):
        return np.std((x - true)[inner])

    bands = [LowPass(len(torque), segment.dt, hz, gentle, 1)(torque) for hz in (10.0, 20.0, 80.0)]
    assert error(segment.gear) < 1.1 * min(map(error, bands))
