"""Effects common to all joints of a robot, with one cause: a temperature, a supply.

In each joint such an effect has the same coefficients relative to that joint's friction level and
viscosity, so a change too small to detect in one joint can be detected in all together.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.columns import columns_of, signals_of
from frictionjoint.diagnose.library import testable
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.result import Estimate
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.robot.joint import FittedJoint


@dataclass(frozen=True)
class Common:
    """One effect of all joints: coefficients relative to each joint's own friction level or
    viscosity, with their covariance."""

    term: EffectTerm
    joints: tuple[str, ...]
    coefficients: Array
    covariance: Array

    @property
    def parameters(self) -> dict[str, Estimate]:
        """Coefficients with their standard errors, and the shape numbers."""
        effect, errors = self.term.effect, np.sqrt(np.diag(self.covariance))
        found = {
            name: Estimate(float(x), float(s) if np.isfinite(s) else None, "1")
            for name, x, s in zip(effect.coefficients, self.coefficients, errors, strict=True)
        }
        shape = zip(effect.shape, self.term.shape, effect.shape_units, strict=True)
        return found | {name: Estimate(x, None, unit) for name, x, unit in shape}


def common_terms(joints: Sequence[FittedJoint]) -> list[EffectTerm]:
    """Effects on the grid that the logs of all joints can test."""
    if len(joints) < 2:
        return []
    signals = [np.concatenate(signals_of(j.prepared, j.fit)) for j in joints]
    found = []
    # one cause for all joints: heat, or the scale of their torques
    for effect in (e for e in CATALOGUE if e.slow or e.scales):
        if not all(testable(j.prepared, effect, x) for j, x in zip(joints, signals, strict=True)):
            continue
        first, *others = (effect.shapes(x) for x in signals)
        # grids of two joints differ a little, because each joint's logs begin and end with its own
        # motion
        found += [
            EffectTerm(effect, shape)
            for shape in first
            if all(any(np.allclose(shape, s, rtol=0.1) for s in grid) for grid in others)
        ]
    return found


def common_columns(joint: FittedJoint, terms: Sequence[EffectTerm]) -> list[Array]:
    """Columns of each term per unit of its relative coefficients, each (n, k)."""
    signals = signals_of(joint.prepared, joint.fit)
    level, viscous = joint.levels
    own = {"T": level, "T s/x": viscous, "1": 1.0}
    return [
        columns_of(joint.prepared, signals, t) * [own[unit] for unit in t.effect.units]
        for t in terms
    ]
