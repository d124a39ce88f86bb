"""The shape of a friction law in a fit: its nonlinear numbers, with Fc factored out.

Every law is homogeneous: scaling its levels and stiffnesses scales its torque. So the torque is
``Fc * H(q; shape) + sigma1 dz/dt + sigma2 v`` with H computed at Fc = 1, and only the shape is
searched. `Shape` is the interface that a search needs; here is that of the integrated law.
"""

from abc import abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Protocol, Self, get_args

import numpy as np

from frictionjoint.arrays import Array, Index
from frictionjoint.identify.law_start import LawStart, with_excess
from frictionjoint.law import integrated
from frictionjoint.law.motion import drive_motions
from frictionjoint.law.stribeck import DELTA, FS, VS
from frictionjoint.law.tangents.along import driven_with_tangents
from frictionjoint.law.transition import KNOT_STRIDE
from frictionjoint.parameters import Friction, FrictionParameters, Knots, Variant, Virgin


class Shape(Protocol):
    """A law with Coulomb level 1, searched; implementations say only what is theirs."""

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the numbers in `vector`; `log X` means that the logarithm is searched."""

    @property
    def damped(self) -> bool:
        """Whether the law has the presliding damping sigma1."""

    @property
    def steps(self) -> bool:
        """Whether the law belongs to a simulator, so that the logs contain its time steps."""
        return False

    @property
    def stiffness_assumed(self) -> bool:
        """Whether the stiffness is assumed, see `assumptions.with_assumed_stiffness`."""
        return False

    @property
    def breakaway_assumed(self) -> bool:
        """Whether Fs is assumed, see `assumptions.with_assumed_breakaway`."""

    @property
    def steep_start(self) -> bool:
        """Whether a steep beginning of the transition curve is assumed, see
        `assumptions.with_steep_start`."""
        return False

    def with_assumed_stiffness(self, reach: float) -> Self:
        """This shape with an assumed stiffness, from the shortest presliding length that the logs
        resolve, rad (m), that is not searched; itself if it is searched."""
        return self

    def vector(self) -> Array:
        """The numbers searched, shape (k,)."""

    def moved(self, x: Array) -> Self:
        """The same kind of shape with other numbers."""

    def bounds(self, vmax: float, span: float) -> tuple[Array, Array]:
        """Bounds of the numbers for a joint with speeds up to vmax, rad/s, and a span, rad."""

    def started(self, start: LawStart) -> list[Self]:
        """Starting shapes of this kind."""

    def last_choices(self) -> list[Self]:
        """Variants of this shape that matter only at the start of a log; usually itself."""
        return [self]

    def parameters(self, Fc: float, sigma2: float, sigma1: float = 0.0) -> Friction:
        """The law with a Coulomb level, N m."""

    def with_assumed_breakaway(self, excess: float) -> Self:
        """This shape with Fs = (1 + excess) Fc in both directions, not searched."""

    def hysteresis(self, time: Array, q: Array, edges: Index) -> tuple[Array, Array]:
        """H = Fh / Fc, and the factor of velocity in dz/dt, each of shape (n,), along motions;
        their edges are the start of each motion and the end of the last."""

    def tangents(self, time: Array, q: Array, edges: Index) -> tuple[Array, Array, Array, Array]:
        """`hysteresis`, and the derivatives of both by `vector`, each of shape (k, n)."""


class KernelShape(Shape):
    """A shape whose law, given by the class of its parameters, has a kernel."""

    law: Any

    @abstractmethod
    def block_tangents(self, P: Array) -> Array:
        """Derivatives of the block P by `vector`, shape (k, m); Fc is 1."""

    @cached_property
    def _unit_block(self) -> Array:
        """The law's block with Coulomb level 1."""
        return self.parameters(1.0, 0.0).pack()

    def hysteresis(self, time: Array, q: Array, edges: Index) -> tuple[Array, Array]:
        H, rate = np.empty_like(q), np.empty_like(q)
        drive_motions(self._unit_block, time, q, edges, H, rate)
        return H, rate

    def tangents(self, time: Array, q: Array, edges: Index) -> tuple[Array, Array, Array, Array]:
        P = self._unit_block
        return driven_with_tangents(P, self.block_tangents(P), time, q, edges)


_END = "log end"
_BOTH = ("excess", "log Vs", "delta", _END, "log bend 1", "log bend 2")
OF_NEGATIVE = " of negative motion"
# numbers of which no end has a meaning, as no Stribeck effect and a straight curve have
LENGTHS = (_END, "log length")
ENDLESS = ("log Vs", "delta", *LENGTHS)
_NEGATIVE = ("excess" + OF_NEGATIVE, "log Vs" + OF_NEGATIVE)

# Torque of the transition curve's knots over its reach: three segments, as in the paper.
_TORQUES = (0.5, 0.8, 1.0)
# The assumed steep beginning: torque of its knot over the curve's reach, and slope over that of the
# segment after it. `FrictionParameters.stiffness` is the slope beyond it.
_STEEP_TORQUE, _STEEPER = 0.0025, 1000.0


# parts of a presliding length to start from: a filter's or law's own lag may make it seem soft
STIFFER = (0.3, 1.0)


def level_bounds(vmax: float) -> tuple[list[float], list[float]]:
    """Bounds of excess, log Vs and delta: the Stribeck curve common to the laws."""
    # Fs / Fc - 1 up to 15: a well oiled joint may stick at many times its sliding friction
    return [0.0, float(np.log(1e-3 * vmax)), 0.4], [15.0, float(np.log(0.3 * vmax)), 3.0]


def length_bounds(span: float) -> tuple[float, float]:
    """Bounds of the logarithm of a presliding length."""
    return float(np.log(1e-6 * span)), float(np.log(0.1 * span))


# Exponents with closed-form steps, which are fast: a log barely distinguishes those in between.
_EXPONENTS = (1.0, 2.0, 4.0)
_SHARP = 12.0


@dataclass(frozen=True)
class IntegratedShape(KernelShape):
    """Search variables of the integrated law; the last four attributes are those of `Shape`."""

    excess: float  # Fs / Fc - 1, >= 0
    Vs: float  # Stribeck velocity, rad/s
    delta: float  # Stribeck exponent
    # z of the first knot, rad; the presliding stiffness is Fs / length. Searched is the end of the
    # curve, which bends do not move: a joint reaches it in any log that slides
    length: float
    # slope of the second segment over the first, and of the third over the second, each in (0, 1];
    # (1, 1) is a straight transition curve
    bend: tuple[float, float]
    # discrete choices, see `FrictionParameters`; a fit tries each
    n: float
    variant: Variant
    virgin: Virgin
    negative: tuple[float, float] | None = None  # excess and Vs of negative motion, if different
    damped: bool = False
    stiffness_assumed: bool = False
    breakaway_assumed: bool = False
    steep_start: bool = False

    law = FrictionParameters

    @property
    def variables(self) -> tuple[str, ...]:
        """Numbers of both directions, then those of the negative one, without what is assumed."""
        names = _BOTH if self.negative is None else (*_BOTH, *_NEGATIVE)
        assumed = {_END: self.stiffness_assumed, _BOTH[0]: self.breakaway_assumed}
        assumed[_NEGATIVE[0]] = self.breakaway_assumed
        return tuple(name for name in names if not assumed.get(name))

    def _values(self) -> dict[str, float]:
        """All numbers by name, searched or not."""
        negative = self.negative or (self.excess, self.Vs)
        end = self.length * sum(_parts(self.bend))
        logs = np.log([self.Vs, end, *self.bend, negative[1]]).tolist()
        numbers = (self.excess, logs[0], self.delta, *logs[1:4], negative[0], logs[4])
        return dict(zip((*_BOTH, *_NEGATIVE), numbers, strict=True))

    def vector(self) -> Array:
        values = self._values()
        return np.array([values[name] for name in self.variables])

    def moved(self, x: Array) -> Self:
        values = self._values() | dict(zip(self.variables, x.tolist(), strict=True))
        excess, log_Vs, delta, *logs, excess_negative, log_Vs_negative = values.values()
        end, first, second = np.exp(logs).tolist()
        length = end / sum(_parts((first, second)))
        return replace(
            self,
            excess=excess,
            Vs=float(np.exp(log_Vs)),
            delta=delta,
            length=self.length if self.stiffness_assumed else length,
            bend=(first, second),
            negative=self.negative and (excess_negative, float(np.exp(log_Vs_negative))),
        )

    def bounds(self, vmax: float, span: float) -> tuple[Array, Array]:
        """Bounds of Stribeck curve, end of the transition curve and bends, as in `variables`."""
        low, high = level_bounds(vmax)
        bend = (float(np.log(0.02)), 0.0)
        shortest, longest = length_bounds(span)
        # after a reversal the curve has twice its length
        end = (shortest, longest + float(np.log(2.0)))
        each = [*zip(low, high, strict=True), end, bend, bend]
        by_name = dict(zip((*_BOTH, *_NEGATIVE), [*each, *each[:2]], strict=True))
        least, most = zip(*(by_name[name] for name in self.variables), strict=True)
        return np.array(least), np.array(most)

    def started(self, start: LawStart) -> list[Self]:
        """Starting shapes, with the estimated and with a straight transition curve, whose loops
        curve enough at a small n."""
        # a bend that is smaller or larger at the start cannot move
        straight = 0.95
        first, second = np.clip(start.bend, 0.03, straight)
        return [
            replace(
                self,
                excess=start.excess,
                Vs=start.Vs,
                delta=start.delta,
                length=start.length * stiffer,
                bend=bend,
            )
            for stiffer in STIFFER
            for bend in ((float(first), float(second)), (straight, straight))
        ]

    def last_choices(self) -> list[Self]:
        """Variants of the first loading of a joint that never moved."""
        return [replace(self, virgin=x) for x in get_args(Virgin)]

    def with_sharp_sliding(self) -> list[Self]:
        """This shape with an exponent above those of a search; with the present Stribeck curve, and
        with a wide one of half the height."""
        sharp = replace(self, n=_SHARP)
        return [sharp, replace(sharp, excess=0.5 * self.excess, Vs=2.0 * self.Vs, delta=2.0)]

    @property
    def sharp(self) -> bool:
        """Whether sliding begins sharply, see `with_sharp_sliding`."""
        return self.n == _SHARP

    def with_damping(self) -> Self:
        """This shape with the presliding damping sigma1."""
        return replace(self, damped=True)

    def by_direction(self) -> Self:
        """This shape with a separate Stribeck curve for each direction."""
        return replace(self, negative=self.negative or (self.excess, self.Vs))

    def with_assumed_stiffness(self, reach: float) -> Self:
        """The shape with a presliding length of `reach`, rad (m), not searched."""
        return replace(self, length=reach, stiffness_assumed=True)

    def with_assumed_breakaway(self, excess: float) -> Self:
        excess, Vs, delta = with_excess((self.excess, self.Vs, self.delta), excess)
        negative = self.negative and with_excess((*self.negative, self.delta), excess)[:2]
        fixed = replace(self, excess=excess, negative=negative, breakaway_assumed=True)
        # the stiffness remains
        length = self.length * (1.0 + excess) / (1.0 + self.excess)
        return replace(fixed, Vs=Vs, delta=delta, length=length)

    def parameters(self, Fc: float, sigma2: float, sigma1: float = 0.0) -> FrictionParameters:
        excess, Vs = self.negative or (self.excess, self.Vs)
        Fs_pos, Fs_neg = Fc * (1.0 + self.excess), Fc * (1.0 + excess)
        return FrictionParameters(
            Fs_pos=Fs_pos,
            Fs_neg=Fs_neg,
            Fc_pos=Fc,
            Fc_neg=Fc,
            Vs_pos=self.Vs,
            Vs_neg=Vs,
            delta_pos=self.delta,
            delta_neg=self.delta,
            sigma2_pos=sigma2,
            sigma2_neg=sigma2,
            sigma1=sigma1,
            n=self.n,
            variant=self.variant,
            virgin=self.virgin,
            knots=self._knots(Fs_pos + Fs_neg),
        )

    def _knots(self, both: float) -> Knots:
        """Transition curve that reaches Fs of both directions."""
        ends, parts = self.length * np.cumsum(_parts(self.bend)), np.array(_TORQUES)
        if self.steep_start:
            # the rest of the curve keeps its form, so that it stays concave
            z = self.length * _STEEP_TORQUE / (_TORQUES[0] * _STEEPER)
            ends = z + np.append(0.0, ends)
            parts = _STEEP_TORQUE + (1.0 - _STEEP_TORQUE) * np.append(0.0, parts)
        return tuple(zip(ends.tolist(), (both * parts).tolist(), strict=True))

    def block_tangents(self, P: Array) -> Array:
        rows = {name: np.zeros(len(P)) for name in (*_BOTH, *_NEGATIVE)}
        own = slice(1 + integrated.KNOTS + 1, None)
        # knots are z, F, slope; torques and slopes go with Fs of both directions
        z, F, K = P[own].reshape(-1, KNOT_STRIDE).T
        sides = (integrated.POSITIVE, integrated.NEGATIVE)
        both = P[1 + sides[0] + FS] + P[1 + sides[1] + FS]
        for side, (excess, Vs) in zip(sides, (_BOTH[:2], _NEGATIVE), strict=True):
            rows[excess][1 + side + FS] = 1.0
            rows[excess][own] = np.column_stack([0.0 * z, F, K]).ravel() / both
            rows[Vs][1 + side + VS] = P[1 + side + VS]
            rows["delta"][1 + side + DELTA] = 1.0
        if self.negative is None:
            for name, of_negative in zip(_BOTH, _NEGATIVE, strict=False):
                rows[name] += rows[of_negative]
        rows[_END][own] = np.column_stack([z, 0.0 * F, -K]).ravel()
        # a bend stretches what lies beyond its knot, and with the end where it is shortens all
        parts = _parts(self.bend)
        for i, name in enumerate(_BOTH[4:]):
            beyond = np.maximum(z - z[i + self.steep_start], 0.0)
            steeper = np.where(beyond > 0.0, K, 0.0)
            rows[name][own] = np.column_stack([-beyond, 0.0 * F, steeper]).ravel()
            if not self.stiffness_assumed:
                rows[name] += sum(parts[i + 1 :]) / sum(parts) * rows[_END]
        return np.array([rows[name] for name in self.variables])


def _parts(bend: tuple[float, float]) -> tuple[float, float, float]:
    """Lengths of the segments of a transition curve over that of its first."""
    (first, second), (a, b, c) = bend, _TORQUES
    return 1.0, (b - a) / a / first, (c - b) / a / (first * second)


INTEGRATED = tuple(
    IntegratedShape(0.2, 1.0, 1.0, 1.0, (0.4, 0.4), n, variant, "literal")
    for variant in get_args(Variant)
    for n in _EXPONENTS
)
