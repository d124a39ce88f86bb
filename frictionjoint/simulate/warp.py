"""Friction in mujoco_warp: many worlds at once, on a GPU or on the CPU.

mujoco_warp calls ``Model.callback.passive`` where MuJoCo calls ``mjcb_passive``. `attach_warp` puts
the friction of an MJCF there. The state of every world is in one warp array of the returned
`WarpFriction`, not in ``userdata``; the rule that commits it is that of `simulate.row`.
"""

import warnings
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from frictionjoint.arguments import require_model
from frictionjoint.errors import FrictionJointError, ModelError
from frictionjoint.joint_friction import JointFriction
from frictionjoint.law.kernel import header_size
from frictionjoint.parameters import Friction
from frictionjoint.simulate.attach import require_callback
from frictionjoint.simulate.block import COUNT, EFFECTS, HEAD, JOINT, ROW, rows_of_block
from frictionjoint.simulate.carrier import resolve
from frictionjoint.simulate.joint_effects import asks_for_load
from frictionjoint.simulate.motor import gives_less, motors_of
from frictionjoint.simulate.set_parameters import require_joint, write_parameters
from frictionjoint.simulate.shaft_wave import wave_losses

# Runge-Kutta's four evaluations all bear the time of the step's beginning here, so that they could
# not be distinguished from repeated ones.
_INTEGRATORS = ("EULER", "IMPLICIT", "IMPLICITFAST")
# threads of a block; the law needs many registers, which small blocks waste least
_BLOCK = 128


class WarpMissingError(FrictionJointError, ImportError):
    """mujoco_warp is not installed."""


def _load() -> tuple[Any, Any]:
    try:
        import mujoco_warp
        import warp
    except ImportError as error:
        raise WarpMissingError(
            f"friction in mujoco_warp needs it ({error}): pip install 'frictionjoint[warp]'"
        ) from None
    return mujoco_warp, warp


class WarpFriction:
    """The friction of one `mujoco_warp` model and data; made by `attach_warp`.

    Usable in a ``with`` block, which ends with `detach`.

    Attributes:
        joints: names of the joints with friction, in the order of `torque`.
        joint_rows: index at which each joint's numbers begin in a world's state.
        parameters: warp array of doubles, the friction blocks' numbers: shape (1, n) while all
            worlds share them, (nworld, n) after `set_parameters` with one set per world.
        state: warp array of doubles, shape (nworld, m): the memory of each world, clocks included.
            Copy it, with the data, to save a simulation; it is not part of ``mujoco_warp``'s own
            state.
    """

    def __init__(self, m: Any, d: Any, mjm: mujoco.MjModel) -> None:
        mjw, wp = _load()
        found = _fitting(mjw, m, d, mjm)
        from frictionjoint.simulate import warp_kernel

        self._mjw, self._wp, self._model, self._data = mjw, wp, m, d
        self.joints = tuple(found)
        # each block, with the start of the joint's row of `simulate.row` in the state of a world
        self._numbers = numbers = np.array(mjm.numeric_data)
        self._addresses = at = _whole(found.values())
        starts = _starts([warp_kernel.FRONT + rows_of_block(numbers[a:]) for a in at])
        rows, room = starts[:-1], int(starts[-1])
        self.joint_rows = dict(zip(self.joints, rows.tolist(), strict=True))
        numbers[at + ROW] = rows + warp_kernel.FRONT
        # the kernels read each block without its integers
        lengths = HEAD + _whole(numbers[at + COUNT])
        read = np.concatenate([np.arange(a, a + n) for a, n in zip(at, lengths, strict=True)])
        self._first = _starts(lengths)[:-1]
        header = max(int(header_size(numbers, a + HEAD)) for a in at.tolist())
        effects = (at + _whole(numbers[at + EFFECTS])).tolist()
        # of the first effect that depends on the load, or -1
        loads = _whole(asks_for_load(numbers, a) for a in effects)
        self._has_loads = bool(loads.max() >= 0)
        motors = [
            motors_of(mjm, joint) if gives_less(numbers, a) else []
            for joint, a in zip(numbers[at + JOINT].astype(int).tolist(), effects, strict=True)
        ]
        motor, acting = m.actuator_gainprm.dtype, _whole(i for own in motors for i in own)
        has_effects = bool(np.any(numbers[effects] > 0.0))
        kernels, self._Motors = warp_kernel.build(has_effects, motor, header)
        self._take_back, self._friction, self._acted, self._reset = kernels
        n, nworld = len(self.joints), d.nworld
        with wp.ScopedDevice(d.qpos.device):
            self.parameters = wp.array(numbers[None, read], dtype=wp.float64)
            self._blocks = wp.array(self._first, dtype=int)
            self._rows = wp.array(rows, dtype=int)
            self._loads = wp.array(loads, dtype=int)
            self._locked = wp.array(mjm.dof_M0, dtype=float)
            self._motor_first = wp.array(_starts([len(own) for own in motors]), dtype=int)
            self._motors = wp.array(acting, dtype=int)
            self._no_motor = wp.zeros(n + 1, dtype=int)
            # worlds side by side: neighbouring threads then read neighbouring numbers
            self.state = wp.zeros((room, nworld), dtype=wp.float64).transpose()
            self._moved = wp.zeros((nworld, m.nv), dtype=float)
            self._pushed = wp.zeros((nworld, m.nv), dtype=float)
            self._torque = wp.zeros((nworld, n), dtype=float)
            self._of_effects = wp.zeros((nworld, n), dtype=float)
            self._every_world = wp.ones(nworld, dtype=wp.bool)
            # a graph capture must not meet a module that is still to be loaded
            for kernel in kernels:
                block_dim = 1 if d.qpos.device.is_cpu else _BLOCK
                wp.load_module(kernel.module, d.qpos.device, block_dim=block_dim)
        self._previous: Callable[[Any, Any], None] | None = m.callback.passive
        self._attached = True
        m.callback.passive = self._call

    def _call(self, m: Any, d: Any) -> None:
        if self._previous is not None:
            self._previous(m, d)
        if not self._attached:
            return
        if d is not self._data:
            raise ModelError(
                "friction is attached to another mujoco_warp Data: call attach_warp with the Data "
                "that is stepped"
            )
        # before anything reads M: no friction in it
        where = [self.parameters, self._blocks, self._rows]
        self._launch(self._take_back, [*where, m.M_rowadr, m.M_rownnz], [self.state, d.M])
        if self._has_loads:
            # the load of a gear: this step's bias forces, which come after passive ones, forces on
            # bodies, and accelerations and constraint forces that the step before has left
            self._mjw.rne(m, d)
            self._pushed.zero_()
            self._mjw.xfrc_accumulate(m, d, self._pushed)
            self._mjw.mul_m(m, d, self._moved, d.qacc)
        bit = self._mjw.DisableBit
        drives = not m.opt.disableflags & bit.ACTUATION
        body = [m.dof_invweight0, self._locked, m.M_rowadr, m.M_rownnz, m.dof_armature]
        gravity = [m.jnt_bodyid, m.jnt_axis, m.opt.gravity]
        motion = [d.time, d.qpos, d.qvel, d.qfrc_bias, self._pushed, self._moved, d.qacc]
        motors = self._Motors()
        motors.first = self._motor_first if drives else self._no_motor
        motors.acting, motors.ctrl = self._motors, d.ctrl
        motors.clamps = not m.opt.disableflags & bit.CLAMPCTRL
        motors.limited, motors.limits = m.actuator_ctrllimited, m.actuator_ctrlrange
        motors.gears = m.actuator_gear
        motors.gains, motors.biases = m.actuator_gainprm, m.actuator_biasprm
        inputs = [*where, self._loads, m.opt.timestep, *body, *gravity, *motion]
        inputs += [d.qfrc_constraint, d.xaxis, d.xmat, motors, self.state]
        self._launch(self._friction, inputs, [d.M, self._of_effects, d.qfrc_passive])
        self._mjw.factor_m(m, d)

    def _launch(self, kernel: Any, inputs: list[Any], outputs: list[Any]) -> None:
        """Run a kernel for every joint in every world."""
        d = self._data
        self._wp.launch(
            kernel,
            dim=(len(self.joints), d.nworld),
            inputs=inputs,
            outputs=outputs,
            device=d.qpos.device,
            block_dim=_BLOCK,
        )

    def set_parameters(
        self, joint: str, parameters: Friction | JointFriction | Sequence[Friction | JointFriction]
    ) -> None:
        """Change the friction of a joint, in all worlds or separately in each.

        The worlds' memory stays. A graph captured before keeps the old parameters.

        Args:
            parameters: as `frictionjoint.set_parameters` takes them, one or one per world.
        Raises:
            ModelError: another number of worlds, or as `frictionjoint.set_parameters`.
        """
        nworld = self._data.nworld
        number = self.joints.index(require_joint(self.joint_rows, joint))
        at, first, blocks = int(self._addresses[number]), int(self._first[number]), []
        rows = self.parameters.numpy()
        each = list(parameters) if isinstance(parameters, Sequence) else [parameters]
        if isinstance(parameters, Sequence):
            if len(each) != nworld:
                raise ModelError(f"{nworld} worlds, {len(each)} parameter sets: give one per world")
            rows = np.repeat(rows, nworld // len(rows), axis=0)
        for one in each:
            numbers = self._numbers.copy()
            blocks.append(numbers[at : write_parameters(numbers, at, one, joint)])
        # what is given without effects leaves those of each world as they are
        for i, block in enumerate(blocks):
            rows[i if len(each) == len(rows) else slice(None), first : first + len(block)] = block
        # worlds side by side, as in the state
        turned = self._wp.array(rows.T.copy(), dtype=self._wp.float64, device=self._torque.device)
        self.parameters = turned.transpose()

    def torque(self) -> Any:
        """Friction torques over the last step, as `frictionjoint.torque` defines them.

        Returns:
            warp array of floats on the model's device, shape (nworld, number of `joints`), N m (N
            for a slide joint); overwritten by the next call.
        """
        d = self._data
        where = [self.parameters, self._blocks, self._rows]
        seen = [self._model.opt.timestep, d.time, d.qvel, d.qacc, self._of_effects]
        self._launch(self._acted, where + seen, [self.state, self._torque])
        return self._torque

    def reset(self, world_mask: Any = None) -> None:
        """Reset the friction of worlds whose time continues: at rest and never moved from their
        next evaluation on. ``mujoco_warp.reset_data``, which sets the time back, does so too.

        Args:
            world_mask: shape (nworld,), booleans, as an array of numpy or of warp on the model's
                device; None: all worlds.
        Raises:
            ModelError: a mask of another shape.
        """
        mask = self._every_world
        if world_mask is not None:
            if tuple(world_mask.shape) != (self._data.nworld,):
                raise ModelError(
                    f"a mask of {self._data.nworld} worlds has shape ({self._data.nworld},), not "
                    f"{tuple(world_mask.shape)}"
                )
            mask = world_mask
            if not isinstance(mask, self._wp.array):
                on = self._data.qpos.device
                mask = self._wp.array(np.asarray(mask, dtype=bool), dtype=self._wp.bool, device=on)
        self._launch(self._reset, [mask, self._rows], [self.state])

    def detach(self) -> None:
        """Stop the friction and restore the previous callback. A captured graph keeps it."""
        self._attached = False
        if self._model.callback.passive == self._call:
            self._model.callback.passive = self._previous

    def __enter__(self) -> "WarpFriction":
        return self

    def __exit__(self, *raised: object) -> None:
        self.detach()


def _fitting(mjw: Any, m: Any, d: Any, mjm: mujoco.MjModel) -> dict[str, int]:
    """Addresses of the friction blocks by joint name, if all fits together."""
    sizes = [(m.nq, mjm.nq), (m.nv, mjm.nv), (m.njnt, mjm.njnt), (d.qpos.shape[1], mjm.nq)]
    if any(a != b for a, b in sizes):
        raise ModelError(
            "the mujoco_warp Model and Data were not made from this MjModel: give the one that "
            "went into put_model"
        )
    require_callback(m, "mujoco_warp")
    integrator = mjw.IntegratorType(m.opt.integrator).name
    if integrator not in _INTEGRATORS:
        raise ModelError(
            f"friction in mujoco_warp does not support the integrator {integrator}: use "
            f"{', '.join(_INTEGRATORS)}"
        )
    owner = getattr(m.callback.passive, "__self__", None)
    if isinstance(owner, WarpFriction):
        raise ModelError("this model is attached already: detach the friction it has first")
    # a spec that others are attached to loses their room in userdata, which is not used here
    found = resolve(mjm, in_userdata=False)
    if not found:
        raise ModelError("the model has no friction: use frictionjoint.install on its spec")
    for lost in wave_losses(mjm):
        warnings.warn(f"mujoco_warp leaves out {lost}", RuntimeWarning, stacklevel=4)
    return found


def attach_warp(m: Any, d: Any, mjm: mujoco.MjModel) -> WarpFriction:
    """Turn on the friction of a model in `mujoco_warp`, from the next step on.

    An existing passive callback is called first.

    Args:
        m: ``mujoco_warp.Model``, from ``put_model(mjm)``.
        d: ``mujoco_warp.Data`` with any number of worlds; the friction belongs to this one.
        mjm: with friction, see `install`.
    Raises:
        WarpMissingError: mujoco_warp is not installed.
        ModelError: no or damaged friction in the model, a model and data that do not belong
            together, an unsupported integrator or flag, or attached already.
        TypeError: `mjm` is no MjModel.
    """
    require_model(mjm, "attach_warp")
    return WarpFriction(m, d, mjm)


def _whole(numbers: Iterable[Any]) -> NDArray[np.int32]:
    return np.array(list(numbers), dtype=np.int32)


def _starts(sizes: Iterable[int]) -> NDArray[np.int32]:
    """Start of each of several consecutive ranges of given sizes, and the end of the last range."""
    return np.concatenate([[0], np.cumsum(_whole(sizes))]).astype(np.int32)
