"""A delay between the channels: the whole model is late, edges of friction and all."""

from dataclasses import replace

import numpy as np
import pytest
from plants.draw import draw_trial
from trial_logs import prepared_logs

from frictionjoint.control.controller import Controller
from frictionjoint.diagnose.drive import look_at_drive
from frictionjoint.effects.measurement_delay import EFFECT
from frictionjoint.identify.base_fit import base_fit
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.measured.log import JointLog

DELAY = 8e-3


@pytest.fixture(scope="module")
def late(tmp_path_factory):
    """A LuGre joint whose position is logged 8 ms late."""
    folder = tmp_path_factory.mktemp("late")
    spec = draw_trial(np.random.default_rng(31), "one:measurement-delay")
    effect = replace(spec.effects[0], parameters={"delay": DELAY})
    spec = replace(spec, friction=replace(spec.friction, law="lugre"), effects=(effect,))
    return prepared_logs(spec, folder, 2), spec


def test_a_delay_and_the_law_are_found_together(late):
    prepared, spec = late
    found = fit(prepared, (EffectTerm(EFFECT, (0.0,)),), forms=forms_of("lugre"))
    assert found.terms[0].shape[0] == pytest.approx(DELAY, abs=1.0 / spec.instrument.rate)
    assert found.coefficient("Fc") == pytest.approx(spec.friction.Fc, rel=0.03)
    assert found.coefficient("sigma2") == pytest.approx(spec.friction.sigma2, rel=0.1)
    without = fit(prepared, forms=forms_of("lugre"))
    assert found.rms < 0.5 * without.rms


LATE = """<mujoco><worldbody><body><joint name="j" axis="0 0 1"/>
<inertial mass="1" pos="0 0 0" diaginertia="0.03 0.03 0.03"/></body></worldbody></mujoco>"""


def late_servo(name, rate):
    """A chirp that a PD controller follows at 1 kHz with a torque that acts 2 ms late."""
    step, seconds = 1e-4, 10.0
    t = np.arange(0.0, seconds, step)
    target = 0.3 * np.sin(2.0 * np.pi * (0.2 + rate * t / seconds) * t)
    q = v = 0.0
    asked = [0.0] * 20
    position = np.empty_like(t)
    for k in range(len(t)):
        position[k] = q
        if k % 10 == 0:
            torque = 100.0 * (target[k] - q) - 1.0 * v
        asked.append(torque)
        friction = (0.4 + 0.2 * np.exp(-((v / 0.03) ** 2))) * np.tanh(v / 1e-3) + 0.02 * v
        v += step * (asked[k] - friction) / 0.03
        q += step * v
    some = slice(None, None, 20)
    return JointLog(
        name=name, joint="j", time=t[some], position=position[some], target=target[some]
    )


def test_a_late_torque_is_found_where_the_law_alone_imitates_it():
    """A delay turns inertia into negative viscosity: fitted alone, the law takes it for a fall of
    friction with speed, and beside that law no delay explains anything."""
    controller = Controller(output="torque_nm", kp=100.0, kd=1.0)
    logs = [late_servo("a", 1.5), late_servo("b", 3.0)]
    prepared, alone = base_fit(
        prepare(logs, RigidBody(LATE, "j"), controller=controller), "integrated"
    )
    found = look_at_drive(prepared, alone, np.random.default_rng(0))
    term, score = found.tried[0]
    assert term.name == "measurement-delay"
    # a torque that is held between ticks is late by half of one more
    assert term.shape[0] == pytest.approx(0.0025, abs=0.0006)
    assert score.gain(found.now) > 0.9
