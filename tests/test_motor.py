"""Logs of a motor by its voltage or current, in closed loop and let go."""

from dataclasses import replace

import numpy as np
import pytest

from frictionjoint.diagnose.candidate import signals_of
from frictionjoint.diagnose.library import effect_terms
from frictionjoint.effects.friction_level import LOAD_DEPENDENT
from frictionjoint.effects.motor import BACK_EMF
from frictionjoint.errors import LogError
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.identify.weights import reweighed
from frictionjoint.measured.log import JointLog
from frictionjoint.replay.free_runs import friction_spec
from frictionjoint.simulate.motor import Motor

MASS, LENGTH, ARMATURE, GRAVITY = 0.5, 0.1, 0.002, 9.81
INERTIA = MASS * LENGTH**2 + ARMATURE + 1e-6
MOTOR = Motor(gain=0.1, back_emf=0.04)
XML = f"""
<mujoco><option timestep="0.0005" integrator="implicitfast" gravity="0 0 -{GRAVITY}"/>
<worldbody><body><joint name="arm" axis="0 -1 0" armature="{ARMATURE}"/>
<inertial pos="0 0 -{LENGTH}" mass="{MASS}" diaginertia="1e-6 1e-6 1e-6"/></body></worldbody>
</mujoco>"""
VISCOUS = 0.02  # of the plant


def plant(target, enabled, load=0.0, emf=MOTOR.back_emf):
    """A log of a plant integrated by hand: friction grows with the torque behind the rotor."""
    q, v, h = 0.0, 0.0, 1e-4
    rows = []
    aims = np.interp(np.arange(len(target) * 50) / 50, np.arange(len(target)), target)
    for k, aim in enumerate(aims):
        volts = min(7.0, max(-7.0, 14.0 * (aim - q))) if enabled[k // 50] else 0.0
        if k % 50 == 0:
            rows.append((q, volts))
        torque = MOTOR.gain * volts - emf * v if enabled[k // 50] else 0.0
        pull = torque - MASS * GRAVITY * LENGTH * np.sin(q) - VISCOUS * v
        # the torque the gear transmits follows from the acceleration, which it changes
        a = 0.0
        for _ in range(4):
            link = MASS * LENGTH**2 * a + MASS * GRAVITY * LENGTH * np.sin(q)
            most = 0.02 + load * abs(link)
            stop = INERTIA * v / h + pull
            a = (pull - np.copysign(min(most, abs(stop)), stop)) / INERTIA
        v += h * a
        q += h * v
    q, volts = np.array(rows).T
    return JointLog(
        name="plant",
        joint="arm",
        time=5e-3 * np.arange(len(q)),
        position=q,
        voltage=volts,
        target=target,
        torque_enabled=enabled,
    )


@pytest.fixture(scope="module")
def driven_and_let_go():
    t = 5e-3 * np.arange(1600)
    target = 1.2 * np.sin(1.5 * t) + 0.4 * np.sin(7.0 * t)
    enabled = (t % 4.0) < 2.5
    return plant(target, enabled, load=0.2)


def fitted(one, *effects):
    # plain Coulomb friction follows its load at once
    terms = tuple(EffectTerm(e, (1e-5,) * len(e.shape)) for e in effects)
    prepared = prepare([one], RigidBody(XML, "arm"))
    return reweighed(prepared, fit(prepared, terms, forms=INTEGRATED[:1]))[1]


def test_letting_go_tells_viscous_friction_from_back_emf_and_the_gear_load(driven_and_let_go):
    """The rotor's own torque is no load: in free swing that is most of the rigid body's."""
    found = fitted(driven_and_let_go, BACK_EMF, LOAD_DEPENDENT)
    assert found.gain == pytest.approx(0.1, rel=0.01)
    assert found.term_coefficients(0)[0] == pytest.approx(0.04, rel=0.02)
    assert found.coefficient("sigma2") == pytest.approx(VISCOUS, rel=0.02)
    assert found.term_coefficients(1)[0] == pytest.approx(0.2, rel=0.02)


def test_a_current_is_a_torque_up_to_a_gain():
    """Nothing brakes a motor driven by its current: what grows with speed is viscous friction."""
    t = 5e-3 * np.arange(1600)
    target = 1.2 * np.sin(1.5 * t) + 0.4 * np.sin(7.0 * t)
    one = plant(target, np.ones(len(t), dtype=bool), emf=0.0)
    one = replace(one, voltage=None, current=one.voltage, torque_enabled=None)
    found = fitted(one)
    assert found.gain == pytest.approx(MOTOR.gain, rel=0.01)
    assert found.coefficient("sigma2") == pytest.approx(VISCOUS, rel=0.05)
    prepared = prepare([one], RigidBody(XML, "arm"))
    names = {t.name for t in effect_terms(prepared, signals_of(prepared, found), ())}
    assert not names & {"back-emf", "torque-gain"}
    spec = RigidBody(XML, "arm").spec()
    friction_spec(spec, "arm", found)
    (actuator,) = spec.actuators
    assert actuator.name == "arm_current"
    assert actuator.gainprm[0] == found.gain
    assert not actuator.biasprm.any()


def test_logs_of_a_voltage_and_of_a_current_do_not_go_together(driven_and_let_go):
    other = replace(driven_and_let_go, name="amps", voltage=None, current=driven_and_let_go.voltage)
    with pytest.raises(LogError, match="plant has a voltage and amps a current: give logs of one"):
        prepare([driven_and_let_go, other], RigidBody(XML, "arm"))
