"""What the stacks of a simulated joint hold, and what they had to give up."""

from dataclasses import dataclass

import mujoco

from frictionjoint.arguments import require_data, require_model
from frictionjoint.law.memory import BOUND, FORGOTTEN, N_MAX, N_MIN
from frictionjoint.parameters import FrictionParameters
from frictionjoint.simulate.carrier import ROW, read_friction, resolve
from frictionjoint.simulate.row import FRONT


@dataclass(frozen=True)
class Remembered:
    """Memory of one joint.

    Attributes:
        minima: number of extrema on the stack m, its limit not counted.
        maxima: the same on M.
        forgotten: pairs of extrema given up for want of room since the joint began to move.
        error: N m; the hysteresis torque is at most this far from that of stacks without end: the
            sum of the gaps that the given-up pairs left, and never more than Fs_pos + Fs_neg.
    """

    minima: int
    maxima: int
    forgotten: int
    error: float


def remembered(model: mujoco.MjModel, data: mujoco.MjData) -> dict[str, Remembered]:
    """Memory of every joint with the integrated law, as of the last committed step.

    Args:
        model: attached, or from `load_model`. data: of that model.
    """
    require_model(model, "remembered")
    require_data(data, "remembered", model)
    found = {}
    addresses = resolve(model)
    for name, carried in read_friction(model).items():
        law = carried.parameters
        if not isinstance(law, FrictionParameters):
            continue
        row = int(model.numeric_data[addresses[name] + ROW]) + FRONT
        X = data.userdata[row:]
        found[name] = Remembered(
            minima=max(0, int(X[N_MIN]) - 1),
            maxima=max(0, int(X[N_MAX]) - 1),
            forgotten=int(X[FORGOTTEN]),
            error=min(float(X[BOUND]), law.Fs_pos + law.Fs_neg),
        )
    return found
