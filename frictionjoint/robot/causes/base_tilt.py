"""A base that is tilted with respect to the model: another direction of gravity."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from scipy.spatial.transform import Rotation

from frictionjoint.arrays import Array
from frictionjoint.robot.causes.cause import FREE, Cause
from frictionjoint.robot.corrections import Corrections


@dataclass(frozen=True)
class BaseTilt(Cause):
    """Numbers: the rotation of gravity about two axes perpendicular to it, rad."""

    name: ClassVar[str] = "base-tilt"
    steps = np.full(2, 1e-4)
    bounds = (FREE, FREE)

    def applied(self, state: Corrections, x: Array) -> Corrections:
        axes = _across(state.gravity)
        turned = Rotation.from_rotvec(x @ axes).apply(state.gravity)
        return replace(state, gravity=np.asarray(turned))

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """Angle of the tilt, and the components of gravity."""
        g = self.applied(state, x).gravity
        return {"angle": (float(np.linalg.norm(x)), "rad")} | {
            f"gravity_{axis}": (float(c), "m/s^2") for axis, c in zip("xyz", g, strict=True)
        }


def _across(g: Array) -> Array:
    """Two unit vectors perpendicular to another one, as rows."""
    first = np.cross(g, np.eye(3)[int(np.argmin(np.abs(g)))])
    first /= np.linalg.norm(first)
    second = np.cross(g, first)
    return np.array([first, second / np.linalg.norm(second)])
