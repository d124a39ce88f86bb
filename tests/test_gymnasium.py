"""Gymnasium: friction starts afresh at every reset, alone and in vectors of environments."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.simulate.carrier import read_friction
from frictionjoint.simulate.stick_slip import kuka_model

gymnasium = pytest.importorskip("gymnasium")
from gym_joint import JointTracking  # noqa: E402

from frictionjoint.simulate.gymnasium import Friction  # noqa: E402

STEPS = 60


def action(k: int) -> np.ndarray:
    """Commands that break the joint away in both directions: 51 N m need 51 mrad."""
    return np.array([0.09 * np.sin(0.25 * k) + 0.02 * np.sin(1.7 * k)])


def episode(environment) -> np.ndarray:
    environment.reset(seed=1)
    return np.array([environment.step(action(k))[0][0] for k in range(STEPS)])


@pytest.fixture(scope="module")
def plain() -> np.ndarray:
    """The same commands through plain mj_step."""
    model = fj.load_model(kuka_model())
    data = mujoco.MjData(model)
    positions = []
    with fj.attach(model):
        for k in range(STEPS):
            data.ctrl[:] = action(k)
            mujoco.mj_step(model, data, nstep=10)
            positions.append(data.qpos[0])
    return np.array(positions)


def test_an_episode_equals_plain_steps_also_after_resets(plain):
    environment = Friction(JointTracking())
    for _ in range(3):
        np.testing.assert_array_equal(episode(environment), plain)
    environment.close()
    assert mujoco.get_mjcb_passive() is None
    assert np.abs(episode(JointTracking()) - plain).max() > 1e-2


@pytest.mark.parametrize("kind", ["SyncVectorEnv", "AsyncVectorEnv"])
def test_vectors_equal_plain_steps(kind, plain):
    def make():
        return Friction(JointTracking())

    environments = getattr(gymnasium.vector, kind)([make] * 2)
    for _ in range(2):
        environments.reset(seed=1)
        positions = [
            environments.step(np.tile(action(k), (2, 1)))[0][:, 0].copy() for k in range(STEPS)
        ]
        np.testing.assert_array_equal(np.array(positions), np.stack([plain, plain], axis=1))
    environments.close()


def test_friction_is_drawn_anew_at_every_reset_and_follows_the_seed():
    model = kuka_model()
    joint, carried = next(iter(read_friction(fj.load_model(model)).items()))
    exponents = (1.0, 2.0, 3.0)
    base = carried.parameters.to_dict()
    samples = {joint: [type(carried.parameters).from_dict(base | {"n": n}) for n in exponents]}

    def draws(seed: int) -> list[int]:
        environment = Friction(JointTracking(), samples=samples)
        found = []
        for k in range(8):
            _, info = environment.reset(seed=seed if k == 0 else None)
            found.append(info["friction_samples"][joint])
            there = read_friction(environment.unwrapped.model)[joint].parameters
            assert there == samples[joint][found[-1]]
        environment.close()
        return found

    first = draws(5)
    assert first == draws(5)
    assert len(set(first)) > 1


def test_an_ant_with_friction_needs_its_file_alone(tmp_path):
    import gymnasium.envs.mujoco as of_gymnasium

    ant = Path(of_gymnasium.__file__).parent / "assets" / "ant.xml"
    spec = mujoco.MjSpec.from_file(str(ant))
    law = fj.FrictionParameters.symmetric(Fs=2.0, Fc=1.5, Vs=0.1, knots=((1e-2, 4.0),))
    legs = [joint.name for joint in spec.joints if joint.type == mujoco.mjtJoint.mjJNT_HINGE]
    fj.install(spec, dict.fromkeys(legs, law), clear_native=True)
    (tmp_path / "ant_with_friction.xml").write_text(spec.to_xml())

    def after_a_fall() -> np.ndarray:
        environment = gymnasium.make("Ant-v5", xml_file=str(tmp_path / "ant_with_friction.xml"))
        environment.reset(seed=0)
        for _ in range(20):
            environment.step(np.zeros(8))
        model, data = environment.unwrapped.model, environment.unwrapped.data
        if mujoco.get_mjcb_passive() is not None:
            felt = fj.torque(model, data)
            assert list(felt) == legs
            assert all(x.time > 0.0 and x.hysteresis != 0.0 for x in felt.values())
        environment.close()
        return np.array(data.qpos[7:])

    without = after_a_fall()
    fj.enable()
    with_friction = after_a_fall()
    fj.disable()
    assert np.abs(with_friction - without).max() > 0.05
