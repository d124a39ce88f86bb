"""Content of the memory stacks of a simulated joint, and the removed extrema."""

from dataclasses import dataclass

import mujoco

from frictionjoint.arguments import require_data
from frictionjoint.law.memory import BOUND, FORGOTTEN, N_MAX, N_MIN
from frictionjoint.parameters import FrictionParameters
from frictionjoint.simulate.block import ROW
from frictionjoint.simulate.carrier import read_friction, resolve
from frictionjoint.simulate.row import FRONT


@dataclass(frozen=True)
class Remembered:
    """Memory of one joint.

    Attributes:
        minima: number of extrema on the stack m, without its limit.
        maxima: the same on M.
        forgotten: pairs of extrema removed for lack of room since the joint began to move.
        error: N m; bound on the error of the hysteresis torque compared with unlimited stacks: the
            sum of the gaps that the removed pairs left, and never more than Fs_pos + Fs_neg.
    """

    minima: int
    maxima: int
    forgotten: int
    error: float


def remembered(model: mujoco.MjModel, data: mujoco.MjData) -> dict[str, Remembered]:
    """Memory of each joint with the integrated law, at the last committed step.

    Args:
        model: attached, or from `load_model`. data: of that model.
    """
    require_data(data, model, "remembered")
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
