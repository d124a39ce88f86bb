"""Notes of a report without repetition."""

import re
from collections.abc import Iterable

from frictionjoint.law.names import LAWS
from frictionjoint.report.wording import listed

# what differs between notes that say the same: numbers, laws, and names in front of a colon
_NUMBER = re.compile(r"[-+−]?\d[\d.,]*(?:e[-+]?\d+)?")
_LAW = re.compile(rf"\b(?:{'|'.join(sorted(LAWS, key=len, reverse=True))})\b")
_WHOSE = re.compile(r"^[\w ,./-]{1,60}: ")


def without_repetition(notes: Iterable[str]) -> tuple[str, ...]:
    """Each note once; of several that differ only in numbers, law or log, the first one.

    The first one names the other logs, joints or laws, or counts the other notes. Their order, most
    important first, is kept.
    """
    alike: dict[str, list[str]] = {}
    for note in dict.fromkeys(notes):
        alike.setdefault(_LAW.sub("#", _NUMBER.sub("#", _WHOSE.sub("", note))), []).append(note)
    return tuple(_joined(found) for found in alike.values())


def _joined(notes: list[str]) -> str:
    if len(notes) == 1:
        return notes[0]
    for pattern in (_WHOSE, _LAW):
        names = [m.group().removesuffix(": ") for note in notes if (m := pattern.search(note))]
        others = [name for name in dict.fromkeys(names) if name != names[0]]
        if len(names) == len(notes) and others:
            same = "The same holds, with other numbers, for"
            return f"{notes[0]} ({same} {listed(others)}.)"
    return f"{notes[0]} (And {len(notes) - 1} more, with other numbers.)"
