"""Columns of the rigid body against MuJoCo's inverse dynamics, on trees drawn at random."""

import mujoco
import numpy as np
import pytest

from frictionjoint.robot.inertia import of_model, of_pseudo, pseudo, write
from frictionjoint.robot.kinematics import Trajectory, Tree
from frictionjoint.robot.regressor import Regressor

KINDS = ("hinge", "slide", "ball")


def random_tree(rng: np.random.Generator, bodies: int, base: str) -> mujoco.MjModel:
    """A tree with branches, several joints in a body, offsets everywhere and welded bodies."""
    spec = mujoco.MjSpec()
    spec.option.gravity = rng.normal(size=3) * 5.0
    made: list[mujoco.MjsBody] = []
    for i in range(bodies):
        parent = spec.worldbody if not made else made[int(rng.integers(max(0, i - 3), i))]
        body = parent.add_body(name=f"b{i}", pos=rng.normal(size=3), quat=rng.normal(size=4))
        body.explicitinertial = True
        body.mass, body.ipos = rng.uniform(0.1, 3.0), rng.normal(size=3) * 0.2
        body.inertia, body.iquat = rng.uniform(0.5, 0.9, 3), rng.normal(size=4)
        body.gravcomp = float(rng.choice([0.0, 0.0, 0.7]))
        made.append(body)
        if i == 0 and base == "free":
            body.add_freejoint()
            continue
        kinds = ["ball"] if rng.random() < 0.15 else list(rng.choice(KINDS[:2], rng.integers(0, 3)))
        for kind in kinds:
            body.add_joint(
                type=getattr(mujoco.mjtJoint, f"mjJNT_{kind.upper()}"),
                axis=rng.normal(size=3),
                pos=rng.normal(size=3),
                ref=0.3 * rng.normal() if kind != "ball" else 0.0,
                armature=rng.uniform(0.0, 1.0),
            )
    return spec.compile()


def random_motion(rng: np.random.Generator, model: mujoco.MjModel, n: int) -> Trajectory:
    q = rng.normal(size=(n, model.nq))
    return Trajectory(q, *(rng.normal(size=(n, model.nv)) * 3.0 for _ in range(2)))


def by_mujoco(model: mujoco.MjModel, motion: Trajectory) -> np.ndarray:
    data, found = mujoco.MjData(model), []
    for q, v, a in zip(motion.q, motion.v, motion.a, strict=True):
        data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
        mujoco.mj_inverse(model, data)
        found.append(data.qfrc_inverse.copy())
    return np.array(found)


@pytest.mark.parametrize("base", ["fixed", "free"])
@pytest.mark.parametrize("seed", range(6))
def test_columns_times_parameters_are_mujocos_inverse_dynamics(seed, base):
    rng = np.random.default_rng(seed)
    model = random_tree(rng, 9, base)
    motion = random_motion(rng, model, 20)
    expected = by_mujoco(model, motion)
    columns = Regressor(Tree(model), motion)
    of_body = of_model(model)
    phi = of_body.ravel()
    scale = np.abs(expected).max()
    assert model.nv > 3
    for dof in range(model.nv):
        every = np.hstack([columns.body(b, dof) for b in range(model.nbody)])
        found = every @ phi + model.dof_armature[dof] * motion.a[:, dof]
        assert np.abs(found - expected[:, dof]).max() < 1e-9 * max(1.0, scale)
        whole = sum(columns.torque_of(b, dof, of_body[b]) for b in columns.tree.beyond[dof])
        assert np.abs(whole - every @ phi).max() < 1e-9 * scale


def test_gravity_columns_are_what_a_turned_gravity_does():
    rng = np.random.default_rng(5)
    model = random_tree(rng, 6, "fixed")
    motion = random_motion(rng, model, 10)
    before, change = by_mujoco(model, motion), rng.normal(size=3)
    model.opt.gravity[:] += change
    after = by_mujoco(model, motion)
    for dof in range(model.nv):
        found = Regressor(Tree(model), motion).gravity_columns(dof, of_model(model)) @ change
        assert np.abs(found - (after - before)[:, dof]).max() < 1e-9 * np.abs(before).max()


def test_parameters_go_into_a_spec_and_come_back():
    rng = np.random.default_rng(7)
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body(name="b")
    body.add_joint(axis=[0, 0, 1])
    body.add_geom(size=[0.1, 0.1, 0.1], mass=3.0)
    A = rng.normal(size=(4, 6))
    phi = of_pseudo(A @ A.T)
    assert np.allclose(of_pseudo(pseudo(phi)), phi)
    write(body, phi)
    assert np.allclose(of_model(spec.compile())[1], phi, atol=1e-9)
    # through XML, where MuJoCo keeps the digits of a number it can
    again = mujoco.MjModel.from_xml_string(spec.to_xml())
    assert np.allclose(of_model(again)[1], phi, rtol=1e-4)
