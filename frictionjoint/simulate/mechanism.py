"""Effects that are parts of a model: joints between motor and link, delayed sensors.

Elasticity and backlash are a second joint with the same axis, ``JOINT_deflection``: the angle of
the link relative to the motor. The joint with friction turns with the motor; its armature is the
rotor. For `joint-elasticity` the second joint has a spring and a damper. For `backlash` it moves
freely within the gap, and beyond the gap the flanks push but do not pull.

A fit gives the numbers that the motor sees: the inertia J behind the spring, the resonance of J
with the motor locked, and its damping. How the model receives them depends on the joint:

* The last joint of a chain: the link gets the inertia J. If the model's inertia is too small, the
  difference becomes the armature of a tendon over both joints. If it is too large, the difference
  moves to the rotor. If MuJoCo would refuse such a body, and the joint is the first one, its mass
  moves nearer to the axis and keeps its gravity torque. Otherwise the mass stays, and the
  deflection gets an armature so that the motor sees the identified inertia.
* A joint with other joints behind it: the inertia is that of the bodies, in every pose, and the fit
  gives stiffness and damping.
* A joint with a gap: the link behind the gap is without the parts that turn with the motor.

A `measurement-delay` is MuJoCo's own delay of a joint's sensors: of position and velocity if the
position is logged late, of the actuator force if the torque is. A joint without such sensors gets
them. Nothing else is delayed: the simulation itself uses the true position.
"""

import math
import warnings
from collections.abc import Callable, Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.gear import JOINT_ELASTICITY as ELASTICITY
from frictionjoint.errors import ModelError
from frictionjoint.model_joints import mass_at_start
from frictionjoint.simulate.native_friction import set_first

DEFLECTION, TENDON = "_deflection", "_link"
# of the joint's inertia: a rotor has so much at least, as a link behind a gap has, and so much at
# most to make a fast spring possible
_LEAST_ROTOR, _MOST_ROTOR = 0.01, 0.5
# radians that the two masses may swing against each other in a time step: springs are explicit. A
# flank's edge within a step gives or takes energy, so half as many
_FASTEST = 0.7
_FASTEST_FLANK = 0.5 * _FASTEST
_POSITION = (mujoco.mjtSensor.mjSENS_JOINTPOS, mujoco.mjtSensor.mjSENS_JOINTVEL)
_TORQUE = (mujoco.mjtSensor.mjSENS_JOINTACTFRC,)
_NAMES = {_POSITION[0]: "position", _POSITION[1]: "velocity", _TORQUE[0]: "torque"}


class _Spring(NamedTuple):
    """Spring between motor and link.

    Attributes:
        inertia: behind it, kg m^2. stiffness: N m/rad. damping: N m s/rad. half_gap: rad.
        least_rotor: kg m^2.
    """

    inertia: float
    stiffness: float
    damping: float
    half_gap: float
    least_rotor: float


def require_place(spec: mujoco.MjSpec, name: str) -> None:
    """Raise ModelError if a joint can have no deflection behind it: another joint of its body comes
    after it, or the deflection's name is taken."""
    joint = spec.joint(name)
    own = [other.name for other in joint.parent.joints]
    if own[-1] != name:
        raise ModelError(
            f"joint {name!r} is elastic or has backlash, and joint {own[-1]!r} of the same body "
            "comes after it: give each a body of its own"
        )
    if name + DEFLECTION in {other.name for other in spec.joints}:
        raise ModelError(f"the model has a joint {name + DEFLECTION!r} already: rename it")


def add_mechanism(spec: mujoco.MjSpec, name: str, effects: Sequence[tuple[Effect, Array]]) -> None:
    """Put a deflection behind a joint; changed in place, keyframes too.

    Each effect of the mechanism comes with its numbers, shape then coefficients.
    """
    model = spec.copy().compile()
    j = model.joint(name).id
    dof, step = int(model.jnt_dofadr[j]), float(spec.option.timestep)
    armature = float(model.dof_armature[dof])
    link = float(mass_at_start(model)[dof, dof]) - armature
    spring = _spring(name, effects, link, link + armature, step)
    joint = spec.joint(name)
    made = joint.parent.add_joint(
        name=name + DEFLECTION, type=joint.type, axis=joint.axis, pos=joint.pos, group=joint.group
    )
    # whatever the defaults are
    made.armature = made.frictionloss = made.ref = made.springref = 0.0
    made.limited = mujoco.mjtLimited.mjLIMITED_FALSE
    set_first(made, "stiffness", 0.0)
    set_first(made, "damping", 0.0)
    more, ratio = spring.inertia - link, 1.0
    hinge, from_geom = joint.type == mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtInertiaFromGeom
    # an explicit inertia, not one from geoms
    own_inertia = hinge and spec.compiler.inertiafromgeom != from_geom.mjINERTIAFROMGEOM_TRUE
    if np.any(model.dof_parentid == dof):
        joint.armature = max(armature, spring.least_rotor)
    elif more > 0.0:
        tendon = spec.add_tendon(name=name + TENDON, armature=more)
        tendon.wrap_joint(name, 1.0)
        tendon.wrap_joint(name + DEFLECTION, 1.0)
        joint.armature = armature - more
    elif own_inertia and (
        _lighter(joint.parent, model, j, -more) or _nearer(joint.parent, model, j, -more)
    ):
        joint.armature = armature - more
    else:
        ratio = link / spring.inertia
        made.armature = link * ratio - link
    _in_keys(spec, np.insert, int(model.jnt_qposadr[j]) + 1, dof + 1, 0.0)
    stiffness, damping = spring.stiffness * ratio**2, spring.damping * ratio**2
    if spring.half_gap == 0.0:
        set_first(made, "stiffness", stiffness)
        set_first(made, "damping", damping)
        return
    compiled = spec.copy().compile()
    weight = float(compiled.dof_invweight0[int(compiled.joint(made.name).dofadr[0])])
    unit = 180.0 / math.pi if hinge and spec.compiler.degree else 1.0
    made.limited = mujoco.mjtLimited.mjLIMITED_TRUE
    made.range = np.array([-1.0, 1.0]) * spring.half_gap / ratio * unit
    # an impedance so small that the constraint is a spring of this stiffness
    made.solimp_limit[:] = 1e-4, 1e-4, 1.0, 0.5, 1.0
    # negative numbers are stiffness and damping, over the inertia that MuJoCo takes for the joint's
    made.solref_limit[:] = -stiffness * weight, -damping * weight


def remove_mechanism(spec: mujoco.MjSpec, name: str) -> None:
    """Remove a joint's deflection, if it has one; inertia that was moved is not moved back."""
    found = spec.joint(name + DEFLECTION)
    if found is None:
        return
    model = spec.copy().compile()
    j = model.joint(found.name).id
    tendon = spec.tendon(name + TENDON)
    if tendon is not None:
        spec.joint(name).armature += tendon.armature
        spec.delete(tendon)
    spec.delete(found)
    _in_keys(spec, np.delete, int(model.jnt_qposadr[j]), int(model.jnt_dofadr[j]))


def require_flags(model: mujoco.MjModel, name: str) -> None:
    """Raise ModelError if a flag of the model keeps a joint's deflection from springing back."""
    j = deflection(model, name)
    if j < 0:
        return
    bit = mujoco.mjtDisableBit
    wanted = {"spring": bit.mjDSBL_SPRING}
    if model.jnt_limited[j]:
        wanted = {"constraint": bit.mjDSBL_CONSTRAINT, "limit": bit.mjDSBL_LIMIT}
    for flag, mask in wanted.items():
        if model.opt.disableflags & int(mask):
            raise ModelError(
                f"the flag {flag!r} is disabled, so nothing holds joint {name + DEFLECTION!r}: "
                "enable it in <option><flag>"
            )


def deflection(model: mujoco.MjModel, name: str) -> int:
    """Id of the joint behind an elastic joint or one with backlash; -1 for another."""
    found: int = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name + DEFLECTION)
    return found


def _spring(
    name: str, effects: Sequence[tuple[Effect, Array]], link: float, total: float, step: float
) -> _Spring:
    """The spring of one effect, or of two in series, softened as the time step requires."""
    behind, half_gap, compliance, damping_ratio = total, 0.0, 0.0, 0.0
    for effect, numbers in effects:
        if effect is ELASTICITY:
            frequency, ratio, inertia = (float(x) for x in numbers)
        else:
            gap, frequency, ratio, rotor, _ = (float(x) for x in numbers)
            inertia = max(link - rotor, _LEAST_ROTOR * total)
            half_gap = 0.5 * gap / inertia
        behind, damping_ratio = min(behind, inertia), max(damping_ratio, ratio)
        compliance += 1.0 / (2.0 * math.pi * frequency) ** 2
    rate = 1.0 / math.sqrt(compliance)
    fastest = _FASTEST_FLANK if half_gap > 0.0 else _FASTEST
    # against each other the masses swing faster than the link alone, by the root of total / rotor
    if rate * step > fastest * math.sqrt(_MOST_ROTOR):
        wanted, rate = rate, fastest * math.sqrt(_MOST_ROTOR) / step
        warnings.warn(
            f"joint {name!r}: its spring of {wanted / (2.0 * math.pi):.3g} Hz is softened to "
            f"{rate / (2.0 * math.pi):.3g} Hz: take a time step below {step * rate / wanted:.2g} s",
            RuntimeWarning,
            stacklevel=4,
        )
    least = max(_LEAST_ROTOR, (rate * step / fastest) ** 2) * total
    behind = max(min(behind, total - least), least)
    damping = 2.0 * damping_ratio * rate * behind
    return _Spring(behind, behind * rate**2, damping, half_gap, least)


def _lighter(body: mujoco.MjsBody, model: mujoco.MjModel, j: int, excess: float) -> bool:
    """Reduce the inertia of a body about a hinge by kg m^2; False if no such body can exist."""
    b = int(model.jnt_bodyid[j])
    flat = np.zeros(9)
    mujoco.mju_quat2Mat(flat, model.body_iquat[b])
    frame = flat.reshape(3, 3)
    axis = frame.T @ model.jnt_axis[j]
    moments, axes = np.linalg.eigh(np.diag(model.body_inertia[b]) - excess * np.outer(axis, axis))
    if moments[0] <= 0.0 or moments[0] + moments[1] < moments[2]:
        return False
    axes[:, 2] *= np.linalg.det(axes)
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, (frame @ axes).reshape(-1))
    _give(body, float(model.body_mass[b]), model.body_ipos[b], moments, quat)
    return True


def _nearer(body: mujoco.MjsBody, model: mujoco.MjModel, j: int, excess: float) -> bool:
    """Reduce the inertia about a hinge by moving the mass nearer, with its first moment kept;
    False if other joints feel the mass, or if its distance does not suffice."""
    if model.dof_parentid[model.jnt_dofadr[j]] >= 0:
        return False
    b = int(model.jnt_bodyid[j])
    mass, place, axis = float(model.body_mass[b]), model.body_ipos[b], model.jnt_axis[j]
    centre = place - model.jnt_pos[j]
    across = centre - (centre @ axis) * axis
    away = mass * float(across @ across)
    # nearer than 5% of its distance, the mass would be a heavy point
    if excess >= 0.95 * away:
        return False
    far = excess / away
    nearer = place - far * across
    _give(body, mass / (1.0 - far), nearer, model.body_inertia[b], model.body_iquat[b])
    return True


def _give(body: mujoco.MjsBody, mass: float, place: Array, inertia: Array, quat: Array) -> None:
    """Give a body a mass and principal moments about its centre."""
    body.explicitinertial = True
    body.mass, body.ipos = mass, place
    body.inertia, body.iquat = inertia, quat
    body.fullinertia = np.full(6, np.nan)


def _in_keys(
    spec: mujoco.MjSpec, change: Callable[..., Array], qpos: int, dof: int, *value: float
) -> None:
    """Insert or delete a deflection at these addresses of the keyframes."""
    for key in spec.keys:
        for field, at in (("qpos", qpos), ("qvel", dof)):
            numbers = np.asarray(getattr(key, field))
            if numbers.size:
                setattr(key, field, change(numbers, at, *value))


def delay_sensors(spec: mujoco.MjSpec, joint: str, delay: float) -> None:
    """Delay a joint's sensors, s: of the position if above 0, of the torque if below; in place."""
    late, of_joint = _POSITION if delay > 0.0 else _TORQUE, mujoco.mjtObj.mjOBJ_JOINT
    for kind, name in _NAMES.items():
        found = [s for s in spec.sensors if s.type == kind and s.objname == joint] or [
            spec.add_sensor(name=f"{joint}_{name}", type=kind, objtype=of_joint, objname=joint)
        ]
        for sensor in found if kind in late else ():
            sensor.delay = abs(delay)
            # linear between the samples that MuJoCo keeps
            sensor.interp = 1
            sensor.nsample = math.ceil(abs(delay) / spec.option.timestep) + 2
