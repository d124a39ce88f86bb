"""What a log's controller made of its commands, as a fit sees it: behind the filter of the motion.

A fit of a reconstructed drive can ask what another controller would have made (a dead band, a
lower limit): an effect of the drive changes the drive itself.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.reconstruct import Commands
from frictionjoint.measured.derivatives import uniform
from frictionjoint.measured.lowpass import LowPass

# from block and delay of a controller to those of another one
Change = Callable[[Array, float], tuple[Array, float]]


@dataclass(frozen=True)
class Commanded:
    """Commands of a log and how its drive gets to the grid of a fit.

    Attributes:
        grid: s, uniform times of the samples, shape (m,). filters: passed in turn.
    """

    commands: Commands
    grid: Array
    filters: tuple[LowPass, ...]

    def drive(self, changes: Sequence[Change]) -> Array:
        """Drive that the controller makes with some changes, one after the other, shape (n,)."""
        block, delay = self.commands.block.copy(), self.commands.delay
        for change in changes:
            block, delay = change(block, delay)
        x = uniform(self.commands.time, self.commands.mean_drive(block, delay), self.grid)
        for smooth in self.filters:
            x = smooth(x)
        return np.asarray(x)

    def thinned(self, smooth: LowPass) -> "Commanded":
        """On a coarser grid, behind one filter more."""
        return replace(self, filters=(*self.filters, smooth))
