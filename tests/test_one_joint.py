"""The simulation of one joint against MuJoCo stepping the same model."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from frictionjoint.control import kernel as k
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.parameters import FrictionParameters
from frictionjoint.replay.closed_loop import load_of
from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.carrier import install
from frictionjoint.simulate.motor import Motor, add_motor
from frictionjoint.simulate.one_joint import JointModel, Run, simulate
from frictionjoint.simulate.thermal import set_temperature, temperature

MODEL = Path(__file__).resolve().parents[1] / "models/xl330_pendulum.xml"
JOINT = "pendulum"
LAW = FrictionParameters.symmetric(
    Fs=0.05, Fc=0.04, Vs=0.2, delta=1.0, sigma2=0.01, knots=((0.002, 0.05), (0.008, 0.1))
)
STEP, N = 1e-3, 3000


def effect(name, shape, coefficients):
    found = next(e for e in CATALOGUE if e.name == name)
    return SimulatedEffect(found, shape, coefficients)


def block(**figures):
    B = np.zeros(k.BLOCK)
    B[[k.SUPPLY, k.LIMIT, k.DROP_ERROR, k.DROP_OUTPUT, k.SLEW]] = 1.0, *[np.inf] * 4
    for name, x in figures.items():
        B[getattr(k, name)] = x
    return B


def run_of(target, start, B):
    return Run(
        step=STEP,
        target=target,
        supply=np.ones(N),
        on=np.ones(N, dtype=bool),
        start=start,
        load=load_of(RigidBody(MODEL, JOINT), np.zeros(1), {}),
        block=B,
    )


def in_mujoco(effects, motor, B, target, start, celsius=None):
    spec = mujoco.MjSpec.from_file(str(MODEL))
    add_motor(spec, JOINT, motor)
    install(spec, {JOINT: LAW}, {JOINT: effects})
    model = spec.compile()
    model.opt.timestep = STEP
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[0] = start
    S, found = np.zeros(k.STATE), np.empty(N)
    with attach(model):
        if celsius is not None:
            mujoco.mj_forward(model, data)
            set_temperature(model, data, JOINT, celsius)
            assert temperature(model, data) == {JOINT: pytest.approx(celsius)}
        for i in range(N):
            found[i] = data.qpos[0]
            data.ctrl[0] = k.tick(B, S, i * STEP, target[i], *data.qpos, *data.qvel, 1.0)
            mujoco.mj_step(model, data)
    return found


@pytest.mark.parametrize(
    "effects",
    [
        [],
        [effect("spring", (), (0.05, 0.01))],
        [effect("load-dependent", (0.002,), (0.2,))],
        [effect("gravity-error", (), (0.01, 0.02)), effect("motor-saturation", (), (0.5,))],
    ],
    ids=["law", "spring", "load", "gravity and saturation"],
)
def test_it_steps_as_mujoco_does(effects):
    motor = Motor(0.1, 0.05)
    B = block(KP=12.0, KD=0.1, SUPPLY=1.0, LIMIT=7.0)
    target = 0.8 * np.sin(6.0 * STEP * np.arange(N) ** 1.0)
    start = (0.3, -0.5)
    expected = in_mujoco(effects, motor, B, target, start)
    model = JointModel(LAW, effects, motor.gain, motor.back_emf)
    # the load is looked up by its harmonics, so the last digits differ
    np.testing.assert_allclose(simulate(model, run_of(target, start, B)), expected, atol=1e-9)
    assert np.ptp(expected) > 0.5


@pytest.mark.parametrize(
    "effects",
    [
        [effect("spring", (), (0.3, 0.02))],
        [effect("gravity-error", (), (0.01, 0.02))],
        [effect("torque-gain", (), (0.2,))],
        [effect("load-dependent", (0.002,), (0.2,))],
    ],
    ids=lambda some: some[0].effect.name,
)
@pytest.mark.parametrize("lag", [0.0, 2.5])
def test_friction_holds_a_joint_beside_its_effects(effects, lag):
    run = run_of(np.full(N, 0.6), (0.4, 0.0), block(KP=1.0))
    strong = FrictionParameters.symmetric(Fs=2.0, Fc=1.8, Vs=0.2, knots=((0.002, 2.0), (0.01, 4.0)))
    for model in (JointModel(strong, [], 1.0), JointModel(strong, effects, 1.0, lag=lag * STEP)):
        assert np.abs(simulate(model, run) - 0.4).max() < 1e-6
