"""Cross-validated score across kinds of motion: the only score of the search."""

from dataclasses import dataclass, field

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.gram import screen
from frictionjoint.diagnose.physical_bounds import impossible
from frictionjoint.identify.blocks import Blocks
from frictionjoint.identify.fit import Fit, unreached
from frictionjoint.identify.rounding import EQUAL


@dataclass(frozen=True)
class Scored:
    """A fit with its score."""

    fit: Fit
    # sum of squares of each block, predicted by effects fitted to other folds, shape (B,)
    squares: Array = field(repr=False)
    # names of effects with a number that the logs push past its physical range
    impossible: frozenset[str] = frozenset()

    @property
    def total(self) -> float:
        """Sum over all blocks, in squares of `Fit.error_unit`."""
        return float(self.squares.sum())

    def gain(self, other: "Scored") -> float:
        """Fraction of another model's sum of squares that this one removes."""
        return 1.0 - self.total / other.total if other.total > 0.0 else 0.0

    def moved(self, other: "Scored") -> float:
        """rms of the torque by which this model improves on another, over that of friction."""
        f, less = self.fit, max(0.0, other.total - self.total)
        friction = float(np.sum((f.friction * f.weight) ** 2)) / f.error_unit**2
        return float(np.sqrt(less / friction)) if friction else 0.0

    def of_drive(self, other: "Scored") -> float:
        """The rms improvement over another model, relative to the rms of the drive."""
        f = self.fit
        nearer = max(0.0, other.total - self.total) / len(f.residual)
        return float(np.sqrt(nearer)) * f.error_unit / f.target_rms

    def better(self, other: "Scored", errors: float = 1.0) -> bool:
        """Whether it predicts better by more than some paired standard errors over blocks."""
        difference = other.squares - self.squares
        spread = float(np.std(difference)) * np.sqrt(len(difference))
        # models that are one in all but name differ by rounding, and so does its spread
        return bool(difference.sum() > max(errors * spread, EQUAL * other.total))


def scored(fitted: Fit, blocks: Blocks) -> Scored:
    """A fit's score, to first order in the change of its effects when a fold is left out."""
    found = screen(fitted, blocks)
    # in the units in which fits are made, where an effect may change the gain
    squares, _ = found.held_out(found.terms)
    squares += np.bincount(blocks.of_sample, unreached(fitted), blocks.count)
    beyond = impossible(fitted, blocks)
    unit = fitted.error_unit**2
    return Scored(fitted, squares / unit, beyond)
