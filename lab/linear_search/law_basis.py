"""Any friction law as columns: elastic-plastic elements of fixed reaches, times functions of speed.

Elements in parallel have the memory of presliding (Prandtl 1928; Iwan 1966), and a function of
speed times an element is what sliding does to it. A law is a sum of such columns, so that it is
fitted by linear least squares. It serves to take a law out of a residual, not to predict.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import Q, V
from frictionjoint.identify.law_basis import element_reaches
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.smooth import elastic_plastic

# reaches of the elements: how many, and the largest over the travel
_ELEMENTS, _LONGEST = 10, 0.2
# speeds over the top speed at which the level has fallen to 1/e of what it falls by
_FALLS = (0.005, 0.02, 0.06)
# speeds over the top speed at which friction that never sticks turns round
_TURNS = (0.001, 0.004, 0.015)
# standard deviations of the prior over the level: of elements, of functions of speed, of what
# differs by direction, of what a log began with; viscous friction at top speed
_OF_ELEMENTS, _OF_SPEED, _BY_DIRECTION, _BEGUN, _VISCOUS = 1.0, 0.5, 0.3, 0.5, 50.0


def elements(q: Array, reaches: Array, begun: float) -> Array:
    """Torque of elements of level 1 along a motion, shape (n, k).

    Args:
        q: position, shape (n,). reaches: displacement to slipping from rest, shape (k,).
        begun: torque of all elements at the first sample, -1, 0 or 1.
    """
    # a motion that comes from far enough away has loaded all of them
    before = q[0] - begun * float(reaches.max())
    return elastic_plastic(np.append(before, q), np.ascontiguousarray(reaches))[1:]


@dataclass(frozen=True)
class LawBasis:
    """Columns that stand for the friction law of one joint in some logs."""

    prepared: Prepared

    @property
    def viscous(self) -> bool:
        """Whether viscous friction is one of them: a back-EMF is an effect, and looks the same."""
        return self.prepared.let_go or not self.prepared.voltage_driven

    @cached_property
    def reaches(self) -> Array:
        """Of the elements, rad (m), shape (k,)."""
        return element_reaches(self.prepared, _ELEMENTS, _LONGEST)

    @cached_property
    def along(self) -> list[Array]:
        """The law's columns along each log: elements, times falls with speed, and the velocity.

        Shape (n, `size`) each.
        """
        found = []
        for s in self.prepared.segments:
            z = elements(s.signals[:, Q], self.reaches, 0.0)
            falls = [z * fall for fall in self._falls(s)]
            velocity = [s.signals[:, [V]]] if self.viscous else []
            found.append(np.hstack([z, *falls, *velocity]))
        return found

    @cached_property
    def columns(self) -> tuple[Array, Array]:
        """All columns on the kept samples, and the prior's standard deviation of each over a level.

        The columns of `along` come first. Shapes (n, m) and (m,).
        """
        k = len(self.reaches)
        top = self.prepared.top_speed
        groups = [
            (
                self.kept(self.along),
                [_OF_ELEMENTS] * k
                + [_OF_SPEED] * (k * len(_FALLS))
                + [_VISCOUS / top] * self.viscous,
            ),
            self._each(self._turning, _OF_SPEED),
            self._each(self._turning_by_direction, _BY_DIRECTION),
            self._each(self._falling_by_direction, _BY_DIRECTION),
        ]
        begun = self.kept([self._begun(s) for s in self.prepared.segments])
        counts = [int(s.kept.sum()) for s in self.prepared.segments]
        log = np.repeat(np.arange(len(counts)), counts)
        groups += [
            (begun * (log == i)[:, None], [_BEGUN] * begun.shape[1]) for i in range(len(counts))
        ]
        X = np.hstack([x for x, _ in groups])
        return X, np.concatenate([sd for _, sd in groups])

    @property
    def size(self) -> int:
        """How many columns of `along` there are."""
        return len(self.reaches) * (1 + len(_FALLS)) + self.viscous

    def kept(self, along: list[Array]) -> Array:
        """What the balance keeps of columns along each log, shape (n, m)."""
        return np.concatenate(
            [s.lowpass(x)[s.kept] for s, x in zip(self.prepared.segments, along, strict=True)]
        )

    def at_rest(self, coefficients: Array) -> Array:
        """Levels of the elements at rest, shape (k,)."""
        k = len(self.reaches)
        return np.asarray(coefficients[: k * (1 + len(_FALLS))].reshape(-1, k).sum(axis=0))

    def level_at(self, coefficients: Array, speed: Array) -> Array:
        """Level of the elements in sliding at some speeds, rad/s (m/s), shape of `speed`."""
        k = len(self.reaches)
        parts = coefficients[: k * (1 + len(_FALLS))].reshape(-1, k).sum(axis=1)
        falls = [np.exp(-speed / (x * self.prepared.top_speed)) for x in _FALLS]
        return np.asarray(parts[0] + sum(c * f for c, f in zip(parts[1:], falls, strict=True)))

    def _each(self, of_log: Callable[[Segment], Array], spread: float) -> tuple[Array, list[float]]:
        x = self.kept([of_log(s) for s in self.prepared.segments])
        return x, [spread] * x.shape[1]

    def _falls(self, s: Segment) -> list[Array]:
        speed = np.abs(s.signals[:, V, None]) / self.prepared.top_speed
        return [np.exp(-speed / fall) for fall in _FALLS]

    def _turning(self, s: Segment) -> Array:
        """Friction that follows the velocity and never sticks, and its fall with speed."""
        v = s.signals[:, V, None] / self.prepared.top_speed
        turned = [np.tanh(v / turn) for turn in _TURNS]
        return np.hstack([*turned, *(t * f for t in turned for f in self._falls(s)[1:])])

    def _turning_by_direction(self, s: Segment) -> Array:
        v = s.signals[:, V, None] / self.prepared.top_speed
        return np.hstack([np.abs(np.tanh(v / _TURNS[1])) * f for f in self._falls(s)[1:]])

    def _falling_by_direction(self, s: Segment) -> Array:
        """A fall with speed that is not the same in both directions."""
        z = np.abs(elements(s.signals[:, Q], self.reaches[[3]], 0.0))
        return np.hstack([z * f for f in self._falls(s)])

    def _begun(self, s: Segment) -> Array:
        """What the elements may have held when a log began, shape (n, m)."""
        q = s.signals[:, Q]
        some = self.reaches[2::2]
        return (elements(q, some, 1.0) - elements(q, some, -1.0)) / 2.0
