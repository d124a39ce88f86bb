"""Errors of a report before and after, and the noise of the instruments, from report.json.

Figures that the logs do not support are withheld, with a reason: a noise estimate above a remaining
error or far below the resolution of an instrument, and a percentage of a drive close to zero.
"""

from dataclasses import dataclass, field
from typing import Literal

from frictionjoint.decisions import LEAST_NOISE
from frictionjoint.report.entries import Content
from frictionjoint.report.wording import drive_name, percentage, three

Stage = Literal["before", "after"]
STAGES: tuple[Stage, Stage] = ("before", "after")

_LOOP = "position in closed loop"
_NO_NOISE = "The noise of the instruments cannot be determined from these logs."


@dataclass(frozen=True)
class ErrorRow:
    """An error before or after, on fitted and held-out logs."""

    quantity: str  # what is predicted
    stage: Stage
    unit: str  # of the values
    values: dict[str, float | None]  # by role, None if not stated
    fractions: dict[str, str] = field(default_factory=dict)  # of the drive by role, as text
    interval: tuple[float, float] | None = None  # 95%, of the held-out logs if there are any

    def text(self, role: str) -> str:
        """The value with unit and fraction."""
        value = self.values[role]
        if value is None:
            return "not stated"
        fraction = self.fractions.get(role)
        return f"{three(value)}\u00a0{self.unit}" + (f" ({fraction})" if fraction else "")


def units_of(content: Content) -> tuple[str, str]:
    """Units of drive and position."""
    units = content.get("units") or {"torque": "N m", "position": "rad"}
    return units["torque"], units["position"]


def drive_of(content: Content, unit: str) -> str:
    """Name of the torques in a report."""
    name = drive_name(unit, content.get("slide", False))
    source = content.get("drive", {}).get("source", "measured")
    return f"{'controller’s' if source == 'controller' else 'measured'} {name}"


def errors_of(content: Content, units: tuple[str, str]) -> tuple[ErrorRow, ...]:
    """Every error that is stated, before and after."""
    drive = drive_name(units[0], content.get("slide", False))
    found = []
    followed = "closed_loop_mae" in content["after"]
    kinds = (
        ("torque_rms", drive, units[0]),
        # a log simulated from its target is one run: its rms says the same as its mean error
        ("replay_rms", f"{_LOOP}, rms" if followed else "position", units[1]),
        ("closed_loop_mae", _LOOP, units[1]),
    )
    for key, name, unit in kinds:
        for stage in STAGES:
            values = content[stage].get(key)
            if not values or all(x is None for x in values.values()):
                continue
            fractions = _fractions(content, stage, values) if key == "torque_rms" else {}
            pair = ((content.get("intervals") or {}).get(key) or {}).get(stage)
            shown = values["fit"] if values["held_out"] is None else values["held_out"]
            # an interval that does not contain its error is one of other samples
            inside = pair is not None and shown is not None and pair[0] <= shown <= pair[1]
            interval = (pair[0], pair[1]) if pair and inside else None
            found.append(ErrorRow(name, stage, unit, dict(values), fractions, interval))
    return tuple(found)


def _fractions(content: Content, stage: Stage, errors: Content) -> dict[str, str]:
    """Errors as percentages of the drive on the same logs."""
    whole = content.get("drive", {}).get("rms", {}).get(stage, {})
    # an error of ten times the drive is no fraction of it
    return {
        role: percentage(error, whole[role])
        for role, error in errors.items()
        if error is not None and whole.get(role) and error < 10.0 * whole[role]
    }


def _remaining(content: Content) -> float | None:
    """The smallest rms error of the drive in the report."""
    stages = [content[stage]["torque_rms"] for stage in STAGES]
    stages += [added["torque_rms"] for added in content["added"]]
    values = [x for errors in stages for x in errors.values() if x is not None]
    values += [
        x for row in content.get("log_errors", ()) for x in (row["before"], row["after"]) if x
    ]
    return min(values, default=None)


def possible_noise(content: Content) -> float | None:
    """The noise of the instruments, not above an error that remains; None if it is far above."""
    estimate, least = content.get("noise_floor"), _remaining(content)
    # a noise is estimated to a factor of 1.5
    if not estimate or least is None or estimate > 1.5 * least:
        return None
    return float(min(estimate, least))


def noise_of(content: Content, unit: str) -> tuple[str, float | None]:
    """The noise of the instruments in a sentence, and its value if plausible."""
    noise = possible_noise(content)
    if noise is None:
        return _NO_NOISE, None
    whole = content.get("drive", {}).get("rms", {}).get("after", {})
    drive = max((x for x in whole.values() if x), default=None)
    if drive and noise < LEAST_NOISE * drive:
        return (
            f"The noise of the instruments is not stated: its estimate, {three(noise)} {unit}, "
            "is less than instruments resolve. The log may have been filtered or simulated."
        ), None
    return f"The noise of the instruments is about {three(noise)} {unit} in this band.", noise


def compared(before: ErrorRow | None, after: ErrorRow | None, role: str) -> str:
    """How an error changes: "falls" or "rises" beyond its intervals, "may be chance", "no fall"."""
    if before is None or after is None:
        return ""
    first, last = before.values[role], after.values[role]
    if first is None or last is None:
        return ""
    if before.interval and after.interval:
        if after.interval[0] > before.interval[1]:
            return "rises"
        if after.interval[1] < before.interval[0]:
            return "falls"
    return "no fall" if last > first else "may be chance" if before.interval else "falls by"


def arrow(before: ErrorRow, after: ErrorRow, role: str) -> str:
    """An error before and after, with its unit."""
    first, last = before.values[role], after.values[role]
    text = f"{three(first)} → {three(last)}\u00a0{after.unit}"
    if role in before.fractions and role in after.fractions:
        text += f" ({before.fractions[role]} → {after.fractions[role]})"
    return text
