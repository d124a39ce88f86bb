"""A motor whose torque per volt falls as its torque grows: found in logs, followed in MuJoCo."""

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_motor import GRAVITY, INERTIA, LENGTH, MASS, XML

from frictionjoint import FrictionParameters, attach
from frictionjoint.diagnose.trace import trace
from frictionjoint.effects.motor import SATURATION
from frictionjoint.effects.motor import given as given_torque
from frictionjoint.errors import ModelError
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.start import predict
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.measured.log import JointLog
from frictionjoint.replay.free_runs import motor_of, replay
from frictionjoint.simulate.carrier import install
from frictionjoint.simulate.motor import Motor, add_motor

GAIN, EMF, S = 0.13, 0.05, 2.5
COULOMB, VISCOUS = 0.03, 0.01
LAW = FrictionParameters.symmetric(
    Fs=0.03, Fc=0.03, Vs=0.1, sigma2=0.01, n=2, knots=((1e-4, 0.06),)
)


def given_by_bisection(asked):
    """Torque of a motor from which T + S T^3 is asked for."""
    low, high = 0.0, abs(asked)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if middle + S * middle**3 < abs(asked) else (low, middle)
    return np.copysign(low, asked)


def between(volts, steps):
    """Voltages that go straight from sample to sample, `steps` a sample."""
    at = np.arange(len(volts) * steps) / steps
    return np.interp(at, np.arange(len(volts)), volts).reshape(len(volts), steps)


def swing(volts, closed=None, dt=2e-3, steps=10):
    """Position, rad, of a pendulum on flat friction, by its equation of motion, shape (n,).

    Where its circuit is not closed the motor gives nothing.
    """
    q, v, path = 0.0, 0.0, []
    for k, fine in enumerate(between(volts, steps)):
        path.append(q)
        for u in fine:
            on = closed is None or closed[k]
            torque = given_by_bisection(GAIN * u - EMF * v) if on else 0.0
            pull = torque - MASS * GRAVITY * LENGTH * np.sin(q) - VISCOUS * v
            stop = INERTIA * v * steps / dt + pull
            v += dt / steps * (pull - np.copysign(min(COULOMB, abs(stop)), stop)) / INERTIA
            q += dt / steps * v
    return np.array(path)


def voltages(n, seed):
    """Slow and fast swings that ask for up to three times what the motor gives in proportion."""
    rng = np.random.default_rng(seed)
    t = 2e-3 * np.arange(n)
    waves = [
        a * np.sin(2.0 * np.pi * f * t + rng.uniform(0.0, 6.28))
        for a, f in ((3.5, 0.43), (2.5, 1.1), (2.0, 1.9))
    ]
    return np.clip(sum(waves), -7.0, 7.0)


def saturating(effects=(), gain=GAIN, emf=EMF, **actuator):
    spec = mujoco.MjSpec.from_string(XML)
    add_motor(spec, "arm", Motor(gain, emf))
    for name, value in actuator.items():
        setattr(spec.actuators[0], name, value)
    install(spec, {"arm": LAW}, {"arm": list(effects)})
    return spec.compile()


EFFECT = SimulatedEffect(SATURATION, (), (S,))


@given(st.floats(-1e3, 1e3), st.floats(0.0, 1e6))
def test_what_is_given_is_what_was_asked_for_less_what_saturates(asked, s):
    T = given_torque(asked, s)
    assert T + s * T**3 == pytest.approx(asked, rel=1e-12, abs=1e-300)
    assert abs(T) <= abs(asked) * (1.0 + 1e-15)


@pytest.mark.parametrize("backend", ["native", "python"])
def test_mujoco_moves_as_the_equation_of_motion(backend):
    volts = voltages(1500 if backend == "native" else 300, 1)
    model = saturating([EFFECT])
    data = mujoco.MjData(model)
    found = []
    with attach(model, backend=backend):
        for fine in between(volts, 4):
            found.append(data.qpos[0])
            for u in fine:
                data.ctrl[0] = u
                mujoco.mj_step(model, data)
    expected = swing(volts)
    np.testing.assert_allclose(found, expected, atol=0.02 * np.ptp(expected))


def test_a_motor_that_cannot_be_followed_is_refused():
    spec = mujoco.MjSpec.from_string(XML)
    install(spec, {"arm": LAW}, {"arm": [EFFECT]})
    with pytest.raises(ModelError, match=r"'arm' has a motor that .* but no actuator"):
        attach(spec.compile()).__enter__()
    limited = saturating([EFFECT], forcerange=[-1.0, 1.0], forcelimited=True)
    with pytest.raises(ModelError, match="'arm_voltage' must have a fixed gain"):
        attach(limited).__enter__()


# identification


def log(seed, n=4000, counts=20000):
    """A log with noise on its voltage; let go now and then, which tells back-EMF from friction."""
    time, step = 2e-3 * np.arange(n), 2.0 * np.pi / counts
    volts, closed = voltages(n, seed), time % 4.0 < 3.0
    return JointLog(
        name=f"log{seed}",
        joint="arm",
        time=time,
        position=step * np.round(swing(volts, closed) / step),
        voltage=volts + np.random.default_rng(seed).normal(0.0, 0.1, n),
        torque_enabled=closed,
    )


@pytest.fixture(scope="module")
def traced():
    body = RigidBody(XML, "arm")
    prepared = prepare([log(1), log(2)], body)
    return body, trace(prepared, 0)


def test_the_loop_names_it_with_its_size(traced):
    """What comes after it is at the edges of this plant's flat friction, finer than its log."""
    _, found = traced
    assert [step.term.name for step in found.findings][:2] == ["back-emf", "motor-saturation"]
    motor = motor_of(found.final)
    assert motor.gain == pytest.approx(GAIN, rel=0.02)
    assert motor.back_emf == pytest.approx(EMF, rel=0.03)
    assert motor.saturation == pytest.approx(S, rel=0.05)


def test_a_log_that_was_not_fitted_is_predicted_and_replayed(traced):
    body, found = traced
    kept = prepare([log(3, 2500)], body, found.prepared.band)

    def left(fit):
        return np.std(predict(kept, fit).error) / fit.gain

    assert left(found.final) < 0.4 * left(found.base)
    after, before = (replay(kept, body, fit).rms for fit in (found.final, found.base))
    assert after < 0.5 * before


@pytest.mark.skipif(not hasattr(mujoco.MjModel, "nactuator"), reason="every actuator has a control")
@pytest.mark.parametrize("backend", ["native", "python"])
def test_an_actuator_without_a_control_leaves_the_others_theirs(backend):
    """A `dcmotor` with input "none", as MuJoCo's own LuGre friction, comes before the motor."""
    paths = []
    for passive in (False, True):
        spec = mujoco.MjSpec.from_string(XML)
        if passive:
            wheel = '<body pos="1 0 0"><joint name="wheel"/><geom size=".1"/></body>'
            friction = '<dcmotor joint="wheel" input="none" motorconst="1e-6" resistance="1"/>'
            spec = mujoco.MjSpec.from_string(
                XML.replace("</worldbody>", f"{wheel}</worldbody><actuator>{friction}</actuator>")
            )
        add_motor(spec, "arm", Motor(GAIN, EMF))
        spec.actuators[-1].ctrlrange = (-5.0, 5.0)
        install(spec, {"arm": LAW}, {"arm": [EFFECT]})
        model = spec.compile()
        data = mujoco.MjData(model)
        path = []
        with attach(model, backend=backend):
            for u in np.repeat(voltages(100, 1), 4):
                data.ctrl[0] = u
                mujoco.mj_step(model, data)
                path.append(data.qpos[0])
        paths.append(np.array(path))
    np.testing.assert_allclose(*paths, rtol=0.0, atol=1e-9)
    assert np.ptp(paths[0]) > 0.1
