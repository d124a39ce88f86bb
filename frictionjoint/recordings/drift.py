"""Whether new logs confirm the friction of a report.

A parameter is *confirmed*, *changed*, or *not resolvable*: the new logs could not detect a change
by half of its value, their value is impossible, so that it has another cause, or the report assumes
it. Less than 5% is no change.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from scipy.special import stdtrit

from frictionjoint.decisions import SIGNIFICANCE
from frictionjoint.errors import ParameterError
from frictionjoint.identify.weights import STICKING_ERROR
from frictionjoint.measured.log import JointLog
from frictionjoint.recordings.between import over
from frictionjoint.recordings.estimate import Estimates, Known
from frictionjoint.refine.posterior import Posterior, entries
from frictionjoint.report.joints import read_joint
from frictionjoint.report.numbers import result_estimates

State = Literal["confirmed", "changed", "not resolvable"]


@dataclass(frozen=True)
class Drift:
    """A parameter in a report and in new logs, with the standard error of the difference. A state
    that is "not resolvable" has neither that nor a value now."""

    number: str
    before: float
    now: float | None
    stderr: float | None
    state: State


def known_of(report: Path, joint: str | None = None) -> Known:
    """The friction of a report: its folder, or report.json next to model.xml; ParameterError if it
    is no report, or gives no friction in N m."""
    file, name, own = read_joint(report, joint)
    model = file.with_name("model.xml")
    if not own.get("posterior"):
        what = f"no parameter uncertainty of joint {name!r}"
        raise ParameterError(f"{file}: it contains {what}: make it again")
    if not model.is_file():
        raise ParameterError(f"{model}: missing next to the report: give the whole folder")
    return Known(
        *(model, name, Posterior.from_dict(own["posterior"])),
        bandwidth_hz=float(own.get("bandwidth_hz", np.inf)),
        undetermined=frozenset(n for n, x in result_estimates(own).items() if x.stderr is None),
    )


def drift(known: Known, logs: Sequence[JointLog]) -> list[Drift]:
    """Compare each parameter of a known friction with new logs."""
    return judged(known, [Estimates(known, log) for log in logs])


def judged(known: Known, found: Sequence[Estimates]) -> list[Drift]:
    """The same for the estimates of new logs."""
    rows, keys = [], [entry.key for entry in entries(known.posterior.content)]
    for i, (number, before, error) in enumerate(
        zip(known.numbers, known.values, known.stderr, strict=True)
    ):
        now, own, dof = _together(found, i)
        sd = float(np.hypot(error, own))
        informed = max(x.informed[i] for x in found)
        # a change by half must show, and three quarters of the information come from the new logs
        blind = 2.0 * sd > 0.5 * abs(before) or informed < 0.75
        blind |= number.of_law and keys[number.indices[0]] in known.undetermined
        if number.of_law:  # none can be negative; one that has vanished may seem so by its error
            blind, now = blind or now < -2.0 * sd, max(0.0, now)
        # Satterthwaite: the report's error is known, that of the logs is estimated
        dof = dof * (sd / own) ** 4 if own else np.inf
        rows.append((number.name, float(before), now, sd, blind, dof))
    tested = sum(not blind for *_, blind, _ in rows)
    drifts = []
    for name, before, now, sd, blind, dof in rows:
        if blind:
            drifts.append(Drift(name, before, None, None, "not resolvable"))
            continue
        limit = -float(stdtrit(dof, SIGNIFICANCE / (2.0 * tested)))
        # no law is exact: motion of another kind moves a parameter by the error of the law
        least = max(limit * sd, STICKING_ERROR * abs(before))
        state: State = "changed" if abs(now - before) > least else "confirmed"
        drifts.append(Drift(name, before, now, sd, state))
    return drifts


def _together(found: Sequence[Estimates], i: int) -> tuple[float, float, float]:
    """Mean of a parameter over new logs, its standard error, including their differences, and that
    error's degrees of freedom. Logs along which it changes no torque do not count."""
    own = [x for x in found if x.stderr[i] > 0.0] or found[:1]
    if len(own) == 1:
        return float(own[0].value[i]), float(own[0].stderr[i]), own[0].dof
    all_of_them = over(own, i)
    return all_of_them.mean, all_of_them.stderr, all_of_them.dof
