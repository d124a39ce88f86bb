"""What was found of a robot, as rows and sentences for the terminal and the page."""

from collections.abc import Sequence
from typing import NamedTuple

from frictionjoint.diagnose.rms import Rms
from frictionjoint.identify.result import Estimate
from frictionjoint.report.wording import (
    known_as,
    percentage,
    stated,
    three,
    title,
    unit,
    value,
)
from frictionjoint.robot.report_data import JointResult, RobotReport, SharedCause

# a rise of the position error that is more than another run's
_WORSE = 1.1
_NONE = "–"


class SharedRow(NamedTuple):
    """A shared cause in words."""

    cause: str
    place: str
    values: str
    gain: float
    p_value: float
    ties: tuple[str, ...]
    joints: str


class JointRow(NamedTuple):
    """A joint in words: errors of torque in per cent of its rms, of the replay with their unit."""

    joint: str
    effects: str
    before: str
    after: str
    replay_before: str
    replay_after: str
    verdict: str
    explained: bool


def shared_rows(report: RobotReport) -> list[SharedRow]:
    """One each, those of the largest gain first."""
    rows = [_shared(report, cause) for cause in report.shared]
    return sorted(rows, key=lambda row: -row.gain)


def _shared(report: RobotReport, found: SharedCause) -> SharedRow:
    where = " and ".join(found.place.values())
    values = ", ".join(
        f"{name.replace('_', ' ')} {value(x, spread=bool(x.stderr))}"
        + (f"\u00a0{unit(x.unit)}" if x.unit != "1" else "")
        for name, x in found.parameters.items()
    )
    joints = []
    for name, (before, after) in found.joints.items():
        if name in report.joints:
            size = report.joints[name].report.measured_rms
            joints.append(f"{name} {_percent(before, size)} to {_percent(after, size)}")
    return SharedRow(
        spoken(found.cause),
        f" of {where}" if where else "",
        values,
        found.evidence.held_out_gain,
        found.evidence.p_value,
        tuple(spoken(label) for label in found.evidence.ties),
        ", ".join(joints),
    )


def spoken(label: str) -> str:
    """A cause or an effect as a person calls it, with the place that its label may have."""
    name, of, place = label.partition(" of ")
    plain = title(name)
    return (name.replace("-", " ") if plain == name else plain) + of + place


def joint_rows(report: RobotReport) -> list[JointRow]:
    """One each, those that failed last."""
    rows = []
    for name, result in report.joints.items():
        r = result.report
        law = f"law {r.laws[1].law}" if r.laws[1].law != result.law else ""
        effects = ", ".join(filter(None, (law, *(known_as(a.effect) for a in r.added)))) or "none"
        rows.append(
            JointRow(
                name,
                effects,
                _percent(result.before_torque, r.measured_rms),
                _percent(r.after_torque, r.measured_rms),
                _position(result.before_replay, r.units[1]),
                _position(r.after_replay, r.units[1]),
                r.verdict.replace("-", " ") + _worse(result),
                True,
            )
        )
    none = (_NONE,) * 5
    rows += [JointRow(n, *none, text, False) for n, text in report.failed.items()]
    return rows


def _worse(result: JointResult) -> str:
    """In which of its errors a joint is worse than before."""
    names = {"torque_rms": "torque", "replay_rms": "replay"}
    listed = " and ".join(names[name] for name in result.worse)
    return f", worse on held-out data ({listed})" if listed else ""


def unstated(rows: Sequence[JointRow]) -> str:
    """What a dash in place of a position error means; nothing where there is none."""
    if not any(r.explained and _NONE in (r.replay_before, r.replay_after) for r in rows):
        return ""
    return (
        f"{_NONE}: no position error is stated, since the simulation leaves the logged motion by "
        "more than all its travel, or the logs do not tell what torque the drive makes."
    )


class TorsionRow(NamedTuple):
    """Between motor and link, in words."""

    joint: str
    stiffness: str
    backlash: str
    hysteresis: str
    older: str
    twist: str
    left: str


def torsion_rows(report: RobotReport) -> list[TorsionRow]:
    """One for each joint with a second encoder."""
    return [
        TorsionRow(
            ", ".join(
                [name, *(f"motor geared to {x} as well ({c:.4g})" for x, c in t.geared.items())]
            ),
            _estimate(t.stiffness),
            _estimate(t.backlash),
            _estimate(t.hysteresis),
            _estimate(t.older),
            three(t.twist),
            three(t.left),
        )
        for name, result in report.joints.items()
        if (t := result.torsion)
    ]


def _estimate(x: Estimate | None) -> str:
    return "none seen" if x is None else f"{value(x, True)} {unit(x.unit)}"


def whole(report: RobotReport) -> str:
    """The robot in two sentences."""
    where = "held-out" if report.after.torque_percent.held_out is not None else "fitted"
    torque = _change(report.before.torque_percent, report.after.torque_percent, "%")
    text = f"The torque error {torque} of the rms torque (mean of the joints, {where} data)."
    replay = (report.before.replay, report.after.replay)
    if None not in (_of(x) for x in replay):
        text += (
            f" The position error {_change(*replay, ' rad')} rms when all joints are simulated "
            "together, restarted from the log every 0.5 s."
        )
        first, last = (x.fit for x in replay)
        if where == "held-out" and first and last and last > _WORSE * first:
            text += (
                f" On the fitted data it rises from {three(first)} to {three(last)} rad: what was "
                "added to single joints does not hold for all of them together."
            )
    return text


def _change(before: Rms, after: Rms, unit: str) -> str:
    first, last = (_of(x) for x in (before, after))
    if three(first) == three(last):
        return f"stays at {three(first)}{unit}"
    falls = first is not None and last is not None and last < first
    verb = "falls" if falls else "rises"
    return f"{verb} from {three(first)}{unit} to {three(last)}{unit}"


def _of(rms: Rms) -> float | None:
    return rms.held_out if rms.held_out is not None else rms.fit


def _percent(rms: Rms, size: float) -> str:
    error = _of(rms)
    return _NONE if error is None else percentage(error, size)


def _position(rms: Rms, unit: str) -> str:
    error = _of(rms)
    return _NONE if error is None else stated(error, unit)
