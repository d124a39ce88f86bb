"""What a model predicts of motion unlike that it was fitted to: the one score of the search."""

from dataclasses import dataclass, field

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.blocks import Blocks
from frictionjoint.diagnose.gram import screen
from frictionjoint.diagnose.possible import impossible
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.reach import unreached
from frictionjoint.identify.rounding import EQUAL


@dataclass(frozen=True)
class Scored:
    """A fit with its squares of each block, predicted by effects fitted to other folds, (B,).

    Attributes:
        noise: of all squares, those that the instruments' noise leaves to a perfect model.
        impossible: names of effects with a number that the logs take beyond what is possible.
    """

    fit: Fit
    squares: Array = field(repr=False)
    noise: float = 0.0
    impossible: frozenset[str] = frozenset()

    @property
    def total(self) -> float:
        """Of all blocks, squares of `Fit.error_unit`."""
        return float(self.squares.sum())

    def gain(self, other: "Scored") -> float:
        """Fraction of another model's squares that this one does not leave."""
        return 1.0 - self.total / other.total if other.total > 0.0 else 0.0

    @property
    def above_noise(self) -> float:
        """rms of the torque left above the noise, over the friction's."""
        return self._over_friction(self.total - self.noise)

    def moved(self, other: "Scored") -> float:
        """rms of the torque by which this model is nearer than another, over the friction's."""
        return self._over_friction(other.total - self.total)

    def of_drive(self, other: "Scored") -> float:
        """The same, over the drive's."""
        f = self.fit
        nearer = max(0.0, other.total - self.total) / len(f.residual)
        return float(np.sqrt(nearer)) * f.error_unit / f.target_rms

    def _over_friction(self, squares: float) -> float:
        f = self.fit
        friction = float(np.sum((f.friction * f.weight) ** 2)) / f.error_unit**2
        return float(np.sqrt(max(0.0, squares) / friction)) if friction else 0.0

    def better(self, other: "Scored", errors: float = 1.0) -> bool:
        """Whether it predicts better by more than some paired standard errors over blocks."""
        difference = other.squares - self.squares
        spread = float(np.std(difference)) * np.sqrt(len(difference))
        # models that are one in all but name differ by rounding, and so does its spread
        return bool(difference.sum() > max(errors * spread, EQUAL * other.total))


def scored(fitted: Fit, blocks: Blocks) -> Scored:
    """A fit's score, to first order in the change of its effects without a fold."""
    found = screen(fitted, blocks)
    # in the units in which fits are made, where an effect may change the gain
    squares, _ = found.held_out(found.terms)
    squares += np.bincount(blocks.of_sample, unreached(fitted), blocks.count)
    noise = float(blocks.floor[fitted.log_index] @ fitted.weight**2)
    beyond = impossible(fitted, blocks)
    unit = fitted.error_unit**2
    return Scored(fitted, squares / unit, noise / unit, beyond)
