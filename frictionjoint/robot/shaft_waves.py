"""Waves of a shaft's friction level, from the spectrum of the residuals of two joints.

Teeth and bearings that turn with the motor make its friction vary with its angle, and both joints
that turn it show this.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from frictionjoint.arrays import Array
from frictionjoint.identify.basis import lengths, orthonormal
from frictionjoint.identify.search import FEWEST_WAVES
from frictionjoint.robot.causes.cause import Cause, Found
from frictionjoint.robot.causes.gear_coupling import GearCoupling
from frictionjoint.robot.columns import law_columns
from frictionjoint.robot.corrections import Shaft
from frictionjoint.robot.joint import FittedJoint


def with_waves(joints: Sequence[FittedJoint], found: Found) -> list[Cause]:
    """Forms of the model's gear couplings with a wave of the friction level, one each."""
    forms: list[Cause] = []
    for cause in found.causes:
        if isinstance(cause, GearCoupling) and not cause.shaft.waves:
            shaft = cause.shaft
            line = _strongest([_Part(j, shaft) for j in joints if j.name in shaft.joints])
            if line:
                forms.append(GearCoupling(replace(shaft, waves=line[0]), line[1]))
    return forms


class _Part:
    """Residual of a joint with its law projected out, in units of its rms."""

    def __init__(self, joint: FittedJoint, shaft: Shaft) -> None:
        self.joint, self.shaft = joint, shaft
        self.unit = joint.fit.weight / joint.left
        law = law_columns(joint)
        self.base = orthonormal(law / lengths(law))
        e = joint.residual * self.unit
        self.residual = e - self.base @ (self.base.T @ e)

    @property
    def turns(self) -> Array:
        """Rotation of the shaft, on the kept samples of all logs, rad, shape (n,)."""
        pairs = zip(self.joint.alongs, self.joint.prepared.segments, strict=True)
        return np.concatenate([s.balanced(a.turn(self.shaft)[0]) for a, s in pairs])

    def wave(self, waves: float) -> Array:
        """Columns of sine and cosine, the law projected out, shape (n, 2)."""
        shaft = replace(self.shaft, waves=waves)
        X = np.concatenate([a.kept_shaft(shaft)[:, -2:] for a in self.joint.alongs])
        X = X * self.unit[:, None]
        return np.asarray(X - self.base @ (self.base.T @ X))


def _strongest(parts: Sequence[_Part]) -> tuple[float, float] | None:
    """The wave that explains most, 1/rad, and the number of lines searched; None if none fits."""
    turns = np.concatenate([p.turns for p in parts])
    span = float(np.ptp(turns))
    # periods are counted over where the shaft mostly is, as those of a joint
    usual = float(np.subtract(*np.quantile(turns, (0.95, 0.05))))
    step = float(np.median(np.abs(np.diff(parts[0].turns))))
    if usual <= 0.0 or step <= 0.0:
        return None
    # two lines for each wave over the span, up to one in two samples at the usual speed
    line = np.pi / span
    lines = np.arange(int(2.0 * FEWEST_WAVES * span / usual), span / step) * line
    if not len(lines):
        return None

    def left(waves: float) -> float:
        A, b = np.zeros((2, 2)), np.zeros(2)
        for part in parts:
            X = part.wave(waves)
            A, b = A + X.T @ X, b + X.T @ part.residual
        return -float(b @ np.linalg.lstsq(A, b, rcond=1e-9)[0])

    best = float(lines[int(np.argmin([left(x) for x in lines.tolist()]))])
    near = minimize_scalar(left, bounds=(best - line, best + line), method="bounded")
    return float(near.x), max(1.0, len(lines) / 2.0)
