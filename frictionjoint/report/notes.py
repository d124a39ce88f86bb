"""Notes of a report without repetition."""

import re
from collections.abc import Iterable

# what differs between two notes that say the same: numbers, and names in front of a colon
_NUMBER = re.compile(r"[-+−]?\d[\d.,]*(?:e[-+]?\d+)?")
_WHOSE = re.compile(r"^[\w ,./-]{1,60}: ")


def without_repetition(notes: Iterable[str]) -> tuple[str, ...]:
    """Each note once; of several that differ in numbers or in the log alone, the first one.

    The first one says how many more there are. The order, most important first, stays.
    """
    alike: dict[str, list[str]] = {}
    for note in dict.fromkeys(notes):
        alike.setdefault(_NUMBER.sub("#", _WHOSE.sub("", note)), []).append(note)
    return tuple(_joined(found) for found in alike.values())


def _joined(notes: list[str]) -> str:
    if len(notes) == 1:
        return notes[0]
    names = [m.group().removesuffix(": ") for n in notes[1:] if (m := _WHOSE.match(n))]
    others = ", ".join(names) if len(names) == len(notes) - 1 else f"{len(notes) - 1} more notes"
    return f"{notes[0]} (The same, with other numbers: {others}.)"
