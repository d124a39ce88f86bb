"""What a test joint hides, and whether what was found of it is right.

Three families of test joints, distinguished by the layout of their answer.json:

    kinds, accept, variable, family     `make_plants.py`, from `lab/plants`
    kinds, accept, variable, effects    a third author, `python -m lab.third_hand`
    kind                                one kind each; unknown-... is outside the catalogue

`accept` holds for each kind the names that are right; "none" where nothing needs to be named, for
the friction law takes it all; for a kind outside the catalogue the effects that it truly brings.
"""

import itertools
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from frictionjoint.measured.lowpass import gentle

OURS, SECOND, THIRD = "lab/plants", "second hand", "third hand"
NOTHING = "none"
# the second hand's kinds that go by another name too, and quantities that those outside the
# catalogue act through
_ALSO = {
    "periodic-friction": ("position-periodic",),
    "warm-up-drift": ("warm-up-drift", "temperature-dependent"),
    "torque-gain": ("torque-gain", "load-dependent", "inertia-error", "gravity-error"),
}
_THROUGH = {
    "unknown-encoder": ("position", "acceleration", "load"),
    "unknown-saturation": ("torque", "load", "acceleration"),
    "unknown-time": ("time",),
}


@dataclass(frozen=True)
class Answer:
    """The truth about a test joint.

    Attributes:
        family: whose test joint it is. kinds: what it hides.
        accept: names that are right of each kind. brings: names that are right next to these, of
            what a kind is besides. variable: quantities that are the right report
            of what is outside the catalogue; empty for all else.
        noise: rms of the held-out log's torque error, N m: what a true model leaves of it where
            the motion is known exactly. coloured: fraction of its power that is noise through a
            first-order low pass; corner: of that, Hz.
    """

    family: str
    kinds: tuple[str, ...]
    accept: Mapping[str, tuple[str, ...]]
    variable: tuple[str, ...]
    noise: float | None
    brings: tuple[str, ...] = ()
    coloured: float = 0.0
    corner: float = 1.0

    @property
    def group(self) -> str:
        """none, one, two or outside."""
        if self.variable:
            return "outside"
        return ("none", "one", "two")[len(self.kinds)]

    def left(self, bandwidth_hz: float, sample: float) -> float | None:
        """What a true model leaves behind the filter of a balance, N m rms.

        Args:
            bandwidth_hz: of the filter, see `gentle`.
            sample: s between the samples of the log.
        """
        if self.noise is None:
            return None
        f = np.linspace(0.0, 0.5 / sample, 4096)
        slow = 1.0 / (1.0 + (f / self.corner) ** 2)
        density = (1.0 - self.coloured) + self.coloured * slow / slow.mean()
        passed = gentle(f / bandwidth_hz) ** 2
        return float(self.noise * np.sqrt(np.mean(density * passed)))


def read_answer(folder: Path) -> Answer:
    """The answer of a test joint's folder."""
    raw = json.loads((folder / "answer.json").read_text())
    if "kind" in raw:
        return _second(raw)
    true, instruments = raw.get("true_rms"), raw.get("instruments", {})
    return Answer(
        family=raw.get("family", THIRD),
        kinds=tuple(raw["kinds"]),
        accept={kind: tuple(names) for kind, names in raw["accept"].items()},
        variable=tuple(raw["variable"]),
        noise=true["held_out"] if true else None,
        brings=tuple(raw.get("brings", ())),
        coloured=instruments.get("coloured", 0.0),
        corner=instruments.get("corner", 1.0),
    )


def _second(raw: Mapping[str, Any]) -> Answer:
    kind = raw["kind"]
    kinds = () if kind == NOTHING else (kind,)
    variable = _THROUGH.get(kind, ())
    accept = {k: () if variable else _ALSO.get(k, (k,)) for k in kinds}
    return Answer(SECOND, kinds, accept, variable, raw["noise"])


def judged(answer: Answer, row: Mapping[str, Any]) -> dict[str, bool]:
    """The questions of a test joint's group, each with whether the answer to it is right.

    A test joint on which the search ended with an error fails all of them.

    Args:
        row: added, a list of names; ties, one list of names for each of these; unexplained, a
            mapping of quantities.
    """
    group = answer.group
    names = row.get("added", ())
    found = [{name, *ties} for name, ties in zip(names, row.get("ties", ()), strict=True)]
    quantities = set(row.get("unexplained", ()))
    if group == "none":
        marks = {"nothing added": not found, "nor a quantity named": not found and not quantities}
    elif group == "outside":
        brought = {name for names in answer.accept.values() for name in names}
        right = bool(quantities & set(answer.variable))
        misnamed = [names for names in found if not names & brought]
        marks = {"not misnamed": not misnamed, "right quantity reported": right}
        marks["both"] = right and not misnamed
    else:
        named, alone = _named(answer, found)
        word = "named right" if group == "one" else "both named"
        marks = {word: named, f"{word}, and nothing else": alone}
        marks[f"{word}, without a tie's help"] = _named(answer, [{name} for name in names])[0]
    return {question: right and "error" not in row for question, right in marks.items()}


def _named(answer: Answer, found: Sequence[set[str]]) -> tuple[bool, bool]:
    """Whether each kind has a finding of its own, and whether that leaves no other finding."""
    accept = [set(names) for names in answer.accept.values()]
    besides = [i for i, names in enumerate(found) if names & set(answer.brings)]
    named = alone = False
    for size in range(len(accept) + 1):
        for kinds in itertools.permutations(range(len(accept)), size):
            others = set(range(len(accept))) - set(kinds)
            if not all(NOTHING in accept[k] for k in others):
                continue
            for chosen in itertools.combinations(range(len(found)), size):
                if all(found[i] & accept[k] for i, k in zip(chosen, kinds, strict=True)):
                    named = True
                    alone = alone or len({*chosen, *besides}) == len(found)
    return named, alone


def tables(rows: Iterable[tuple[Answer, Mapping[str, Any]]]) -> str:
    """Counts by family and question, errors and times, and what went wrong, as text."""
    by_family: dict[str, list[tuple[Answer, Mapping[str, Any]]]] = {}
    for answer, row in rows:
        by_family.setdefault(answer.family, []).append((answer, row))
    lines = []
    for family, plants in sorted(by_family.items()):
        lines += ["", f"{family}: {len(plants)} plants", ""]
        counts: dict[tuple[str, str], list[bool]] = {}
        for answer, row in plants:
            for question, right in judged(answer, row).items():
                counts.setdefault((answer.group, question), []).append(right)
        for group in ("none", "one", "two", "outside"):
            for (own, question), marks in counts.items():
                if own == group:
                    part = f"{sum(marks)} of {len(marks)}"
                    lines.append(f"  {group:8s} {question:36s} {part:>12s} {np.mean(marks):6.0%}")
        lines += [f"  {text}" for text in _figures([row for _, row in plants])]
        lines += ["", "  not right:"]
        lines += [f"  {text}" for text in _wrong(plants)]
    return "\n".join(lines)


def _figures(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Medians over the test joints that were answered."""
    found = []
    words = {
        "over_true": "held-out error in motion over what a true model leaves",
        "over_floor": "held-out error in motion over the estimated noise of the instruments",
        "seconds": "seconds a plant",
        "cpu_s": "seconds of one processor a plant",
    }
    for name, word in words.items():
        values = [row[name] for row in rows if row.get(name) is not None]
        if values:
            low, middle, high = np.quantile(values, (0.25, 0.5, 0.75))
            found.append(f"{word}: median {middle:.2f}, quartiles {low:.2f} and {high:.2f}")
    refused = sum("error" in row for row in rows)
    return [*found, f"ended with an error: {refused}"]


def _wrong(plants: Sequence[tuple[Answer, Mapping[str, Any]]]) -> list[str]:
    lines = []
    for answer, row in plants:
        marks = judged(answer, row)
        if not all(right for question, right in marks.items() if "without a tie" not in question):
            lines.append(f"{row['plant']}  {told(answer, row)}")
    return lines or ["nothing"]


def told(answer: Answer, row: Mapping[str, Any]) -> str:
    """What a test joint hides and what was said of it, in a line."""
    hidden = " + ".join(answer.kinds) or NOTHING
    if "error" in row:
        return f"{hidden}: {row['error']}"
    said = [
        f"{name} (or {', '.join(ties)})" if ties else name
        for name, ties in zip(row["added"], row["ties"], strict=True)
    ]
    through = ", ".join(f"{name} {share:.0%}" for name, share in row["unexplained"].items())
    return f"{hidden}: {', '.join(said) or NOTHING}{f'; depends on {through}' if through else ''}"
