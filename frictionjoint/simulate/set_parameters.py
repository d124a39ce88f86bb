"""Change the friction of a compiled model, also at random per episode, and reset its state.

set_parameters(model, "elbow", parameters)      # e.g. of another sample
data.qpos[:] = reference_state
forget(model, data)                             # the change of position was no motion
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import mujoco
import numpy as np

from frictionjoint.arguments import require_data, require_model
from frictionjoint.arrays import Array
from frictionjoint.errors import ModelError
from frictionjoint.files import read_samples
from frictionjoint.joint_friction import JointFriction, SimulatedEffect
from frictionjoint.laws import require_parameters
from frictionjoint.parameters import Friction
from frictionjoint.simulate.block import COUNT, EFFECTS, HEAD, MAGIC, ROW, rows_of_block
from frictionjoint.simulate.carrier import heating_first, read_effects, resolve
from frictionjoint.simulate.row import BASE, FRONT

Samples = Mapping[str, Sequence[Friction | JointFriction] | str | Path]
"""By name of the joint: ``report.samples(n)``, or the file that ``frictionjoint sample`` writes."""


def set_parameters(model: mujoco.MjModel, joint: str, parameters: Friction | JointFriction) -> None:
    """Change the friction parameters of a joint in a compiled model.

    Torque and memory of existing data come within the new breakaway torques at the next evaluation.
    Effects that act through the model itself (elasticity, backlash, delays of sensors) stay as they
    were compiled.

    Args:
        model: with friction at the joint; changed in place.
        parameters: of the same law with as many knots, in N m and rad (N and m for a slide); or a
            `JointFriction` of ``report.samples`` with the same effects as the joint. Without
            effects, those of the model stay.
    Raises:
        ModelError: no friction at the joint, another law, another number of knots or other effects.
        TypeError: no MjModel, or no friction parameters.
    """
    require_model(model, "set_parameters")
    law = parameters.parameters if isinstance(parameters, JointFriction) else parameters
    require_parameters(law, "set_parameters")
    found = resolve(model)
    write_parameters(model.numeric_data, found[require_joint(found, joint)], parameters, joint)


def write_parameters(
    numeric_data: Array, block: int, parameters: Friction | JointFriction, joint: str
) -> int:
    """Change a joint's friction in a model's numbers, or in those of one simulation of a batch.

    Args:
        numeric_data: ``model.numeric_data``, or a row of ``batch.expand("numeric_data")``;
            changed in place, only if all fits.
        block: where the joint's block begins. parameters: as `set_parameters` takes them.
    Returns:
        where in ``numeric_data`` the numbers end that were written from block + HEAD on.
    Raises:
        ModelError: as `set_parameters`.
    """
    if numeric_data[block] != MAGIC:
        raise ModelError(
            f"joint {joint!r} has no friction at {block}: attach the model before you make a batch"
        )
    friction = parameters if isinstance(parameters, JointFriction) else JointFriction(parameters)
    numbers = friction.parameters.pack()
    first, count = block + HEAD, int(numeric_data[block + COUNT])
    room = int(numeric_data[block + EFFECTS]) - HEAD
    if len(numbers) != room or numbers[0] != numeric_data[first]:
        raise ModelError(
            f"joint {joint!r}: the new law has {len(numbers)} numbers, the model's has {room}: "
            "keep law and number of knots, or install and compile"
        )
    if isinstance(parameters, JointFriction):
        given = heating_first(friction.effects)
        there = read_effects(
            numeric_data[first + room : first + count], f"friction of joint {joint!r}"
        )
        if [e.effect for e in given] != [e.effect for e in there]:
            raise ModelError(
                f"joint {joint!r} has the effects {_names(there)}, not {_names(given)}: give "
                "those that were installed, in their order, or install and compile"
            )
        numbers = np.concatenate([numbers, [len(given)], *(e.pack() for e in given)])
    end = first + len(numbers)
    numeric_data[first:end] = numbers
    return end


def forget(model: mujoco.MjModel, data: mujoco.MjData, joint: str | None = None) -> None:
    """Reset the friction state of data: at rest and never moved.

    Call it after setting positions by hand: otherwise a change of ``qpos`` is a motion for the
    friction and loads the presliding springs. The memory of effects (temperatures, warmth) is reset
    too; ``mj_resetData`` does the same for the whole state.

    Args:
        model: with friction. data: of that model, changed in place.
        joint: a single joint; None for all.
    Raises:
        ModelError: no friction in the model or at the joint.
        TypeError: no MjModel or MjData.
    """
    require_data(data, model, "forget")
    found = resolve(model)
    for name in found if joint is None else [require_joint(found, joint)]:
        block = model.numeric_data[found[name] :]
        row = int(block[ROW])
        size = rows_of_block(block[: HEAD + int(block[COUNT])])
        # what was written into the mass matrix is still there
        data.userdata[row : row + BASE] = 0.0
        data.userdata[row + FRONT : row + size] = 0.0


class FrictionSamples:
    """Parameter sets of joints, of which each episode draws one per joint.

    Raises:
        ModelError: no samples of a joint. ParameterError: a file that cannot be read.
    """

    def __init__(self, samples: Samples) -> None:
        self._samples = {
            joint: read_samples(Path(given)) if isinstance(given, str | Path) else tuple(given)
            for joint, given in samples.items()
        }
        for joint, each in self._samples.items():
            if not each:
                raise ModelError(f"joint {joint!r} has no samples: give at least one")

    def draw(self, model: mujoco.MjModel, random: np.random.Generator) -> dict[str, int]:
        """Give each joint of a compiled model one of its samples; returns its number, by joint.

        Raises:
            ModelError: see `set_parameters`.
        """
        drawn = {joint: int(random.integers(len(x))) for joint, x in self._samples.items()}
        for joint, number in drawn.items():
            set_parameters(model, joint, self._samples[joint][number])
        return drawn


def require_joint(found: dict[str, int], joint: str) -> str:
    """The name of a joint; ModelError if it is none of those with friction."""
    if joint not in found:
        raise ModelError(
            f"joint {joint!r} has no friction: choose from {', '.join(found) or 'none'}"
        )
    return joint


def _names(effects: Sequence[SimulatedEffect]) -> str:
    return ", ".join(e.effect.name for e in effects) or "none"
