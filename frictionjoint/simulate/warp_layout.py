"""Addresses of joints with friction, and of their motors, in the arrays of the Warp kernels."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
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
from frictionjoint.simulate.motor_demand import gives_less, motors_of
from frictionjoint.simulate.set_parameters import write_parameters

Whole = NDArray[np.int32]


@dataclass(frozen=True)
class Layout:
    """Addresses for n joints with friction.

    Attributes:
        joints: names, shape (n,); all other arrays have the same order.
        numbers: the model's numerics; ROW in each block is the start of the joint's row of
            `simulate.row` in the state of a world.
        addresses: of the blocks in `numbers`, shape (n,).
        read: indices of the numbers that the kernels read: each block without its integers.
        blocks: start of each block among the numbers that the kernels read, shape (n,).
        rows: start of each joint's numbers in the state of a world, shape (n,).
        room: length of the state of a world. header: length of the longest header of a law.
        loads: index of the first effect that depends on the load, or -1, shape (n,).
        motor_first, motors: actuators of joints that saturate; those of the i-th joint are
            motors[motor_first[i]:motor_first[i + 1]].
        has_effects, has_loads: whether any joint has effects, or effects that depend on the load.
    """

    joints: tuple[str, ...]
    numbers: Array
    addresses: Whole
    read: NDArray[np.int64]
    blocks: Whole
    rows: Whole
    room: int
    header: int
    loads: Whole
    motor_first: Whole
    motors: Whole
    has_effects: bool

    @property
    def has_loads(self) -> bool:
        return bool(self.loads.max() >= 0)


def layout(model: mujoco.MjModel, found: Mapping[str, int], front: int) -> Layout:
    """Layout of a model with friction blocks.

    Args:
        found: address of each block in the model's numerics, by joint name.
        front: length of the part of a joint's state before its row.
    """
    numbers = np.array(model.numeric_data)
    addresses = _whole(found.values())
    sizes = [front + rows_of_block(numbers[at:].tolist()) for at in addresses]
    rows = _starts(sizes)
    numbers[addresses + ROW] = rows[:-1] + front
    effects = addresses + _whole(numbers[addresses + EFFECTS])
    lengths = HEAD + _whole(numbers[addresses + COUNT])
    joints = _whole(numbers[addresses + JOINT])
    motors = [
        motors_of(model, int(joint)) if gives_less(numbers, int(at)) else []
        for joint, at in zip(joints, effects, strict=True)
    ]
    return Layout(
        joints=tuple(found),
        numbers=numbers,
        addresses=addresses,
        read=np.concatenate(
            [np.arange(at, at + n) for at, n in zip(addresses, lengths, strict=True)]
        ),
        blocks=_starts(lengths)[:-1],
        rows=rows[:-1],
        room=int(rows[-1]),
        header=max(int(header_size(numbers, at + HEAD)) for at in addresses.tolist()),
        loads=_whole(asks_for_load(numbers, int(at)) for at in effects),
        motor_first=_starts([len(own) for own in motors]),
        motors=_whole(i for own in motors for i in own),
        has_effects=bool(np.any(numbers[effects] > 0.0)),
    )


def block_with(made: Layout, number: int, friction: Friction | JointFriction) -> Array:
    """Numbers of a joint's block with different friction parameters.

    Args:
        friction: the new friction. For a `Friction`, which has no effects, the result ends before
            the numbers of the effects.
    Raises:
        ModelError: the law, the number of knots, or the effects differ from those of the joint.
    """
    numbers, at = made.numbers.copy(), int(made.addresses[number])
    return numbers[at : write_parameters(numbers, at, friction, made.joints[number])]


def _whole(numbers: Iterable[Any]) -> Whole:
    return np.array(list(numbers), dtype=np.int32)


def _starts(sizes: Iterable[int]) -> Whole:
    """Start of each of several consecutive ranges of given sizes, and the end of the last range."""
    return np.concatenate([[0], np.cumsum(_whole(sizes))]).astype(np.int32)
