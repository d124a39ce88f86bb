"""Random serial arms, and what can be hidden in them."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import mujoco
import numpy as np


@dataclass
class Arm:
    """A believed model and the true one.

    Attributes:
        believed, true: MJCF texts. joints: names. hidden: what the true one has, by cause.
        level, slope, stiffness, viscous: of each joint's friction, shape (n,): N m, rise of the
            level at breakaway, N m/rad, N m s/rad.
        load_level: growth of a joint's friction level with its load, shape (n,).
        fall: of a joint's whole friction per K above the temperature at which a log begins, (n,).
        warming: K by which the arm warms in the end, and with which time constant, s.
        shaft: (joint, other joint, level, viscous) of a shaft that turns with the sum of both.
        shaft_wave: (N m, 1/rad) by which its level rises and falls along its turn.
        gain: by which every torque is logged larger than it acts, a fraction.
    """

    believed: str
    true: str
    joints: list[str]
    level: np.ndarray
    slope: np.ndarray
    stiffness: np.ndarray
    viscous: np.ndarray
    load_level: np.ndarray
    fall: np.ndarray
    warming: tuple[float, float] | None = None
    shaft: tuple[int, int, float, float] | None = None
    shaft_wave: tuple[float, float] = (0.0, 0.0)
    gain: float = 0.0
    hidden: dict[str, object] = field(default_factory=dict)


def random_arm(seed: int, joints: int) -> Arm:
    """An arm whose believed model is the true one."""
    rng = np.random.default_rng(seed)
    spec = mujoco.MjSpec()
    spec.modelname = f"arm{seed}"
    parent, place = spec.worldbody, np.array([0.0, 0.0, 0.3])
    axis_before = np.zeros(3)
    sizes = np.geomspace(1.0, rng.uniform(0.15, 0.4), joints)
    for i in range(joints):
        body = parent.add_body(name=f"link{i + 1}", pos=place)
        axis = np.eye(3)[2 if i == 0 else rng.integers(3)]
        while i and abs(axis @ axis_before) > 0.5 and rng.random() < 0.7:
            axis = np.eye(3)[rng.integers(3)]
        axis_before = axis
        mass = sizes[i] ** 1.5 * rng.uniform(3.0, 8.0)
        length = sizes[i] * rng.uniform(0.25, 0.45)
        along = np.eye(3)[rng.choice([0, 2])] * length
        body.explicitinertial = True
        body.mass = mass
        body.ipos = along * rng.uniform(0.3, 0.6) + rng.normal(size=3) * 0.03 * sizes[i]
        thick = 0.06 * sizes[i]
        own = mass * (np.full(3, thick**2) + (length**2 - along**2) / 12.0)
        drawn = own * rng.uniform(0.9, 1.1, 3)
        # no body's largest moment exceeds the sum of the two others
        body.inertia = np.minimum(drawn, (1.0 - 1e-4) * (drawn.sum() - drawn))
        # a rotor behind a gear: of the order of the link's own inertia about the joint
        rotor = mass * length**2 * rng.uniform(0.3, 1.0)
        body.add_joint(name=f"j{i + 1}", axis=axis, armature=rotor)
        parent, place = body, along
    parent.add_site(name="flange", pos=place)
    text = written(spec)
    weight = torque_scale(text)
    level = weight * rng.uniform(0.05, 0.15, joints) + 0.02
    return Arm(
        believed=text,
        true=text,
        joints=[f"j{i + 1}" for i in range(joints)],
        level=level,
        slope=rng.uniform(0.1, 0.5, joints),
        stiffness=level / 10 ** rng.uniform(-3.3, -2.7, joints),
        viscous=level * rng.uniform(0.2, 0.8, joints),
        load_level=np.zeros(joints),
        fall=np.zeros(joints),
    )


def torque_scale(text: str) -> np.ndarray:
    """Typical torque of gravity and of accelerations of 3 rad/s^2 at each joint, N m."""
    model = mujoco.MjModel.from_xml_string(text)
    data, rng, rows = mujoco.MjData(model), np.random.default_rng(0), []
    for _ in range(50):
        data.qpos[:] = rng.uniform(-1.5, 1.5, model.nq)
        data.qacc[:] = rng.normal(size=model.nv) * 3.0
        mujoco.mj_inverse(model, data)
        rows.append(data.qfrc_inverse.copy())
    return np.sqrt(np.mean(np.square(rows), axis=0))


def written(spec: mujoco.MjSpec) -> str:
    spec.compile()
    return spec.to_xml()


def reread(text: str) -> mujoco.MjSpec:
    return mujoco.MjSpec.from_string(text)


def hide_payload(arm: Arm, mass: float, place, size: float = 0.04) -> None:
    """A ball at a place in the frame of the flange."""
    spec = reread(arm.true)
    last = spec.site("flange").parent
    at = np.array(spec.site("flange").pos) + place
    body = last.add_body(name="hidden payload", pos=at)
    body.explicitinertial = True
    body.mass, body.ipos, body.inertia = mass, np.zeros(3), np.full(3, 0.4 * mass * size**2)
    arm.true = written(spec)
    arm.hidden["payload"] = (last.name, mass, at)


def geared(arm: Arm, parts: Sequence[float]) -> None:
    """Give each joint a rotor as large as a part of the inertia that it turns at rest."""
    model = mujoco.MjModel.from_xml_string(arm.true)
    data, M = mujoco.MjData(model), np.zeros((model.nv, model.nv))
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, M)
    true, believed = reread(arm.true), reread(arm.believed)
    for joint, inertia, part in zip(arm.joints, np.diag(M), parts, strict=True):
        true.joint(joint).armature = believed.joint(joint).armature = inertia * part
    arm.true, arm.believed = written(true), written(believed)


def hide_rotor(arm: Arm, joint: str) -> None:
    """The believed model lacks a joint's rotor."""
    spec = reread(arm.believed)
    arm.hidden.setdefault("rotor-inertia", {})[joint] = float(spec.joint(joint).armature)
    spec.joint(joint).armature = 0.0
    arm.believed = written(spec)


def hide_mass(arm: Arm, body: str, factor: float, shift=(0.0, 0.0, 0.0)) -> None:
    """A link is heavier than believed, all of it, and its centre lies elsewhere by `shift`, m."""
    spec = reread(arm.true)
    found = spec.body(body)
    arm.hidden["body-inertia"] = (body, float(found.mass) * factor)
    found.mass = float(found.mass) * factor
    found.inertia = np.array(found.inertia) * factor
    found.ipos = np.array(found.ipos) + shift
    arm.true = written(spec)


def hide_tilt(arm: Arm, angle: float, heading: float) -> None:
    """The base leans by an angle about a horizontal axis, rad."""
    spec = reread(arm.true)
    size = float(np.linalg.norm(spec.option.gravity))
    axis = np.array([np.cos(heading), np.sin(heading), 0.0])
    spec.option.gravity = size * (
        -np.cos(angle) * np.array([0, 0, 1.0]) + np.sin(angle) * np.cross(axis, [0, 0, -1.0])
    )
    arm.true = written(spec)
    arm.hidden["base-tilt"] = (angle, np.array(spec.option.gravity))


def hide_load_dependence(arm: Arm, joint: str, factor: float) -> None:
    arm.load_level[arm.joints.index(joint)] = factor
    arm.hidden["load-dependent"] = (joint, factor)


def hide_warming(arm: Arm, joints: list[str], fall: float, rise: float, tau: float) -> None:
    """Friction of some joints falls while the arm warms by `rise` K with a time constant, s."""
    arm.fall[[arm.joints.index(joint) for joint in joints]] = fall
    arm.warming = rise, tau
    arm.hidden["temperature-dependent"] = (joints, fall)


def hide_supply(arm: Arm, gain: float) -> None:
    """The supply of all drives is less than their scales were made with: every torque is."""
    arm.gain = gain
    arm.hidden["torque-gain"] = gain


def hide_coupling(arm: Arm, rotor: float, depth: float = 0.0, waves: float = 0.0) -> None:
    """A shaft that turns with the sum of the last two joints, with friction and inertia.

    Its friction level rises and falls by a part `depth` of it, in `waves` per rad of its turn.
    """
    spec = reread(arm.true)
    a, b = arm.joints[-2:]
    tendon = spec.add_tendon(name="shaft", armature=rotor)
    tendon.wrap_joint(a, 1.0)
    tendon.wrap_joint(b, 1.0)
    arm.true = written(spec)
    n = len(arm.joints)
    level = 0.7 * float(arm.level[-1])
    arm.shaft = (n - 2, n - 1, level, 0.5 * level)
    arm.shaft_wave = depth * level, waves
    arm.hidden["gear-coupling"] = (a, b, level, 0.5 * level, rotor)


def heavier_link_and_rotor(seed: int) -> Arm:
    """An arm of two joints whose second link is heavier and whose first rotor is missing."""
    arm = random_arm(seed, 2)
    hide_mass(arm, "link2", 1.3)
    hide_rotor(arm, "j1")
    return arm
