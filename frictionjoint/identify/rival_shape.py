"""Shapes of the other laws in a fit, and the forms of every law by its name.

One acts like MuJoCo's own `frictionloss`, to read logs of a simulation. That friction is a
constraint: the solver drives velocity and acceleration to zero together, as v + a/b, within the
friction limit (documentation of MuJoCo, chapter Computation, reference acceleration and friction
loss). So it changes direction a time 1/b before the velocity, which no real joint does; for such a
log, a law without that lead has a larger residual than many effects cause. Half a simulation step
of the lead is lost, because the acceleration is that of the coming step.
"""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Self

import numpy as np

from frictionjoint.arrays import Array, Index, Vector
from frictionjoint.compiled import compiled
from frictionjoint.errors import ParameterError
from frictionjoint.identify.law_start import LawStart, with_excess
from frictionjoint.identify.shape import (
    INTEGRATED,
    STIFFER,
    KernelShape,
    Shape,
    length_bounds,
    level_bounds,
)
from frictionjoint.law import bristle, maxwell_slip
from frictionjoint.law.names import LAWS
from frictionjoint.law.stribeck import DELTA, FS, VS
from frictionjoint.parameters import Friction, FrictionParameters
from frictionjoint.rivals import RIVALS, MaxwellSlipParameters

_LEVELS = ("excess", "log Vs", "delta")
_VARIABLES: dict[str, tuple[str, ...]] = {
    "static": (*_LEVELS, "log V0 over Vs"),
    "armstrong": (*_LEVELS, "log length"),
    "dahl": ("log length", "i"),
    "dahl_stribeck": (*_LEVELS, "log length", "i"),
    "lugre": (*_LEVELS, "log length"),
    "elastoplastic": (*_LEVELS, "log length", "breakaway"),
    "maxwell_slip": (*_LEVELS, "log length", "log reach", "log C"),
}
_DAMPED = ("lugre", "elastoplastic", "maxwell_slip")
# Maxwell-slip elements: equal fractions of the level, slip displacements in a geometric row from
# `length` to `reach` times it
ELEMENTS = 8
_START = {
    "excess": 0.2,
    "log Vs": 0.0,
    "delta": 1.0,
    "log V0 over Vs": np.log(0.1),
    "log length": 0.0,
    "i": 1.0,
    "breakaway": 0.5,
    "log reach": np.log(10.0),
    "log C": np.log(1000.0),
}
# s, 1/b = dmax timeconst / 2 of the default solimp and solref, and what steps of up to 5 ms leave
# of it: a lead of any size would take up much in the logs of robots
LEAD = 0.5 * 0.95 * 0.02
_LEADS = (0.7 * LEAD, 1.05 * LEAD)


@dataclass(frozen=True)
class RivalShape(KernelShape):
    """Search variables of another law: Fs / Fc - 1, Vs, delta, then its own.

    `length` is Fs (Dahl: Fc) over the stiffness, so that it has a similar meaning in every law.
    """

    law: Any  # the class of its parameters
    numbers: tuple[float, ...]  # in the order of `variables`
    least_rate: float = 0.1  # of the attraction to the sliding level, C over Fc, in 1/s
    breakaway_assumed: bool = False  # whether Fs / Fc - 1, the first number, is not searched

    @property
    def variables(self) -> tuple[str, ...]:
        return _VARIABLES[self.law.law][int(self.breakaway_assumed) :]

    @property
    def damped(self) -> bool:
        return self.law.law in _DAMPED

    def vector(self) -> Array:
        return np.array(self.numbers[int(self.breakaway_assumed) :])

    def moved(self, x: Array) -> Self:
        fixed = self.numbers[: int(self.breakaway_assumed)]
        return replace(self, numbers=(*fixed, *x.tolist()))

    def bounds(self, vmax: float, span: float) -> tuple[Array, Array]:
        """Bounds common to all laws, and those of the numbers that only this law has."""
        low, high = level_bounds(vmax)
        # V0 is at most half of Vs: the level is reached before it falls
        reach = {
            **dict(zip(_LEVELS, zip(low, high, strict=True), strict=True)),
            "log length": length_bounds(span),
            "log V0 over Vs": (np.log(1e-4), np.log(0.5)),
            "i": (0.0, 4.0),
            "breakaway": (0.0, 0.95),
            "log reach": (0.0, np.log(300.0)),
            "log C": (np.log(self.least_rate), np.log(1e4)),
        }
        least, most = zip(*(reach[name] for name in self.variables), strict=True)
        return np.array(least), np.array(most)

    def started(self, start: LawStart) -> list[Self]:
        """The Stribeck curve and length of a start, in the numbers of this law."""
        common = {
            "excess": start.excess,
            "log Vs": np.log(start.Vs),
            "delta": start.delta,
            "log length": np.log(start.length),
        }
        numbers = np.array(
            [common.get(name, x) for name, x in zip(self.variables, self.numbers, strict=True)]
        )
        own, steps = "log length", np.log(STIFFER)
        if own not in self.variables:
            # a static law has a speed at which it has risen to its level, which no length tells
            own, steps = "log V0 over Vs", np.log((0.1, 1.0, 3.0))
        moves = self.variables.index(own) == np.arange(len(numbers))
        return [self.moved(numbers + step * moves) for step in steps]

    def with_assumed_breakaway(self, excess: float) -> Self:
        height, log_Vs, delta, *own = self.numbers
        excess, Vs, delta = with_excess((height, float(np.exp(log_Vs)), delta), excess)
        numbers = (excess, float(np.log(Vs)), delta, *own)
        return replace(self, numbers=numbers, breakaway_assumed=True)

    def parameters(self, Fc: float, sigma2: float, sigma1: float = 0.0) -> Friction:
        x = {
            name.removeprefix("log "): float(np.exp(n)) if name.startswith("log ") else n
            for name, n in zip(_VARIABLES[self.law.law], self.numbers, strict=True)
        }
        Fs = Fc * (1.0 + x.get("excess", 0.0))
        values: dict[str, Any] = {"Fc": Fc, "sigma2": sigma2}
        if "excess" in x:
            values |= {"Fs": Fs, "Vs": x["Vs"], "delta": x["delta"]}
        if "reach" in x:
            slips = x["length"] * x["reach"] ** (np.arange(ELEMENTS) / (ELEMENTS - 1))
            values["elements"] = tuple((float(Fs / ELEMENTS / z), 1.0 / ELEMENTS) for z in slips)
            values["C"] = Fc * x["C"]
        elif "length" in x:
            values["sigma0"] = Fs / x["length"]
        if "V0 over Vs" in x:
            values["V0"] = x["V0 over Vs"] * x["Vs"]
        values |= {name: x[name] for name in ("i", "breakaway") if name in x}
        if self.damped:
            values["sigma1"] = sigma1
        found: Friction = self.law.symmetric(**values)
        return found

    def block_tangents(self, P: Array) -> Array:
        P_t = np.zeros((len(self.numbers), len(P)))
        by = dict(zip(_VARIABLES[self.law.law], P_t, strict=True))
        if "excess" in by:
            for side in (bristle.POSITIVE, bristle.NEGATIVE):
                by["excess"][1 + side + FS] = 1.0
                by["log Vs"][1 + side + VS] = P[1 + side + VS]
                by["delta"][1 + side + DELTA] = 1.0
        own = 1 + bristle.OWN
        if "log C" in by:
            by["log C"][1 + maxwell_slip.ATTRACTION] = P[1 + maxwell_slip.ATTRACTION]
            springs = slice(1 + maxwell_slip.ELEMENTS, None, 2)
            by["log reach"][springs] = -P[springs] * np.arange(ELEMENTS) / (ELEMENTS - 1)
        else:
            springs = slice(own, own + 1)
        if "log length" in by:
            by["log length"][springs] = -P[springs]
            if "excess" in by:
                by["excess"][springs] = P[springs] / P[1 + bristle.POSITIVE + FS]
        if "log V0 over Vs" in by:
            by["log V0 over Vs"][own] = by["log Vs"][own] = P[own]
        for name in ("i", "breakaway"):
            if name in by:
                by[name][own + 1] = 1.0
        return P_t[int(self.breakaway_assumed) :]


def prompt_maxwell_slip() -> tuple[Shape, ...]:
    """Maxwell-slip that follows the Stribeck curve within milliseconds: its rate of attraction is a
    frictional lag, and with one in the law a search would not find that effect."""
    # 1/s: a lag of 3 ms, which a fit's bandwidth does not resolve
    return (replace(start_of(MaxwellSlipParameters), least_rate=300.0),)


def forms_of(law: str) -> tuple[Shape, ...]:
    """The forms of a law that a fit tries; ParameterError: no law has this name."""
    if law == FrictionParameters.law:
        return INTEGRATED
    for rival in RIVALS:
        if rival.law == law:
            # a search that may take any lag for a log's friction needs a start that has none
            prompt = prompt_maxwell_slip() if rival is MaxwellSlipParameters else ()
            return (start_of(rival), *prompt)
    raise ParameterError(f"unknown law {law!r}: known are {', '.join(LAWS)}")


def start_of(rival: Any) -> RivalShape:
    """Start of the search for another law's shape, by the class of its parameters."""
    return RivalShape(rival, tuple(_START[name] for name in _VARIABLES[rival.law]))


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
