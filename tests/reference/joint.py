"""A joint stepped by hand: the kernel's row with a head of its own, copied at will."""

import math

import numpy as np

from frictionjoint.law.kernel import commit, row_size, start_row, step_row
from frictionjoint.law.memory import FB, FH, N_MAX, N_MIN


class Joint:
    """The kernel's state after a motion; torques in N m, displacements in rad."""

    def __init__(self, parameters):
        self.P = parameters.pack()
        self.X = np.zeros(row_size(self.P, 0))
        start_row(self.P, 0, self.X, 0)

    def copy(self) -> "Joint":
        """The same state, moved apart from this one."""
        other = object.__new__(Joint)
        other.P, other.X = self.P, self.X.copy()
        return other

    def move(self, dq: float, v: float = 1e-3) -> float:
        """Step by dq at the speed |v|; returns F."""
        F = step_row(self.P, 0, self.X, 0, dq, abs(dq / v) or 1.0, math.copysign(v, dq))
        commit(self.P, 0, self.X, 0)
        return F

    def move_to_torque(self, torque: float, v: float = 1e-3, reach: float = 1e6) -> float:
        """Move towards the torque until Fh is as near to it as doubles allow; returns the way.

        The direction follows from the torque; bisection in the displacement, `reach` at most.
        """
        s = 1.0 if torque > self.Fh else -1.0
        low, high = 0.0, 1e-12
        while self._after(s * high, v) * s < torque * s:
            low, high = high, 2.0 * high
            if high > reach:
                raise ValueError(f"Fh never reaches {torque}")
        for _ in range(200):
            middle = 0.5 * (low + high)
            if middle in (low, high):
                break
            if self._after(s * middle, v) * s < torque * s:
                low = middle
            else:
                high = middle
        self.move(s * high, v)
        return high

    def _after(self, dq: float, v: float) -> float:
        trial = self.copy()
        trial.move(dq, v)
        return trial.Fh

    @property
    def Fh(self) -> float:
        """Hysteresis torque."""
        return float(self.X[FH])

    @property
    def base(self) -> float:
        """Base of the present curve."""
        return float(self.X[FB])

    @property
    def extrema(self) -> tuple[int, int]:
        """Sizes of the stacks, the limits included."""
        return int(self.X[N_MIN]), int(self.X[N_MAX])
