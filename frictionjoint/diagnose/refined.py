"""Whole logs simulated in closed loop by several models, and the comparison of a refined model."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from frictionjoint.control.controller import Controller
from frictionjoint.diagnose.closed_loop import (
    ClosedLoop,
    Course,
    closed_loop,
    courses_of,
    driven_courses,
)
from frictionjoint.diagnose.finding import Trace
from frictionjoint.diagnose.intervals import stated_covariance
from frictionjoint.diagnose.replay import WINDOW_S, Replay
from frictionjoint.diagnose.rms import Rms
from frictionjoint.identify.fit import Fit, without_scale
from frictionjoint.identify.result import Estimate, law_estimates, term_estimates
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.log import JointLog
from frictionjoint.refine.refine import Refined, refine


@dataclass(frozen=True)
class LoopErrors:
    """Errors of whole logs in closed loop, fitted and held out."""

    fit: ClosedLoop | None
    held_out: ClosedLoop | None

    @property
    def mae(self) -> Rms:
        """Mean absolute position errors, rad (m)."""
        return Rms(*(None if x is None else x.mae for x in (self.fit, self.held_out)))

    @property
    def rms(self) -> Rms:
        """Roots of the mean square."""
        return Rms(*(None if x is None else x.rms for x in (self.fit, self.held_out)))

    @property
    def replays(self) -> "tuple[Replay, Replay | None]":
        """Fitted and held-out logs as free runs, one run per log."""
        assert self.fit is not None
        return self.fit.replay, self.held_out.replay if self.held_out else None


@dataclass(frozen=True)
class Loops:
    """Fitted and held-out logs prepared for simulation."""

    fit: tuple[Course, ...]
    held_out: tuple[Course, ...]

    @classmethod
    def of(
        cls,
        pairs: Sequence[tuple[Sequence[JointLog], Sequence[RigidBody]]],
        controller: Controller,
    ) -> "Loops | None":
        """From logs and their bodies; None if a log has no target."""
        if any(log.target is None for logs, _ in pairs for log in logs):
            return None
        return cls(*(courses_of(logs, bodies, controller) for logs, bodies in pairs))

    def errors(self, fits: Sequence[Fit]) -> tuple[LoopErrors, ...]:
        """Errors of each model."""
        return tuple(
            LoopErrors(*(closed_loop(c, f) if c else None for c in (self.fit, self.held_out)))
            for f in fits
        )


@dataclass(frozen=True)
class RefinedModel:
    """A refinement in a report.

    Attributes:
        taken: whether the refinement is the result, because it predicted left-out logs better than
            the fit to torque.
        guard: mean absolute errors on left-out logs, before and after, rad (m).
        loops: whole logs in closed loop; None if the drive was measured.
        parameters: by name, with standard errors.
    """

    taken: bool
    guard: tuple[float, float]
    loops: LoopErrors | None
    parameters: dict[str, Estimate]

    @classmethod
    def of(cls, outcome: Refined, loops: Loops | None, slide: bool, scaled: bool) -> "RefinedModel":
        """From a refinement, used or not.

        Args:
            scaled: whether the gain of the drive is determined; otherwise all is in units of the
                drive.
        """
        whole = outcome.vector.fit(outcome.values)
        cov = outcome.vector.own_covariance(whole, outcome.cov)
        fitted = whole if scaled else without_scale(whole)
        found = law_estimates(fitted, cov, slide)
        for i, term in enumerate(fitted.effects):
            found |= {
                f"{term.name} {name}": x
                for name, x in term_estimates(fitted, cov, i, slide).items()
            }
        errors = loops.errors([whole])[0] if loops else None
        return cls(outcome.taken, outcome.guard, errors, found)

    def to_dict(self) -> dict[str, Any]:
        """As in report.json."""
        return {
            "taken": self.taken,
            "left_out_mae": {"before": self.guard[0], "after": self.guard[1]},
            **(
                {
                    "closed_loop_mae": self.loops.mae.to_dict(),
                    "closed_loop_rms": self.loops.rms.to_dict(),
                }
                if self.loops
                else {}
            ),
            "parameters": {name: x.to_dict() for name, x in self.parameters.items()},
        }


def refined_in_windows(
    found: Trace,
    logs: Sequence[JointLog],
    bodies: Sequence[RigidBody],
    progress: Callable[[str], None],
) -> Refined:
    """Refine by runs from the measured motion, driven by the measured drive (multiple shooting).

    Args:
        found: in these logs. bodies: one per log.
    """
    courses = driven_courses(logs, bodies, found.prepared, WINDOW_S)
    cov = stated_covariance(found.prepared, found.final)
    return refine(found.prepared, found.final, cov, courses, progress)
