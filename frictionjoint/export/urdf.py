"""``--to urdf``: links, inertias and joints of an MJCF, each joint with its ``<dynamics>``.

A URDF joint has one viscous coefficient and one Coulomb torque for both directions, and no rotor
inertia. Geometry is left out: if you have a URDF of the robot, copy the ``<dynamics>`` lines.
"""

import xml.etree.ElementTree as ET
from collections.abc import Mapping

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import ModelError
from frictionjoint.export.sliding import PlainFriction

# <limit> needs numbers that an MJCF does not have
_UNLIMITED = 1e6
# kg and kg m^2 of links between joints of one body: readers refuse moving links without mass
_NOTHING = 1e-9
_HINGE, _SLIDE = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
_FREE = int(mujoco.mjtJoint.mjJNT_FREE)


def urdf_text(model: mujoco.MjModel, friction: Mapping[str, PlainFriction], note: str) -> str:
    """The URDF of a compiled model, with friction by joint in addition to the model's native one.

    Args:
        note: a comment at the top.
    Raises:
        ModelError: a ball joint, or a free joint that is not at a root.
    """
    robot = ET.Element("robot", name=model.names[: model.names.index(b"\0")].decode() or "robot")
    robot.append(ET.Comment(f" {note.replace('--', '- -')} "))
    ET.SubElement(robot, "link", name="world")
    links = {0: ("world", np.zeros(3))}
    for body in range(1, model.nbody):
        links[body] = _add_body(robot, model, body, links[int(model.body_parentid[body])], friction)
    ET.indent(robot, "  ")
    return '<?xml version="1.0"?>\n' + ET.tostring(robot, encoding="unicode") + "\n"


def _add_body(
    robot: ET.Element,
    model: mujoco.MjModel,
    body: int,
    parent: tuple[str, Array],
    friction: Mapping[str, PlainFriction],
) -> tuple[str, Array]:
    """Links and joints of a body; its last link, and the position of that link in the body, m.

    A link's frame is at its joint; several joints of a body are connected by links of almost no
    mass.
    """
    name = model.body(body).name or f"body{body}"
    first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
    position, rotation = model.body_pos[body], model.body_quat[body]
    R = np.zeros(9)
    mujoco.mju_quat2Mat(R, rotation)
    link, at, turn = parent[0], np.zeros(3), rotation
    origin = position - parent[1]
    for j in range(first, first + count):
        child = name if j == first + count - 1 else f"{name}_{j - first}"
        kind = int(model.jnt_type[j])
        place = np.zeros(3) if kind == _FREE else np.array(model.jnt_pos[j])
        step = R.reshape(3, 3) @ place if j == first else place - at
        element = _joint(robot, model, j, friction)
        _origin(element, origin + step, turn)
        ET.SubElement(element, "parent", link=link)
        ET.SubElement(element, "child", link=child)
        _link(robot, model, body, child, place, j == first + count - 1)
        link, at, turn, origin = child, place, np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3)
    if count == 0:
        element = ET.SubElement(robot, "joint", name=f"{name}_fixed", type="fixed")
        _origin(element, origin, turn)
        ET.SubElement(element, "parent", link=link)
        ET.SubElement(element, "child", link=name)
        _link(robot, model, body, name, at, True)
    return name, at


def _joint(
    robot: ET.Element, model: mujoco.MjModel, j: int, friction: Mapping[str, PlainFriction]
) -> ET.Element:
    name, kind = model.joint(j).name or f"joint{j}", int(model.jnt_type[j])
    if kind == _FREE:
        return ET.SubElement(robot, "joint", name=name, type="floating")
    if kind not in (_HINGE, _SLIDE):
        raise ModelError(f"joint {name!r} is a ball joint: URDF has none, use three hinges")
    limited = bool(model.jnt_limited[j])
    hinge = "revolute" if limited else "continuous"
    kinds = {_HINGE: hinge, _SLIDE: "prismatic"}
    element = ET.SubElement(robot, "joint", name=name, type=kinds[kind])
    ET.SubElement(element, "axis", xyz=_numbers(model.jnt_axis[j]))
    if limited or kind == _SLIDE:
        low, high = model.jnt_range[j] if limited else (-_UNLIMITED, _UNLIMITED)
        limit = {"lower": repr(float(low)), "upper": repr(float(high))}
        most = {"effort": repr(_UNLIMITED), "velocity": repr(_UNLIMITED)}
        ET.SubElement(element, "limit", limit | most)
    dof = int(model.jnt_dofadr[j])
    damping, loss = float(model.dof_damping[dof]), float(model.dof_frictionloss[dof])
    plain = friction.get(name)
    if plain:
        damping, loss = damping + plain.damping[0], loss + plain.coulomb
    ET.SubElement(element, "dynamics", damping=repr(damping), friction=repr(loss))
    return element


def _link(
    robot: ET.Element, model: mujoco.MjModel, body: int, name: str, at: Array, massive: bool
) -> None:
    link = ET.SubElement(robot, "link", name=name)
    mass, inertia = float(model.body_mass[body]), model.body_inertia[body]
    if massive and mass == 0.0:
        return
    inertial = ET.SubElement(link, "inertial")
    if massive:
        _origin(inertial, model.body_ipos[body] - at, model.body_iquat[body])
    else:
        mass, inertia = _NOTHING, np.full(3, _NOTHING)
    ET.SubElement(inertial, "mass", value=repr(mass))
    x, y, z = (repr(float(v)) for v in inertia)
    ET.SubElement(inertial, "inertia", ixx=x, iyy=y, izz=z, ixy="0", ixz="0", iyz="0")


def _origin(element: ET.Element, position: Array, rotation: Array) -> None:
    """Position, m, and a rotation from a quaternion, written as fixed-axis angles."""
    R = np.zeros(9)
    mujoco.mju_quat2Mat(R, np.ascontiguousarray(rotation, dtype=np.float64))
    M = R.reshape(3, 3)
    pitch = np.arctan2(-M[2, 0], np.hypot(M[0, 0], M[1, 0]))
    if np.hypot(M[0, 0], M[1, 0]) > 1e-9:
        roll, yaw = np.arctan2(M[2, 1], M[2, 2]), np.arctan2(M[1, 0], M[0, 0])
    else:  # roll and yaw turn about one axis: one of them is free
        roll, yaw = np.arctan2(-M[1, 2], M[1, 1]), 0.0
    origin = ET.Element("origin", xyz=_numbers(position), rpy=_numbers([roll, pitch, yaw]))
    element.insert(0, origin)


def _numbers(values: Array | list[float]) -> str:
    return " ".join(repr(float(x)) for x in values)
