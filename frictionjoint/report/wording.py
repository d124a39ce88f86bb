"""Text of numbers, units and names in reports, and notes without repetition."""

import math
import re
from collections.abc import Iterable, Sequence

from frictionjoint.identify.result import Estimate
from frictionjoint.law.names import LAWS

# an exponent of two digits
_EXPONENT = re.compile(r"e(-?)\+?0*")
# what differs between notes that say the same: numbers, laws, and names in front of a colon
_NUMBER = re.compile(r"[-+−]?\d[\d.,]*(?:e[-+]?\d+)?")
_LAW = re.compile(rf"\b(?:{'|'.join(sorted(LAWS, key=len, reverse=True))})\b")
_WHOSE = re.compile(r"^[\w ,./-]{1,60}: ")


def known_as(effect: str, plain: str) -> str:
    """Common name of an effect, with its canonical name in brackets if that differs."""
    return plain if plain.lower().replace(" ", "-") == effect else f"{plain} ({effect})"


def listed(names: Sequence[str]) -> str:
    """Names with commas, and "and" before the last one."""
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def axis(variable: str, slide: bool) -> str:
    """A quantity with its unit."""
    torque, x = ("N", "m") if slide else ("N m", "rad")
    unit = {"position": x, "velocity": f"{x}/s", "acceleration": f"{x}/s²", "load": torque}
    unit |= {"time": "s", "temperature_c": "°C"}
    found = unit.get(variable)
    return f"{quantity(variable)}, {found}" if found else quantity(variable)


def drive_name(unit: str, slide: bool) -> str:
    """Name of the drive with a unit; in that of a position it is over a kp that is not known."""
    names = {"N m": "torque", "N": "force", "A": "current", "V": "voltage"}
    return names.get(unit, f"{'force' if slide else 'torque'} over kp")


def percentage(value: float, whole: float) -> str:
    """A part of a whole in per cent, to two figures."""
    part = 100.0 * value / whole if whole else math.nan
    return f"{part:.0f}%" if part >= 9.95 else f"{part:.2g}%"


def unit(text: str) -> str:
    return "none" if text == "1" else text.replace("^2", "²")


def three(value: float | None, figures: int = 3) -> str:
    """Three figures, or as many as given, or a dash."""
    return "–" if value is None else _plain(f"{value:.{figures}g}")


def interval(pair: tuple[float, float]) -> str:
    return f"{three(pair[0])} to {three(pair[1])}"


def value(x: Estimate) -> str:
    """A value ± its standard error, to the second figure of that; else to four figures."""
    if not x.stderr or not math.isfinite(x.stderr):
        # what is smaller in any unit of a joint is the rounding of a zero
        number = round(x.value, 12) + 0.0
        return _plain(f"{number:.4g}")
    decimals = 1 - math.floor(math.log10(x.stderr))
    # adding zero takes the sign off a zero
    # with more decimals an exponent is shorter
    texts = [
        "0"
        if number == 0.0
        else f"{round(number, decimals) + 0.0:.{max(decimals, 0)}f}"
        if decimals <= 6
        else _plain(f"{round(number, decimals) + 0.0:.8g}")
        for number in (x.value, x.stderr)
    ]
    # the spaces do not break a line
    return _EXPONENT.sub(r"e\1", "\u00a0±\u00a0".join(texts)).replace("-", "−")


def _plain(text: str) -> str:
    """Text of a number, without an exponent if the number is close to one, with a minus sign."""
    number = float(text)
    if "e" in text and 1e-4 <= abs(number) < 1e7:
        text = f"{number:f}".rstrip("0").rstrip(".") if abs(number) < 1.0 else f"{number:.0f}"
    return text.replace("-", "−", 1) if text.startswith("-") else text


def quantity(variable: str) -> str:
    """A measured quantity in the words of a report."""
    joint, dot, name = variable.rpartition(".")
    if dot:
        return f"{name} of {joint!r}"
    return "the recording" if variable == "log" else variable.removesuffix("_c")


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
