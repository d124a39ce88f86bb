"""Parameters of a report in words: friction numbers, sizes of effects, the model.

Everything comes from the content of report.json.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from frictionjoint.effects.catalogue import title
from frictionjoint.effects.quantities import quantity_of
from frictionjoint.identify.result import Estimate, is_without_level
from frictionjoint.parameter_meanings import by_direction, meaning
from frictionjoint.report import wording
from frictionjoint.report.entries import Content

Status = Literal["determined", "not determined", "assumed", "fixed"]

_CARD = ("Fc", "Fs", "sigma2", "stiffness", "Vs", "gain")


@dataclass(frozen=True)
class Number:
    """One parameter: its symbol, without a direction if both are equal, what it means, value ±
    standard error with the unit, and how well the logs determine it."""

    name: str
    meaning: str
    text: str
    status: Status

    @property
    def qualified(self) -> str:
        """The text with the status in brackets, unless it is determined or fixed."""
        known = self.status in ("determined", "fixed")
        return self.text if known else f"{self.text} ({self.status})"


def estimates(parameters: Content) -> dict[str, Estimate]:
    """Estimates by name, from their dicts."""
    return {name: Estimate(**x) for name, x in parameters.items()}


def result_estimates(content: Content) -> dict[str, Estimate]:
    """Estimates of the resulting law: those of the refinement if it is the result."""
    own = {name: x for name, x in _refined(content).items() if " " not in name}
    return own or estimates(content["after"]["parameters"])


def effect_estimates(content: Content, added: Content) -> dict[str, Estimate]:
    """Estimates of an added effect of the result."""
    prefix, found = added["effect"] + " ", _refined(content)
    own = {n.removeprefix(prefix): x for n, x in found.items() if n.startswith(prefix)}
    return estimates(added["parameters"]) | own


def _refined(content: Content) -> dict[str, Estimate]:
    """Estimates of the refinement if it is the result; those of effects begin with their names."""
    refined = content.get("refined")
    return estimates(refined["parameters"]) if refined and refined["taken"] else {}


def law_numbers(law: Mapping[str, Estimate]) -> tuple[Number, ...]:
    """Every parameter of a law; one row for both directions if they are equal."""
    return tuple(
        Number(symbol, meaning(symbol), with_unit(law[name]), status_of(name, law))
        for symbol, name in by_direction(law, _equal)
    )


def friction_card(law: Mapping[str, Estimate]) -> tuple[Number, ...]:
    """The friction numbers in the order of a report."""
    rows = [(row.name.removesuffix("_pos").removesuffix("_neg"), row) for row in law_numbers(law)]
    return tuple(row for symbol in _CARD for name, row in rows if name == symbol)


def with_unit(x: Estimate) -> str:
    """Value ± standard error, the unit, and whether it is fixed."""
    unit = "" if x.unit == "1" else f"\u00a0{wording.unit(x.unit)}"
    return wording.value(x) + unit + (" (fixed)" if x.stderr == 0.0 else "")


def status_of(name: str, law: Mapping[str, Estimate]) -> Status:
    """How well the logs determine a parameter of a law.

    Friction rises from Fc to Fs below the Stribeck velocity, so an undetermined Stribeck velocity
    leaves Fs undetermined.
    """
    x, (symbol, _, side) = law[name], name.partition("_")
    if x.stderr is None or not math.isfinite(x.stderr):
        if symbol in ("stiffness", "sigma1", "Fs"):
            return "not determined" if is_without_level(law) else "assumed"
        return "not determined" if symbol in ("Vs", "delta") else "fixed"
    stribeck = f"Vs_{side}" if side else "Vs"
    if symbol == "Fs" and stribeck in law and status_of(stribeck, law) == "not determined":
        return "not determined"
    return "not determined" if x.is_loose else "determined"


def _equal(a: Estimate, b: Estimate) -> bool:
    # an exact copy in two files
    return math.isclose(a.value, b.value, rel_tol=1e-9) and a.stderr == b.stderr


def size_of(effect: str, parameters: Mapping[str, Estimate], slide: bool) -> tuple[str, ...]:
    """Numbers of an effect in words.

    A wave becomes an amplitude, a number per turn and a phase. The direction (cx, cy) of a first
    moment is the model's own.
    """
    left = dict(parameters)
    if "slope" in left:  # instead of numbers that the logs do not determine
        left = {n: x for n, x in left.items() if x.stderr is None or not x.is_loose}
    found = []
    for suffix in ("", *(f"_{k}" for k in range(2, len(left)))):
        keys = [f"{name}{suffix}" for name in ("sin", "cos", "N")]
        if all(key in left for key in keys):
            sine, cosine, count = (left.pop(key) for key in keys)
            found.append(_wave(sine, cosine, count, slide))
    along = "cx" in left and "cy" in left
    found += [
        f"{quantity_of(effect, name)} {with_unit(x)}"
        for name, x in left.items()
        if name not in ("cx", "cy")
    ]
    return (*found, "at the model's own centre of mass") if along else tuple(found)


def _wave(sine: Estimate, cosine: Estimate, count: Estimate, slide: bool) -> str:
    amplitude = math.hypot(sine.value, cosine.value)
    error = None
    if sine.stderr is not None and cosine.stderr is not None and amplitude:
        parts = sine.value * sine.stderr, cosine.value * cosine.stderr
        error = math.hypot(*parts) / amplitude
    size = with_unit(Estimate(amplitude, error, sine.unit))
    phase = math.degrees(math.atan2(cosine.value, sine.value))
    if not slide:
        often = f"{with_unit(Estimate(count.value, count.stderr, '1'))} per turn"
    else:
        period = 2.0 * math.pi / count.value
        spread = None if count.stderr is None else period * count.stderr / count.value
        often = f"every {with_unit(Estimate(period, spread, 'm'))}"
    return f"amplitude {size}, {often}, phase {wording.three(phase)}°"


def carried(content: Content) -> tuple[Number, ...]:
    """The parameters that model.xml contains, with the standard errors of the estimates."""
    model = content.get("model")
    if not model:
        return ()
    known, fixed = result_estimates(content), Estimate(0.0, None, "1")
    law = {
        name: replace(known.get(name, fixed), value=float(value))
        for name, value in model.items()
        if isinstance(value, int | float) and not isinstance(value, bool)
    }
    if "stiffness" in known and "stiffness" not in law:
        law["stiffness"] = known["stiffness"]
    rows = list(law_numbers({n: x for n, x in law.items() if x.value or n in known}))
    inside = [table["effect"] for table in model.get("effects", [])]
    for added in content["added"]:
        own = effect_estimates(content, added)
        name = title(added["effect"], added.get("cause", ""))
        where = "" if added["effect"] in inside else ", in the joint's or motor's own numbers"
        size = "; ".join(size_of(added["effect"], own, content.get("slide", False)))
        rows.append(Number(name, "added effect" + where, size or "in the model", "determined"))
    return tuple(rows)
