"""A user's model for evaluation: a description of its friction, and where the logged drive acts.

A measured torque replaces all actuators; of a `dcmotor` only friction and cogging remain. A
measured voltage or current is the control of the joint's own actuator.
"""

from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from frictionjoint.effects.catalogue import title
from frictionjoint.errors import ModelError, few
from frictionjoint.evaluation.recording import Recording
from frictionjoint.identify.fixed_joints import Pose, joint_label, lock, take_pose
from frictionjoint.identify.fixed_joints import resolve as resolve_poses
from frictionjoint.model_files import ONE_DOF, compile_model
from frictionjoint.model_joints import actuators_of, count_of_actuators
from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.block import blocks
from frictionjoint.simulate.carrier import read_friction
from frictionjoint.simulate.mechanism import deflection
from frictionjoint.simulate.native_friction import native_friction

# a motor constant at which a dcmotor delivers practically no torque; MuJoCo 3 rejects 0
_NO_CONSTANT = 1e-6
# index of the motor constant in gainprm of a dcmotor
_CONSTANT = 1


class EvaluatedModel:
    """A compiled model, at the time step of a log; joints without logged motion are held in place.

    Args:
        source: path or text of an MJCF or URDF. recording: of the joints to evaluate.
        fixed: positions of joints that no log contains, by name, rad or m.
    Attributes:
        model: compiled, without contacts. joints: names of the joints to evaluate. dofs, qpos:
            their addresses, shape (k,).
        links: joints between motor and link, which the friction model itself has added.
        controls: index in `ctrl` of each joint's drive; None if the drive is a torque.
    Raises:
        ModelError: the model does not compile, has no such joint, or no actuator for a voltage.
    """

    def __init__(
        self, source: str | Path, recording: Recording, fixed: Mapping[str, Pose] | None
    ) -> None:
        self.model = compile_model(source)
        self.model.opt.timestep = recording.step
        self.joints = list(recording.logs)
        ids = [require_joint(self.model, name) for name in self.joints]
        joint = mujoco.mjtObj.mjOBJ_JOINT
        led = [mujoco.mj_name2id(self.model, joint, name) for name in recording.led]
        self.dofs = self.model.jnt_dofadr[ids].astype(int)
        self.qpos = self.model.jnt_qposadr[ids].astype(int)
        take_pose(self.model, resolve_poses(self.model, -1, fixed))
        used = {name: self._actuator(name, recording.kinds[name]) for name in self.joints}
        # before MuJoCo 3.12 each actuator has one control
        first = getattr(self.model, "actuator_ctrladr", range(count_of_actuators(self.model)))
        self.controls = {n: None if i is None else int(first[i]) for n, i in used.items()}
        self._silence({i for i in used.values() if i is not None})
        self.links = [j for name in self.joints if (j := deflection(self.model, name)) >= 0]
        lock(self.model, *ids, *led, *self.links)
        self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)

    def acting(self) -> AbstractContextManager[Any]:
        """Context in which the friction of the model acts."""
        return attach(self.model) if blocks(self.model) else nullcontext()

    def _actuator(self, joint: str, drive: str) -> int | None:
        if drive == "torque":
            return None
        own = actuators_of(self.model, joint)
        named = [i for i in own if self.model.actuator(i).name == f"{joint}_{drive}"]
        fixed = int(mujoco.mjtGain.mjGAIN_FIXED)
        takes = named or [
            i
            for i in own
            if (
                _is_dcmotor(self.model, i)
                and abs(self.model.actuator_gainprm[i, _CONSTANT]) > _NO_CONSTANT
            )
            or (self.model.actuator_gaintype[i] == fixed and not self.model.actuator_biasprm[i, 1])
        ]
        if len(takes) != 1:
            many = f"{len(takes)} actuators" if takes else "no actuator"
            raise ModelError(
                f"the log of joint {joint!r} contains a {drive} and the model has {many} that it "
                "could be the control of: add a motor or dcmotor to the joint, or give --gain"
            )
        return int(takes[0])

    def _silence(self, used: set[int]) -> None:
        """Disable the torque of actuators whose drive is not in the logs."""
        for i in set(range(count_of_actuators(self.model))) - used:
            if _is_dcmotor(self.model, i):
                self.model.actuator_gainprm[i, _CONSTANT] = _NO_CONSTANT
            else:
                self.model.actuator_gainprm[i] = 0.0
                self.model.actuator_biasprm[i] = 0.0

    def limits(self, joint: str) -> tuple[float, float]:
        """Range of a joint, rad (m); infinite without limits."""
        j = self.model.joint(joint).id
        low, high = self.model.jnt_range[j] if self.model.jnt_limited[j] else (-np.inf, np.inf)
        return float(low), float(high)


def require_joint(model: mujoco.MjModel, joint: str) -> int:
    """Index of a hinge or slide joint; ModelError if the model has none of that name."""
    j: int = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, joint)
    if j < 0 or int(model.jnt_type[j]) not in ONE_DOF:
        names = [joint_label(model, i) for i in range(model.njnt)]
        raise ModelError(
            f"no hinge or slide joint {joint!r} in the model: it has {few(names, 12) or 'none'}"
        )
    return j


def friction_words(model: mujoco.MjModel, joint: str) -> str:
    """Description of the friction of a joint in a model."""
    said = []
    if joint in blocks(model):
        carried = read_friction(model)[joint]
        effects = "".join(f", {title(e.effect.name)}" for e in carried.effects)
        said.append(f"frictionjoint law {carried.parameters.law}{effects}")
    native = native_friction(model, [joint]).get(joint)
    if native:
        said.append(native)
    j = model.joint(joint).id
    if hasattr(model, "jnt_springyield"):
        tendons = _yielding_tendons(model, j)
        if model.jnt_springyield[j] > 0.0 or tendons:
            count = int(model.jnt_springyield[j] > 0.0) + tendons
            said.append(f"{count} yield spring{'s' if count > 1 else ''}")
    for i in actuators_of(model, joint):
        # the fourth number is the Coulomb torque of its LuGre friction
        if _is_dcmotor(model, i) and model.actuator_biasprm[i, 3] > 0.0:
            said.append(f"dcmotor {model.actuator(i).name or i} with LuGre friction")
    return "; ".join(said) or "none"


def _yielding_tendons(model: mujoco.MjModel, joint: int) -> int:
    """Number of fixed tendons over this joint alone that have a yielding spring."""
    count = 0
    for t in range(model.ntendon):
        wraps = range(model.tendon_adr[t], model.tendon_adr[t] + model.tendon_num[t])
        own = [model.wrap_objid[w] for w in wraps]
        of_joint = model.wrap_type[wraps[0]] == int(mujoco.mjtWrap.mjWRAP_JOINT)
        count += of_joint and own == [joint] and model.tendon_springyield[t] > 0.0
    return int(count)


def _is_dcmotor(model: mujoco.MjModel, i: int) -> bool:
    kind = getattr(mujoco.mjtGain, "mjGAIN_DCMOTOR", None)
    return kind is not None and model.actuator_gaintype[i] == int(kind)
