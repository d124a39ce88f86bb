"""Differences between the recordings of a report, and the spread that they add to its samples."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from frictionjoint.effects.catalogue import CATALOGUE, title
from frictionjoint.errors import FrictionJointError
from frictionjoint.identify.held import Pose
from frictionjoint.measured.log import JointLog
from frictionjoint.recordings.between import Between, between
from frictionjoint.recordings.estimate import Estimates, Known, estimate

if TYPE_CHECKING:
    from frictionjoint.report.joint_report import Report

# least number of recordings for a comparison
FEWEST = 3
_SURE = 0.05
# least fraction of the information on a parameter that must come from each recording
_INFORMED = 0.5
# standard error, as a fraction of the value, above which a parameter counts as undetermined
_LOOSE = 0.5
_MEASURED = {
    e.name for e in CATALOGUE if e.entry in ("acts on the measurement", "acts on the motor")
}


def with_recordings(
    report: "Report", logs: Sequence[JointLog], fixed: Mapping[str, Pose] | None = None
) -> "Report":
    """Add the differences of parameters between recordings to a report and to its samples.

    Args:
        logs: recordings with measured drives; with fewer than three, the report is unchanged.
    Returns:
        the report; unchanged if there is nothing to compare.
    """
    posterior = report.posterior
    drives = [log for log in logs if log.torque is not None or log.voltage is not None]
    if posterior is None or len(drives) < FEWEST:
        return report
    corrected = [x.effect for x in report.added if x.effect in _MEASURED]
    if corrected:
        note = (
            "The recordings were not compared with each other: the comparison takes the measured "
            f"torque as it is, and this result corrects it ({', '.join(map(title, corrected))})."
        )
        return replace(report, notes=(*report.notes, note))
    cov = posterior.factor @ posterior.factor.T
    known = Known(report.mjcf, report.joint, posterior.content, cov, fixed)
    try:
        found = [estimate(known, log) for log in drives]
    except FrictionJointError as error:
        note = f"The recordings were not compared with each other: {error}"
        return replace(report, notes=(*report.notes, note))
    rows, columns, said = [], [posterior.factor], []
    loose = known.stderr > _LOOSE * np.abs(known.values)
    for i, number in enumerate(known.numbers):
        own = [x for x in found if x.informed[i] > _INFORMED]
        if len(own) < FEWEST or loose[i]:
            continue
        over = _over(own, i)
        # A parameter of a law cannot be negative, so these estimates have another cause.
        if number.of_law and over.mean < 0.0:
            continue
        rows.append(_row(number.name, over, own, i))
        # one false alarm in twenty reports, over all parameters
        if over.p_value < _SURE / len(known.numbers) and over.deviation > 0.0:
            column = np.zeros((len(cov), 1))
            column[list(number.indices)] = over.deviation
            columns.append(column)
            said.append(_sentence(number.words, over))
    return replace(
        report,
        recordings=tuple(rows),
        posterior=replace(posterior, factor=np.hstack(columns)),
        notes=(*report.notes, *said),
    )


def _over(found: Sequence[Estimates], i: int) -> Between:
    value, stderr = (np.array([getattr(x, k)[i] for x in found]) for k in ("value", "stderr"))
    causes = {
        "temperature_c": np.array([x.temperature for x in found]),
        "speed": np.array([x.speed for x in found]),
        "direction": np.array([x.direction for x in found]),
        "order of the recordings": np.arange(len(found), dtype=float),
        "torque": np.array([x.load for x in found]),
    }
    return between(value, stderr, causes)


def _row(name: str, over: Between, found: Sequence[Estimates], i: int) -> dict[str, Any]:
    return {
        "number": name,
        "mean": over.mean,
        "interval": list(over.interval),
        "deviation": over.deviation,
        "p_value": over.p_value,
        "cause": over.cause or None,
        "slope": over.slope if over.cause else None,
        "recordings": [
            {"log": x.log, "value": float(x.value[i]), "stderr": float(x.stderr[i])} for x in found
        ],
    }


def _sentence(name: str, over: Between) -> str:
    share = f", {over.deviation / abs(over.mean):.0%} of it" if over.mean else ""
    cause = f" Most of it follows {over.cause} ({over.slope:.2g} per unit)." if over.cause else ""
    return (
        f"Between recordings, {name} varies by {over.deviation:.2g}{share} (standard deviation, "
        f"without the error of each; p {over.p_value:.2g}).{cause} Samples of the parameters "
        "include this variation."
    )
