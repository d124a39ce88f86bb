"""Shapes of the other laws in a fit, and the forms of every law by its name."""

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from frictionjoint.arrays import Array
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
