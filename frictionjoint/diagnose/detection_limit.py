"""Detection limit: the smallest torque of an effect that the logs would have shown."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy.special import chdtri

from frictionjoint.arrays import root_mean_square
from frictionjoint.decisions import APART, LEAST_MOVED, SMALLEST_GAIN
from frictionjoint.diagnose.candidate import Candidate
from frictionjoint.diagnose.gram import screen
from frictionjoint.identify.blocks import Blocks, correlation_time
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.segment import Prepared


@dataclass(frozen=True)
class Smallest:
    """The smallest effect of one kind that the logs would have shown, rms N m of its torque.

    It is infinite beyond the measured torque, because the model can imitate the effect.
    """

    name: str
    least: float  # for the shape that is easiest to detect
    most: float  # for the hardest


@dataclass(frozen=True)
class DetectionLimit:
    """The smallest detectable effect, of any kind and of each."""

    torque: float  # rms, N m, of an effect that the law cannot imitate, in motion
    duration: float  # of the logs, s
    needed: float  # s of such motion that would reveal an effect that makes half of the residual
    of_each: tuple[Smallest, ...]  # for every effect that the model lacks, easiest to detect first

    @property
    def too_short(self) -> bool:
        """Whether even an effect that makes half of the residual could not have been found."""
        return self.needed > self.duration

    def over(self, gain: float) -> Self:
        """The same with torques divided by the gain of the drive."""
        each = tuple(Smallest(x.name, x.least / gain, x.most / gain) for x in self.of_each)
        return replace(self, torque=self.torque / gain, of_each=each)


def detection_limit(
    prepared: Prepared, fitted: Fit, chance: float, blocks: Blocks, candidates: Sequence[Candidate]
) -> DetectionLimit:
    """The smallest effect that the logs could have shown.

    An effect that makes a fraction g of the residual scores about B g / (1 - g) on B equal blocks,
    which must exceed the score by chance over the whole family. Only the part of its torque that
    the law and the other effects cannot imitate counts, and samples count by their weight.

    Args:
        chance: score that the best of the family exceeds by chance in one case of twenty.
        blocks, candidates: of the fit.
    """
    e = fitted.residual * fitted.weight
    longest = max(correlation_time(e[fitted.log_index == i]) for i in np.unique(fitted.log_index))
    count = max(2.0, len(e) / (2.0 * longest))
    needed = float(chdtri(1, np.exp(-chance))) if chance > 0.0 else 0.0
    # an effect must exceed chance, a fraction of the residual, and the error of a law
    fraction = max(needed / (needed + count), SMALLEST_GAIN)
    left = fitted.drive_rms * fitted.error_unit
    friction = root_mean_square(fitted.friction * fitted.weight)
    duration = sum(len(s.drive) * s.dt for s in prepared.segments)
    enough = needed * (1.0 - APART) / APART
    torque = max(float(np.sqrt(fraction / (1.0 - fraction))) * left, LEAST_MOVED * friction)
    named = [c for c in candidates if not c.unnamed]
    sizes: dict[str, list[float]] = {}
    for c, size in zip(named, smallest(fitted, blocks, named, torque), strict=True):
        shown = size < fitted.target_rms
        sizes.setdefault(c.term.name, []).append(size if shown else np.inf)
    each = sorted((Smallest(n, min(x), max(x)) for n, x in sizes.items()), key=lambda x: x.least)
    return DetectionLimit(torque, duration, duration * enough / count, tuple(each))


def smallest(
    fitted: Fit, blocks: Blocks, candidates: Sequence[Candidate], torque: float
) -> list[float]:
    """rms torque, N m, of each candidate of which the model cannot imitate a given part.

    Args:
        torque: weighted rms of that part, N m, see `DetectionLimit`.
    """
    found = screen(fitted, blocks, candidates)
    sizes = []
    for c, at in zip(candidates, found.candidates, strict=True):
        weighted = np.linalg.norm(c.columns * fitted.weight[:, None], axis=0)
        seen = weighted * np.linalg.norm(found.tested[:, at[~found.begun[at]]], axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            sizes.append(torque * float(np.max(np.linalg.norm(c.columns, axis=0) / seen)))
    return sizes
