"""What a trial gets: logs, a model, a controller file, and the truth to judge by."""

from dataclasses import dataclass, field

import numpy as np

from .joint import Joint
from .simulate import motion


@dataclass(frozen=True)
class Recording:
    """One log of target and position."""

    name: str
    time: np.ndarray  # s, uniform
    target: np.ndarray  # rad, as commanded at each sample; holds until the next
    position: np.ndarray  # rad, as the encoder reads it
    metadata: dict[str, float]  # figures of this log, such as {"kp": 3.0}


@dataclass(frozen=True)
class Plant:
    """A joint with one hidden effect, and what its user has of it."""

    kind: str  # what is hidden, a key of KINDS
    hidden: dict[str, float]  # its numbers
    own: str  # effect of the joint besides, "" for none
    mjcf: str  # one hinge "j" without friction, damping and actuator
    controller: dict[str, object]  # what the user's controller file says
    recordings: list[Recording]
    held_out: set[str]  # names of the logs kept out
    joint: Joint = field(repr=False)  # the truth

    def kp(self, metadata: dict[str, float]) -> float:
        """Gain of a log in units of the output per rad."""
        stated = self.controller["kp"]
        unit = float(self.controller.get("gain_unit", 1.0))
        return unit * (metadata["kp"] if isinstance(stated, str) else float(stated))

    def position(self, recording: Recording, start: tuple[float, float]) -> np.ndarray:
        """True motion, not quantised, rad, at the samples of `recording`'s target.

        `start` is position, rad, and velocity, rad/s, at the first sample. Friction and firmware
        hold then what they hold after the joint came to rest at the first target.
        """
        period = float(recording.time[-1] - recording.time[0]) / (recording.time.size - 1)
        kp = self.kp(recording.metadata)
        return motion(self.joint, kp, recording.target, period, start)[1][:, 0]
