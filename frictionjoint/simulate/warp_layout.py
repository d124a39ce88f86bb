"""Addresses of joints with friction, and of their motors, in the arrays of the Warp kernels."""

from collections.abc import Iterable, Mapping
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.joint_friction import JointFriction
from frictionjoint.law.kernel import header_size
from frictionjoint.parameters import Friction
from frictionjoint.simulate.block import COUNT, EFFECTS, HEAD, JOINT, ROW, rows_of_block
from frictionjoint.simulate.joint_effects import asks_for_load
from frictionjoint.simulate.motor import gives_less, motors_of
from frictionjoint.simulate.set_parameters import write_parameters

Whole = NDArray[np.int32]


class Layout:
    """Addresses for n joints with friction.

    Args:
        found: address of each block in the model's numerics, by joint name.
        front: length of the part of a joint's state before its row.
    Attributes:
        joints: names, shape (n,); all other arrays have the same order.
        read: indices of the numbers that the kernels read: each block without its integers.
        numbers: the model's numerics; ROW in each block is the start of the joint's row of
            `simulate.row` in the state of a world.
        blocks: start of each block among the numbers that the kernels read, shape (n,).
        rows: start of each joint's numbers in the state of a world, shape (n,).
        room: length of the state of a world. header: length of the longest header of a law.
        loads: index of the first effect that depends on the load, or -1, shape (n,).
        motor_first, motors: actuators of joints that saturate; those of the i-th joint are
            motors[motor_first[i]:motor_first[i + 1]].
        has_effects, has_loads: whether any joint has effects, or effects that depend on the load.
    """

    def __init__(self, model: mujoco.MjModel, found: Mapping[str, int], front: int) -> None:
        self.joints = tuple(found)
        self.numbers = numbers = np.array(model.numeric_data)
        self._addresses = at = _whole(found.values())
        starts = _starts([front + rows_of_block(numbers[a:]) for a in at])
        self.rows, self.room = starts[:-1], int(starts[-1])
        numbers[at + ROW] = self.rows + front
        lengths = HEAD + _whole(numbers[at + COUNT])
        self.blocks = _starts(lengths)[:-1]
        self.read = np.concatenate([np.arange(a, a + n) for a, n in zip(at, lengths, strict=True)])
        self.header = max(int(header_size(numbers, a + HEAD)) for a in at.tolist())
        effects = (at + _whole(numbers[at + EFFECTS])).tolist()
        self.has_effects = bool(np.any(numbers[effects] > 0.0))
        self.loads = _whole(asks_for_load(numbers, a) for a in effects)
        self.has_loads = bool(self.loads.max() >= 0)
        motors = [
            motors_of(model, joint) if gives_less(numbers, a) else []
            for joint, a in zip(numbers[at + JOINT].astype(int).tolist(), effects, strict=True)
        ]
        self.motor_first = _starts([len(own) for own in motors])
        self.motors = _whole(i for own in motors for i in own)

    def block_with(self, number: int, friction: Friction | JointFriction) -> Array:
        """Numbers of a joint's block with different friction parameters.

        Args:
            friction: the new friction. For a `Friction`, which has no effects, the result ends
                before the numbers of the effects.
        Raises:
            ModelError: the law, the number of knots, or the effects differ from the joint's.
        """
        numbers, at = self.numbers.copy(), int(self._addresses[number])
        return numbers[at : write_parameters(numbers, at, friction, self.joints[number])]


def _whole(numbers: Iterable[Any]) -> Whole:
    return np.array(list(numbers), dtype=np.int32)


def _starts(sizes: Iterable[int]) -> Whole:
    """Start of each of several consecutive ranges of given sizes, and the end of the last range."""
    return np.concatenate([[0], np.cumsum(_whole(sizes))]).astype(np.int32)
