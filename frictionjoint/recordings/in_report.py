"""Differences between the recordings of a report, and the spread that they add to its samples."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from frictionjoint.control.reconstruct import with_known_drive
from frictionjoint.decisions import SIGNIFICANCE, TIE
from frictionjoint.effects.catalogue import CATALOGUE, title
from frictionjoint.errors import FrictionJointError, ParameterError
from frictionjoint.identify.fixed_joints import Pose
from frictionjoint.identify.result import LOOSE
from frictionjoint.identify.weights import STICKING_ERROR
from frictionjoint.measured.log import JointLog
from frictionjoint.parameter_meanings import unit_of
from frictionjoint.recordings.between import Between, over
from frictionjoint.recordings.estimate import Estimates, Known

if TYPE_CHECKING:
    from frictionjoint.report.joint_report import Report

# least number of recordings for a comparison
FEWEST = 3
_MEASURED = {
    e.name for e in CATALOGUE if e.entry in ("acts on the measurement", "acts on the motor")
}


def with_recordings(
    report: "Report", logs: Sequence[JointLog], fixed: Mapping[str, Pose] | None = None
) -> "Report":
    """Add the differences between three or more recordings to a report and its samples, or a note
    why not; those of target and position get the drive of the controller that was found."""
    if len(logs) < FEWEST:
        return report
    try:
        known = _known(report, fixed)
        found = [Estimates(known, with_known_drive(log, report.controller)) for log in logs]
    except FrictionJointError as error:
        note = f"The recordings were not compared with each other: {error}"
        return replace(report, notes=(*report.notes, note))
    rows, columns, said = [], [known.posterior.factor], []
    for i, (number, stderr) in enumerate(zip(known.numbers, known.stderr, strict=True)):
        # at least half of the information must come from the recording
        own = [x for x in found if x.informed[i] > 0.5]
        between = over(own, i) if len(own) >= FEWEST else None
        # A parameter of a law cannot be negative, so such estimates have another cause.
        if between is None or (number.of_law and between.mean < 0.0):
            continue
        low, high = between.interval
        if not high - low < 2.0 * LOOSE * abs(between.mean):
            continue
        rows.append(_row(number.name, between, own, i))
        # one false alarm in twenty reports, over all parameters; and no law is exact, so values of
        # recordings of unlike motion differ by its error, or by that of the parameter
        least = max(stderr, STICKING_ERROR * abs(between.mean))
        sure = between.p_value < SIGNIFICANCE / len(known.numbers) and between.deviation > least
        if sure and explained(own, i) > TIE:
            column = np.zeros((len(columns[0]), 1))
            column[list(number.indices)] = between.deviation
            columns.append(column)
            symbol = number.name.partition(" ")[0]
            unit = f" {unit_of(symbol, report.slide)}" if number.of_law else ""
            said.append(_sentence(number.words, between, unit, bool(report.unexplained)))
    posterior, notes = replace(known.posterior, factor=np.hstack(columns)), (*report.notes, *said)
    return replace(report, recordings=tuple(rows), posterior=posterior, notes=notes)


def _known(report: "Report", fixed: Mapping[str, Pose] | None) -> Known:
    """The friction of a report; ParameterError without one in N m, or with a corrected drive."""
    posterior = report.posterior
    if posterior is None:
        raise ParameterError(
            "these logs do not determine the torque of the drive, so friction in N m (N) is "
            "unknown. A load that gravity changes, or a known payload, determines it."
        )
    corrected = [x.effect for x in report.added if x.effect in _MEASURED]
    if corrected:
        what = ", ".join(map(title, corrected))
        uses = "the comparison uses the measured drive"
        raise ParameterError(f"{uses}, and this result corrects it ({what}).")
    return Known(report.mjcf, report.joint, posterior, fixed, report.bandwidth_hz)


def explained(found: Sequence[Estimates], i: int) -> float:
    """Fraction of the squared residual that differences of a parameter between recordings explain
    and no other parameter does. Where it is small, they are as likely the error of the model, to
    which parameters that trade off in a recording adapt."""
    value, stderr = (np.array([getattr(x, k)[i] for x in found]) for k in ("value", "independent"))
    w = stderr**-2.0
    Q = float(w @ (value - w @ value / w.sum()) ** 2)
    return Q / (Q + sum(x.squares for x in found))


def _row(name: str, between: Between, found: Sequence[Estimates], i: int) -> dict[str, Any]:
    return {
        "number": name,
        "mean": between.mean,
        "interval": list(between.interval),
        "deviation": between.deviation,
        "p_value": between.p_value,
        "cause": between.cause or None,
        "slope": between.slope if between.cause else None,
        "recordings": [
            {"log": x.log, "value": float(x.value[i]), "stderr": float(x.stderr[i])} for x in found
        ],
    }


def _sentence(name: str, between: Between, unit: str, unexplained: bool) -> str:
    share = f", {between.deviation / abs(between.mean):.0%} of it" if between.mean else ""
    cause = f" Most of it depends on {between.cause} ({between.slope:.2g} per unit)."
    cause = cause if between.cause else ""
    if unexplained:
        cause += " The dependence that no known effect explains may only make it seem so."
    return (
        f"Between recordings, {name} varies by {between.deviation:.2g}{unit}{share} (standard "
        f"deviation, corrected for the error of each; p {between.p_value:.2g}).{cause} Samples of "
        "the parameters include this variation."
    )
