"""Addresses of the joints and motors of a model with friction in the arrays of its kernels."""

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
from frictionjoint.simulate.carrier import COUNT, EFFECTS, HEAD, JOINT, ROW, rows_of_block
from frictionjoint.simulate.motor_demand import gives_less, motors_of
from frictionjoint.simulate.set_parameters import write_parameters
from frictionjoint.simulate.with_effects import asks_for_load

Whole = NDArray[np.int32]


@dataclass(frozen=True)
class Layout:
    """Of n joints with friction.

    Attributes:
        joints: names, shape (n,), in the order of everything here.
        numbers: the model's numerics; in each block ROW is where the joint's row of `simulate.row`
            begins in a world's state.
        addresses: of the blocks in `numbers`, shape (n,).
        read: indices of the numbers that the kernels read, each block without the pieces that
            follow it. blocks: where each begins in those, shape (n,).
        rows: where each joint's numbers begin in a world's state, shape (n,). room: of all rows.
            header: numbers of the longest header of a law.
        loads: number of the first effect that looks at the load, or -1, shape (n,).
        motor_first, motors: actuators of joints that saturate, those of the i-th joint from
            motor_first[i] to motor_first[i + 1].
        has_effects, has_loads: whether any joint has.
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
    """Of a model whose friction blocks are at `found`, by name of the joint.

    Args:
        front: numbers that each joint keeps before its row.
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
    """Numbers of a joint's block with another friction: without effects, those before them.

    Raises:
        ModelError: another law, another number of knots, or other effects than the joint has.
    """
    numbers, at = made.numbers.copy(), int(made.addresses[number])
    return numbers[at : write_parameters(numbers, at, friction, made.joints[number])]


def _whole(numbers: Iterable[Any]) -> Whole:
    return np.array(list(numbers), dtype=np.int32)


def _starts(sizes: Iterable[int]) -> Whole:
    """Where each begins when they follow one another, and where the last one ends."""
    return np.concatenate([[0], np.cumsum(_whole(sizes))]).astype(np.int32)
