"""All shared causes that a robot's logs can show."""

import itertools
from collections.abc import Mapping, Sequence
from typing import get_args

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.model_joints import is_slide
from frictionjoint.robot.causes.base_tilt import BaseTilt
from frictionjoint.robot.causes.body_inertia import BodyInertia, Form
from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.causes.gear_coupling import GearCoupling
from frictionjoint.robot.causes.of_joint import JointOffset, RotorInertia
from frictionjoint.robot.causes.payload import Payload
from frictionjoint.robot.causes.together import Links, Rotors
from frictionjoint.robot.corrections import Shaft
from frictionjoint.robot.inertia import of_model, possible
from frictionjoint.robot.kinematics import Tree


def catalogue(
    model: mujoco.MjModel,
    joints: Sequence[str],
    moving: Sequence[str],
    velocity: Mapping[str, Array],
) -> tuple[Cause, ...]:
    """Causes that could act on these joints.

    Args:
        joints: with logged drive. moving: with logged motion.
        velocity: of each of `joints` along the logs, rad/s (m/s), each of shape (n,).
    """
    rotors = [
        RotorInertia(name, is_slide(model, name), float(model.joint(name).armature[0]))
        for name in joints
    ]
    none = [rotor for rotor in rotors if not rotor.armature]
    found: list[Cause] = [*rotors, *([Rotors(tuple(none))] if len(none) > 1 else [])]
    links = rigid_links(model, joints, moving)
    phi = of_model(model)
    # no arm carries more than its own mass; where the logs determine only the payload's moment,
    # a larger mass near the axes would explain it too
    own_mass = float(phi[list(itertools.chain(*links.values())), 0].sum())
    # the first bodies of the outermost links carry one
    hands = [bodies[0] for dofs, bodies in links.items() if not any(dofs < x for x in links)]
    found += [Payload(b, body_label(model, b), own_mass) for b in hands]
    found += [
        BodyInertia(b, body_label(model, b), form, _reach(model, b))
        for b in links_of(model, joints, moving)
        if possible(phi[b])
        for form in get_args(Form)
    ]
    if np.any(model.opt.gravity):
        found.append(BaseTilt())
    found += [JointOffset(name, is_slide(model, name)) for name in moving]
    for one, other in _neighbours(model, joints):
        for ratio in (1.0, -1.0):
            top = float(np.abs(velocity[one] + ratio * velocity[other]).max())
            if top:
                found.append(GearCoupling(Shaft((one, other), ratio, top)))
    return tuple(found)


def all_links(causes: Sequence[Cause]) -> list[Cause]:
    """All parameters of the links in a catalogue as one cause; none for a single link."""
    links = tuple(c for c in causes if isinstance(c, BodyInertia) and c.form == "all ten")
    return [Links(links)] if len(links) > 1 else []


def links_of(model: mujoco.MjModel, joints: Sequence[str], moving: Sequence[str]) -> list[int]:
    """The heaviest body of each link that the joints move."""
    links = rigid_links(model, joints, moving).values()
    return [max(link, key=lambda b: float(model.body_mass[b])) for link in links]


def rigid_links(
    model: mujoco.MjModel, joints: Sequence[str], moving: Sequence[str]
) -> dict[frozenset[int], list[int]]:
    """Bodies that move as one in these logs, by the degrees of freedom that move them; only of
    links that a driven joint moves, starting next to the base."""
    tree = Tree(model)
    moved = {int(model.joint(name).dofadr[0]) for name in (*joints, *moving)}
    driven = {int(model.joint(name).dofadr[0]) for name in joints}
    links: dict[frozenset[int], list[int]] = {}
    for b in range(1, model.nbody):
        dofs = frozenset(d for d in moved if b in tree.beyond[d])
        if dofs & driven:
            links.setdefault(dofs, []).append(b)
    return links


def _neighbours(model: mujoco.MjModel, joints: Sequence[str]) -> list[tuple[str, str]]:
    """Hinges next to each other along a branch."""
    hinges = [name for name in joints if not is_slide(model, name)]
    found = []
    for a, b in itertools.pairwise(hinges):
        up = int(model.joint(b).bodyid[0])
        parents = {up, int(model.body_parentid[up])}
        if int(model.joint(a).bodyid[0]) in parents:
            found.append((a, b))
    return found


def body_label(model: mujoco.MjModel, body: int) -> str:
    """Name of a body, or a description of a body without a name."""
    return str(model.body(body).name or f"body {body}")


def _reach(model: mujoco.MjModel, body: int) -> float:
    """Size of a body, m: the square root of twice its squared radius of gyration."""
    gyration = float(model.body_inertia[body].sum()) / float(model.body_mass[body])
    return float(np.sqrt(gyration)) + float(np.linalg.norm(model.body_ipos[body]))
