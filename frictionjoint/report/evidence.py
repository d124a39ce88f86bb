"""Added effects, and the candidates of each step of the search, from report.json.

An effect that its p-value or its size does not support is in the model, but is not called missing.
A candidate that explains as much as the chosen one could also be the cause.
"""

import math
from dataclasses import dataclass

from frictionjoint.decisions import TIE
from frictionjoint.effects.catalogue import title
from frictionjoint.report.entries import Content
from frictionjoint.report.numbers import effect_estimates, size_of
from frictionjoint.report.wording import listed, three


def cause_title(found: Content) -> str:
    """Common name of a cause that joints share, with its place."""
    keys = ("cause", "parameters", "evidence", "joints")
    where = listed([str(x) for key, x in found.items() if key not in keys])
    return title(found["cause"]) + (f" of {where}" if where else "")


class EffectRow:
    """An added effect, with its evidence in a report.

    Attributes:
        name, title: canonical and common. cause, size: in words. gain to frequency: evidence.
        rivals: common names of effects that could also be the cause.
        next_best: common name and gain of the runner-up, if it explains less.
        doubt: why the logs do not support it by itself; empty if they do.
    """

    def __init__(self, content: Content, added: Content) -> None:
        evidence, name = added["evidence"], added["effect"]
        parameters = effect_estimates(content, added)
        gain, p, runner = evidence["held_out_gain"], evidence["p_value"], evidence["runner_up"]
        rivals = list(evidence.get("ties", ()))
        if runner is not None and evidence["margin"] <= 0.0:
            rivals.append(runner)
        look = next((x for x in content.get("candidates", ()) if x["chosen"] == name), None)
        if look:
            own = max((r["gain"] for r in look["rows"] if r["effect"] == name), default=math.inf)
            rivals += [r["effect"] for r in look["rows"] if r["gain"] >= own]
        others = {a["effect"] for a in content["added"]}
        rivals = [r for r in dict.fromkeys(rivals) if r not in others]
        self.name: str = name
        self.cause: str = added.get("cause", "")
        self.title = title(name, self.cause)
        self.size = size_of(name, parameters, content.get("slide", False))
        self.gain, self.p_value = gain, p
        self.frequency: float = evidence["selection_frequency"]
        self.rivals = tuple(map(title, rivals))
        self.next_best: tuple[str, float] | None = None
        if runner is not None and runner not in rivals:
            self.next_best = title(runner), max(0.0, gain - evidence["margin"])
        self.doubt = _doubt(content, evidence)


@dataclass(frozen=True)
class Candidate:
    """A candidate of one step of the search."""

    title: str
    gain: float
    p_value: float
    outcome: str


def _doubt(content: Content, evidence: Content) -> str:
    """Why the logs do not support an effect by itself."""
    gain, p = evidence["held_out_gain"], evidence["p_value"]
    significant = content.get("thresholds", {}).get("p_value", 0.05)
    if p > significant:
        return f"p = {three(p)}"
    if gain <= 0.0:
        return "it does not reduce the error on motion that it was not fitted to"
    if gain < TIE:
        return (
            f"it reduces the squared error on motion that it was not fitted to by {gain:.1%} only"
        )
    if evidence.get("size_is_open"):
        return "its size does not differ from zero by two standard errors"
    return ""


def step_of(
    look: Content, effects: tuple[EffectRow, ...], content: Content
) -> tuple[Candidate, ...]:
    """Candidates that were tried in one step of the search of a report, best first."""
    limits = content.get("thresholds") or {}

    def enough(row: Content) -> bool:
        return bool(row["gain"] >= limits["gain"] and row["p_value"] <= limits["p_value"])

    unnamed = max((x["share"] for x in content["unexplained"]), default=0.0)
    chosen = next((e for e in effects if e.name == look["chosen"]), None)
    found = []
    for row in sorted(look["rows"], key=lambda r: -r["gain"]):
        own = chosen if chosen and row["effect"] == chosen.name else None
        name = own.title if own else title(row["effect"])
        outcome = "not added"
        if row["effect"] == look["chosen"]:
            outcome = "added" if chosen else "added, replaced later"
        elif chosen and name in chosen.rivals:
            outcome = "could also be"
        elif not look["chosen"] and limits and enough(row):
            why = "not once the friction law was fitted together with it"
            if unnamed >= row["gain"]:
                why = "a dependence that is no known effect removes more"
            outcome = f"not added: {why}"
        found.append(Candidate(name, max(0.0, row["gain"]), row["p_value"], outcome))
    return tuple(found)


def smallest_of(content: Content, unit: str) -> tuple[tuple[str, str], ...]:
    """Each further effect with the smallest torque that the logs would have shown; empty: none."""
    found = []
    for x in content.get("smallest", ()):
        low, high = three(x["least"], 2), three(x["most"], 2)
        between = low if low == high else f"{low} to {high}" if x["most"] else f"{low} or more"
        found.append((title(x["name"]), f"{between} {unit}" if x["least"] else ""))
    return tuple(found)


def threshold_of(content: Content, effects: tuple[EffectRow, ...]) -> str:
    """When an effect is normally added, and which added effects fall short of that."""
    limits = content.get("thresholds") or {}
    if not limits:
        return ""
    text = (
        f"An effect is normally added only if it removes at least {limits['gain']:.0%} of the "
        f"squared residual and p is at most {limits['p_value']:g}."
    )
    less = [
        f"{e.title} ({e.gain:.1%}, p {three(e.p_value)})"
        for e in effects
        if e.gain < limits["gain"] or e.p_value > limits["p_value"]
    ]
    if less:
        text += f" Added with less than that: {listed(less)}."
    return text
