"""What was found of a robot, as rows and sentences for the terminal and the page."""

from typing import NamedTuple

from frictionjoint.diagnose.rms import Rms
from frictionjoint.report.wording import known_as, title
from frictionjoint.robot.report_data import RobotReport, SharedCause


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
    """A joint in words: errors of torque in per cent of its rms, of the replay as they are."""

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
        f"{name.replace('_', ' ')} {x.value:.4g}"
        + (f" ± {x.stderr:.2g}" if x.stderr else "")
        + (f" {x.unit}" if x.unit != "1" else "")
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
                _position(result.before_replay),
                _position(r.after_replay),
                r.verdict.replace("-", " ") + (", worse on held-out data" if result.worse else ""),
                True,
            )
        )
    dashes = ("-",) * 4
    rows += [JointRow(n, "-", *dashes, text, False) for n, text in report.failed.items()]
    return rows


def whole(report: RobotReport) -> str:
    """The robot in a sentence."""
    where = "held-out" if report.after.torque_percent.held_out is not None else "fitted"
    before, after = (_of(x.torque_percent) for x in (report.before, report.after))
    text = f"Torque error {before:.3g} to {after:.3g}% of rms over the joints on {where} data"
    pair = [_of(x.replay) for x in (report.before, report.after)]
    if None not in pair:
        text += f"; all joints together move {pair[0]:.3g} to {pair[1]:.3g} rad rms from the log"
    return f"{text}, within half a second of free run." if None not in pair else f"{text}."


def _of(rms: Rms) -> float | None:
    return rms.held_out if rms.held_out is not None else rms.fit


def _percent(rms: Rms, size: float) -> str:
    value = _of(rms)
    return "-" if value is None else f"{100.0 * value / size:.3g}%"


def _position(rms: Rms) -> str:
    value = _of(rms)
    return "-" if value is None else f"{value:.3g}"
