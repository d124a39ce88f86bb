"""The trial plants of `second_servos` are physical, repeatable and hide what they say."""

import math

import mujoco
import numpy as np
import pytest
from second_servos import KINDS, Plant, draw
from second_servos.joint import Joint
from second_servos.load import energy
from second_servos.simulate import motion


@pytest.fixture(scope="module")
def servo() -> Plant:
    return draw("delay", np.random.default_rng(3))


def unpowered(joint: Joint, law: int) -> Joint:
    return joint._replace(
        firmware=joint.firmware._replace(kd=0.0), friction=joint.friction._replace(law=law)
    )


@pytest.mark.parametrize("law", range(4))
def test_energy_never_grows_unpowered(servo, law):
    joint = unpowered(servo.joint, law)
    path = motion(joint, 0.0, np.zeros(4000), 5e-4, (1.0, 8.0), settling=0.0)[1]
    total = energy(joint.load, path[:, 0], path[:, 1])
    stored = joint.friction.static * joint.friction.presliding  # a presliding spring gives back
    assert np.all(total <= np.minimum.accumulate(total) + stored)
    assert total[-1] < total[0] - 100 * stored


@pytest.mark.parametrize("law", range(4))
def test_static_friction_holds_a_load_without_creep(servo, law):
    joint = unpowered(servo.joint, law)
    held = 0.5 * joint.friction.coulomb / joint.load.moment
    start = math.asin(held) - joint.load.hanging
    path = motion(joint, 0.0, np.zeros(1000), 0.01, (start, 0.0), settling=0.0)[1]
    assert 0 < abs(path[100, 0] - start) < 10 * joint.friction.presliding
    assert np.ptp(path[200:, 0]) < 1e-9


@pytest.mark.parametrize("kind", [k for k in KINDS if k != "nothing"])
def test_the_hidden_effect_moves_the_position(kind):
    plant = draw(kind, np.random.default_rng(11))
    assert KINDS[kind][1] in plant.hidden
    firmware, drive = plant.joint.firmware, plant.joint.drive
    joint = plant.joint._replace(
        firmware=firmware._replace(
            delay=0.0,
            deadband=0.0,
            threshold=math.inf,
            rate=math.inf,
            limit=float(plant.controller["limit"]),
        ),
        drive=drive._replace(factor=1.0),
    )
    for held_out in (False, True):
        moved = []
        for log in plant.recordings:
            if (log.name in plant.held_out) == held_out:
                q = motion(joint, plant.kp(log.metadata), log.target, log.time[1])[1][:, 0]
                moved.append(np.mean((q - log.position) ** 2))
        assert math.sqrt(np.mean(moved)) > 4 * firmware.count


def test_position_reproduces_the_recordings_within_a_count(servo):
    for log in servo.recordings:
        q = servo.position(log, (log.position[0], 0.0))
        assert np.abs(q - log.position).max() < 1.1 * servo.joint.firmware.count


@pytest.mark.parametrize("kind", ["delay", "factor"])
def test_mjcf_has_the_load_of_the_joint(kind):
    rng = np.random.default_rng(5)
    plant = next(p for p in (draw(kind, rng) for _ in range(9)) if p.own != "gravity-error")
    model = mujoco.MjModel.from_xml_string(plant.mjcf)
    data = mujoco.MjData(model)
    load = plant.joint.load
    for q in (-1.0, 0.4, 2.0):
        data.joint("j").qpos[0] = q
        mujoco.mj_forward(model, data)
        gravity = load.moment * math.sin(q + load.hanging)
        assert data.qfrc_bias[0] == pytest.approx(gravity, rel=1e-6)
        assert 1 / data.qacc[0] * -gravity == pytest.approx(load.inertia, rel=1e-6)
