"""Notes of a report without repetition."""

import re
from collections.abc import Iterable

from frictionjoint.law.names import LAWS

# what differs between notes that say the same: numbers, laws, and names in front of a colon
_NUMBER = re.compile(r"[-+−]?\d[\d.,]*(?:e[-+]?\d+)?")
_LAW = re.compile(rf"\b(?:{'|'.join(sorted(LAWS, key=len, reverse=True))})\b")
_WHOSE = re.compile(r"^[\w ,./-]{1,60}: ")


def without_repetition(notes: Iterable[str]) -> tuple[str, ...]:
    """Each note once; of several that differ in numbers, law or log alone, the first one.

    The first one says how many more there are. The order, most important first, stays.
    """
    alike: dict[str, list[str]] = {}
    for note in dict.fromkeys(notes):
        alike.setdefault(_LAW.sub("#", _NUMBER.sub("#", _WHOSE.sub("", note))), []).append(note)
    return tuple(_joined(found) for found in alike.values())


def _joined(notes: list[str]) -> str:
    if len(notes) == 1:
        return notes[0]
    names = [m.group().removesuffix(": ") for n in notes[1:] if (m := _WHOSE.match(n))]
    laws = [m.group() for n in notes[1:] if (m := _LAW.search(n))]
    others = names if len(names) == len(notes) - 1 else laws
    if len(others) < len(notes) - 1:
        return f"{notes[0]} (And {len(notes) - 1} more, with other numbers.)"
    return f"{notes[0]} (The same, with other numbers: {', '.join(others)}.)"
