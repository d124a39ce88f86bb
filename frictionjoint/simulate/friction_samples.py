"""Friction drawn for each episode from the samples of a report (domain randomisation)."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import mujoco
import numpy as np

from frictionjoint.errors import ModelError
from frictionjoint.files import read_samples
from frictionjoint.joint_friction import JointFriction
from frictionjoint.parameters import Friction
from frictionjoint.simulate.set_parameters import set_parameters

Samples = Mapping[str, Sequence[Friction | JointFriction] | str | Path]
"""By name of the joint: ``report.samples(n)``, or the file that ``frictionjoint sample`` writes."""


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
