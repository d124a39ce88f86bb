"""The column names of a log, and which of a file's columns a joint needs.

``time_s``, ``position_rad``, ``velocity_rad_s``, ``torque_nm`` or ``voltage_v``, ``temperature_c``,
``target_rad``, ``supply_v`` (of a servo); ``<joint>.position_rad`` and so on for several joints;
slides ``position_m``, ``velocity_m_s``, ``force_n``, ``target_m``. ``current_a`` is a motor's
current: a torque up to an unknown gain. A target without a drive needs a controller, whose ``kp``,
``kd``, ``ki`` and supply ``vin`` may be columns.
"""

import difflib
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from frictionjoint.errors import LogError
from frictionjoint.measured.units import is_foreign, quantity_of

HINGE = ("position_rad", "velocity_rad_s", "torque_nm", "target_rad")
SLIDE = ("position_m", "velocity_m_s", "force_n", "target_m")
BOTH = ("voltage_v", "current_a", "supply_v", "temperature_c", "motor_position_rad")
POSITIONS, VELOCITIES = (HINGE[0], SLIDE[0]), (HINGE[1], SLIDE[1])
TARGET_OF = {"position_rad": "target_rad", "position_m": "target_m"}
MEASURED_DRIVES = ("torque_nm", "force_n", "voltage_v", "current_a")
_DRIVES = (*MEASURED_DRIVES, *TARGET_OF.values())
KNOWN = (*HINGE, *SLIDE, *BOTH)
# controller values that a log may contain
_FIGURES = ("kp", "kd", "ki", "vin")
_OURS = ("time_s", *KNOWN, *_FIGURES)
# how the columns of others are called, by what is missing
_LIKELY = {
    "time_s": re.compile(r"^(time|ts?|stamp|seconds?|millis|sec|[mun]s)\b|time|zeit", re.I),
    "position_rad": re.compile(
        r"^q(_?meas.*|\d*)$|(\b|_)pos(ition)?(_|\b)|angle|theta|^enc(oder)?\b", re.I
    ),
    "torque_nm": re.compile(r"^tau|torque|effort", re.I),
    "force_n": re.compile(r"force", re.I),
    "current_a": re.compile(r"^iq|^cur(r|_|$)|current|strom", re.I),
}
_RATE = re.compile(r"(\d+\.?\d*)\s*(k?)hz", re.I)
# columns of other joints, for the inverse dynamics of the arm
_MOTION = (*POSITIONS, *VELOCITIES)


def check_names(source: str, names: list[str], mapping: dict[str, str]) -> dict[str, str]:
    """The file's column name by our column name, for all columns of a file; LogError if there is no
    header, a column appears twice, or a mapped column does not exist."""
    used = {*mapping.values(), *(x for x in names if x.rpartition(".")[2] in _OURS)}
    twice = [name for name, count in Counter(names).items() if count > 1 and name in used]
    if twice:
        raise LogError(f"{source}: column {twice[0]!r} appears twice: rename one")
    for ours, theirs in mapping.items():
        ours_last = ours.rpartition(".")[2]
        if ours_last not in _OURS:
            near = difflib.get_close_matches(ours_last, _OURS, 1)
            fix = f"did you mean {near[0]!r}?" if near else f"known are {_list(_OURS)}"
            if theirs.rpartition(".")[2] in _OURS and ours in names:
                fix = f"the standard name comes first, {theirs}={ours}"
            raise LogError(f"{source}: --column {ours}={theirs}: unknown name {ours!r}: {fix}")
        if theirs not in names and not (ours_last == "time_s" and sample_rate(theirs)):
            if ours_last == "time_s" and theirs.lower().endswith("hz"):
                raise LogError(f"{source}: --column {ours}={theirs}: the rate must be above 0")
            rate = ours_last == "time_s" and sample_rate(f"{theirs}Hz")
            fix = f"; a sample rate needs its unit, --column {ours}={theirs}Hz" if rate else ""
            if source.endswith(".mat") and (struct := theirs.partition(".")[0]) in names:
                fix = f", a struct: save its fields, save('{source}', '-struct', '{struct}')"
            raise LogError(f"{source}: no column {theirs!r}, {_has(names)}{fix}")
    return {name: name for name in names} | mapping


def sample_rate(text: str) -> float | None:
    """Samples per second that a text such as ``500Hz`` or ``1kHz`` states, None for others."""
    rate = _RATE.fullmatch(text.strip())
    return float(rate[1]) * (1e3 if rate[2] else 1.0) or None if rate else None


def joints_in(table: dict[str, str]) -> list[str]:
    """Joints that prefix column names."""
    parts = (name.rpartition(".") for name in table)
    return sorted({joint for joint, dot, unit in parts if dot and joint and unit in KNOWN})


def driven_joints(table: dict[str, str]) -> list[str]:
    """Joints with columns for position and drive."""
    return [
        joint
        for joint in joints_in(table)
        if all(any(f"{joint}.{c}" in table for c in kind) for kind in (_MOTION, _DRIVES))
    ]


def one_joint(source: str, joints: Sequence[str], joint: str | None) -> str:
    """The requested joint of a log, or its only one; LogError if it has none such, or several."""
    if joint is not None and joint in joints:
        return joint
    if joint is None and len(joints) == 1:
        return joints[0]
    what = f"no joint {joint!r}, it has" if joint else "several joints, name one with --joint:"
    raise LogError(f"{source}: {what} {_list(joints)}")


def column_options(
    source: str, columns: Mapping[str, str] | None, names: Sequence[str], kind: str
) -> list[str | None]:
    """Values of ``--column`` for a log without a table, by names in order; LogError: another."""
    given = dict(columns or {})
    found = [given.pop(name, None) for name in names]
    if given:
        known = f"{', '.join(names[:-1])} and {names[-1]}"
        raise LogError(f"{source}: --column takes {known} for {kind}, not {', '.join(given)}")
    return found


class Chosen(NamedTuple):
    """Columns that a joint needs, by our name: of its motion and drive, of the motion of the other
    joints, of signals, and of controller values. `prefix` stands before its own in the file."""

    joint: str
    prefix: str
    columns: dict[str, str]
    signals: dict[str, str]
    figures: dict[str, str]


def choose(source: str, table: dict[str, str], joint: str | None, signals: Iterable[str]) -> Chosen:
    """Columns of the requested joint, or of the only one; LogError: see `one_joint`, or time,
    position, drive or a signal is missing, hinge and slide are mixed, or a signal is used anyway.
    """
    joints = joints_in(table)
    joint = one_joint(source, joints, joint) if joints else joint or "joint"
    prefix = f"{joint}." if joints else ""
    if "time_s" not in table:
        fix = f"{_fix(prefix, table, joint)}; where there are no times, give the sample rate"
        raise LogError(f"{source}: no column 'time_s', {_has(table)}; {fix}, --column time_s=500Hz")
    found = {c: table[prefix + c] for c in KNOWN if prefix + c in table}
    # quantities without a joint name apply to all joints, except motion and drive
    for shared in ("temperature_c", "supply_v"):
        if shared in table:
            found.setdefault(shared, table[shared])
    _check_kind(source, list(found), list(table), prefix, joint)
    found["time_s"] = table["time_s"]
    for other in joints:
        for c in _MOTION:
            if other != joint and f"{other}.{c}" in table:
                found[f"{other}.{c}"] = table[f"{other}.{c}"]

    def column(name: str) -> str | None:
        """The file's column of a quantity; a column of the joint takes precedence."""
        return table.get(f"{joint}.{name}", table.get(name))

    further = {}
    for name in signals:
        theirs = column(name)
        if theirs is None:
            raise LogError(f"{source}: no column {name!r} for --signal, it has {_list(table)}")
        if theirs in found.values():
            raise LogError(f"{source}: --signal {name}: the fit uses this column anyway, omit it")
        # a point separates a joint from its quantity
        further[name.replace(".", " ")] = theirs
    figures = {name: theirs for name in _FIGURES if (theirs := column(name)) is not None}
    return Chosen(joint, prefix, found, further, figures)


def _check_kind(source: str, chosen: list[str], table: list[str], prefix: str, joint: str) -> None:
    slide = "position_m" in chosen
    hinge = "position_rad" in chosen
    if not any(_LIKELY["position_rad"].search(x.rpartition(".")[2]) for x in table):
        # a bench that records its speed only
        hinge = hinge or (not slide and "velocity_rad_s" in chosen)
        slide = slide or (not hinge and "velocity_m_s" in chosen)
    if not hinge and not slide:
        wanted, fix = f"'{prefix}position_rad' (slide: position_m)", _fix(prefix, table, joint)
        raise LogError(f"{source}: no column {wanted}, {_has(table)}; {fix}")
    foreign = [c for c in chosen if c in (SLIDE if hinge else HINGE)]
    if foreign:
        kinds = ("position_rad", "velocity_rad_s") if hinge else ("position_m", "velocity_m_s")
        kind = next(x for x in kinds if x in chosen)
        both = f"{prefix}{foreign[0]} and {prefix}{kind}"
        raise LogError(f"{source}: {both} exclude each other: remove one")
    if not any(c in chosen for c in _DRIVES):
        drive = "torque_nm" if hinge else "force_n"
        wanted = " or ".join(f"'{prefix}{name}'" for name in (drive, "voltage_v", "current_a"))
        fix = _fix(prefix, table, joint, drive)
        raise LogError(f"{source}: no column {wanted}, {_has(table)}; {fix}")


def _likely(wanted: str, names: Sequence[str], joint: str) -> list[str]:
    """Columns that may be one of ours by their names; of several, those that name the joint."""
    found = [x for x in names if _LIKELY[wanted].search(x)]
    return [x for x in found if joint in x] if len(found) > 1 else found


def _fix(prefix: str, table: Iterable[str], joint: str, drive: str = "torque_nm") -> str:
    """The command options that would name all missing columns, with likely columns filled in."""
    names, parts = list(table), []
    unknown = "NUMBER" if names[:1] == ["1"] else "NAME"
    ours = {x.removeprefix(prefix) for x in names}
    position = () if ours & {"position_rad", "position_m"} else ("position_rad",)
    for wanted in ("time_s", *position, *(() if ours & {*_DRIVES} else (drive,))):
        if wanted not in ours:
            likely = _likely(wanted, names, joint)
            if wanted == drive and not likely and (currents := _likely("current_a", names, joint)):
                wanted, likely = "current_a", currents
            own = wanted if wanted == "time_s" else f"{prefix}{wanted}"
            name = likely[0] if len(likely) == 1 else unknown
            quote = "'" if " " in name else ""
            parts.append(f"--column {quote}{own}={name}{quote}")
            unit = re.split(r"[_\[(]", name)[-1].rstrip("])")
            if is_foreign(wanted, unit):
                parts.append(f"--unit {quantity_of(wanted)}={unit}")
    return f"name the columns with {' '.join(parts)}"


def _has(names: Iterable[str]) -> str:
    """The columns of a file, for a message."""
    listed = list(names)
    if listed == [str(i) for i in range(1, len(listed) + 1)]:
        return f"it has no header: its columns are numbered, 1 to {len(listed)}"
    return f"it has {_list(listed)}"


def _list(names: Iterable[object]) -> str:
    """Names for a message, shortened to one readable line."""
    listed = [str(name) for name in names]
    text = ", ".join(" ".join(name.split()) for name in listed[:30])
    return text[:600] + (" ..." if len(listed) > 30 or len(text) > 600 else "")
