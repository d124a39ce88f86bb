"""A law that acts like MuJoCo's own `frictionloss`, to read logs of a simulation.

That friction is a constraint: the solver drives velocity and acceleration to zero together, as v +
a/b, within the friction limit (documentation of MuJoCo, chapter Computation, reference acceleration
and friction loss). So it changes direction a time 1/b before the velocity, which no real joint
does; for such a log, a law without that lead has a larger residual than many effects cause. Half a
simulation step of the lead is lost, because the acceleration is that of the coming step.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np

from frictionjoint.arrays import Array, Index, Vector
from frictionjoint.compiled import compiled
from frictionjoint.identify.law_start import LawStart
from frictionjoint.identify.rival_shape import RivalShape
from frictionjoint.identify.shape import Shape
from frictionjoint.parameters import Friction, FrictionParameters

# s, 1/b = dmax timeconst / 2 of the default solimp and solref, and what steps of up to 5 ms leave
# of it: a lead of any size would take up much in the logs of robots
LEAD = 0.5 * 0.95 * 0.02
_LEADS = (0.7 * LEAD, 1.05 * LEAD)


class Constraint(NamedTuple):
    """How friction of this kind depends on acceleration."""

    lead: float  # time by which friction changes direction before the velocity does, s
    V0: float  # below this v + lead a, friction is proportional to v + lead a, rad/s (m/s)

    def saturated(self, v: Array, a: Array) -> Array:
        """Friction over its level, -1 to 1, at velocities and accelerations of shape (n,)."""
        return np.clip((v + self.lead * a) / self.V0, -1.0, 1.0)

    def torque(self, law: Friction, v: Array, a: Array) -> Array:
        """Torque of a law that acts in this way, N m (N), shape (n,)."""
        names = ("Fs", "Fc", "Vs", "delta", "sigma2")
        pos, neg = ([[getattr(law, f"{n}_{side}")] for n in names] for side in ("pos", "neg"))
        Fs, Fc, Vs, delta, sigma2 = np.where(v > 0.0, pos, neg)
        level = Fc + (Fs - Fc) * np.exp(-((np.abs(v) / Vs) ** delta))
        return np.asarray(level * self.saturated(v, a) + sigma2 * v)


@dataclass(frozen=True)
class ConstraintShape(Shape):
    """S(|v|) sat((v + lead a) / V0), with the numbers of a static law."""

    static: RivalShape
    lead: float = LEAD  # s
    # displacement at a reversal, rad, which no log of such friction determines, until
    # `with_assumed_stiffness` sets what the logs resolve
    reach: float = 1e-6

    damped = False
    steps = True
    stiffness_assumed = True

    @property
    def breakaway_assumed(self) -> bool:
        return self.static.breakaway_assumed

    @property
    def variables(self) -> tuple[str, ...]:
        """Those of the static law, with V0 of v + lead a, then the logarithm of the lead."""
        return (*self.static.variables, "log lead")

    @property
    def at_an_end(self) -> bool:
        """Whether the lead is none that a simulation has: other dynamics are taken for it."""
        margin = 0.01 * self.lead
        return self.lead < _LEADS[0] + margin or self.lead > _LEADS[1] - margin

    def vector(self) -> Array:
        return np.append(self.static.vector(), np.log(self.lead))

    def moved(self, x: Array) -> Self:
        return replace(self, static=self.static.moved(x[:-1]), lead=float(np.exp(x[-1])))

    def bounds(self, vmax: float, span: float) -> tuple[Array, Array]:
        """Bounds of the static law, and the shortest and longest lead."""
        low, high = self.static.bounds(vmax, span)
        return np.append(low, np.log(_LEADS[0])), np.append(high, np.log(_LEADS[1]))

    def started(self, start: LawStart) -> list[Self]:
        """One shape per start of the static law, with the present lead."""
        return [replace(self, static=shape) for shape in self.static.started(start)]

    def with_assumed_stiffness(self, reach: float) -> Self:
        """The shape that reaches its level within an assumed displacement, rad (m)."""
        return replace(self, reach=reach)

    def with_assumed_breakaway(self, excess: float) -> Self:
        return replace(self, static=self.static.with_assumed_breakaway(excess))

    def parameters(self, Fc: float, sigma2: float, sigma1: float = 0.0) -> FrictionParameters:
        """The integrated law with a Coulomb level: it sticks, while this constraint creeps."""
        excess, log_Vs, delta, _ = self.static.numbers
        Fs = Fc * (1.0 + float(excess))
        return FrictionParameters.symmetric(
            Fs=Fs,
            Fc=Fc,
            Vs=float(np.exp(log_Vs)),
            delta=float(delta),
            sigma2=sigma2,
            knots=((2.0 * self.reach, 2.0 * Fs),),
        )

    def hysteresis(self, time: Array, q: Array, edges: Index) -> tuple[Array, Array]:
        """Level times saturated constraint force, shape (n,); it has no state, so the rate is 0."""
        level, saturated, *_ = self._parts(time, q, edges)
        return level * saturated, np.zeros_like(q)

    def tangents(self, time: Array, q: Array, edges: Index) -> tuple[Array, Array, Array, Array]:
        """`hysteresis` and its derivatives by the numbers, (k, n), written out by hand."""
        level, saturated, v, a = self._parts(time, q, edges)
        excess, _, delta, _ = self.static.numbers
        inside = np.abs(saturated) < 1.0
        ratio = self._ratio(v)
        fall = np.exp(-(ratio**delta))
        steep = excess * fall * ratio**delta
        wider = -level * saturated * inside
        by_number = np.array(
            [
                fall * saturated,
                steep * delta * saturated + wider,
                -steep * np.log(np.maximum(ratio, 1e-300)) * saturated,
                wider,
                level * inside * self.lead * a / self.constraint.V0,
            ]
        )
        by_number = by_number[int(self.breakaway_assumed) :]
        return level * saturated, np.zeros_like(q), by_number, np.zeros_like(by_number)

    def _parts(self, time: Array, q: Array, edges: Index) -> tuple[Array, Array, Array, Array]:
        """Level over Fc, the saturated quantity, velocity and acceleration, each of shape (n,)."""
        v = gradient(q, time, edges)
        a = gradient(v, time, edges)
        excess, _, delta, _ = self.static.numbers
        level = 1.0 + excess * np.exp(-(self._ratio(v) ** delta))
        return level, self.constraint.saturated(v, a), v, a

    @property
    def constraint(self) -> Constraint:
        """The lead and V0 of the static law."""
        _, log_Vs, _, log_part = self.static.numbers
        return Constraint(self.lead, float(np.exp(log_Vs + log_part)))

    def _ratio(self, v: Array) -> Array:
        return np.asarray(np.abs(v) / np.exp(self.static.numbers[1]))


def gradient(x: Array, time: Array, edges: Index) -> Array:
    """Derivative along concatenated motions, shape (n,), as `numpy.gradient`."""
    out = np.empty_like(x)
    _fill_gradient(x, time, edges, out)
    return out


@compiled
def _fill_gradient(x: Vector, time: Vector, edges: Index, out: Vector) -> None:
    """Second-order derivative of x over time inside each motion, first order at its ends."""
    for i in range(len(edges) - 1):
        first, last = edges[i], edges[i + 1] - 1
        if first == last:
            out[first] = 0.0
            continue
        out[first] = (x[first + 1] - x[first]) / (time[first + 1] - time[first])
        out[last] = (x[last] - x[last - 1]) / (time[last] - time[last - 1])
        for k in range(first + 1, last):
            before, after = time[k] - time[k - 1], time[k + 1] - time[k]
            back, on = (x[k] - x[k - 1]) / before, (x[k + 1] - x[k]) / after
            out[k] = (after * back + before * on) / (before + after)
