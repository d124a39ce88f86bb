"""Whole logs simulated in closed loop by several models, and the comparison of a refined model."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from frictionjoint.control.controller import Controller
from frictionjoint.diagnose.closed_loop import ClosedLoop, Course, closed_loop, courses_of
from frictionjoint.diagnose.replay import Replay
from frictionjoint.diagnose.rms import Rms
from frictionjoint.identify.fit import Fit, without_scale
from frictionjoint.identify.result import Estimate, law_estimates, term_estimates
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.log import JointLog
from frictionjoint.refine.refine import Refined


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
        taken: whether it is the result, because it predicted left-out logs better than the fit to
            torque.
        guard: mean absolute errors on left-out logs, before and after, rad (m).
        loops: whole logs in closed loop. parameters: by name, with standard errors.
    """

    taken: bool
    guard: tuple[float, float]
    loops: LoopErrors
    parameters: dict[str, Estimate]

    @classmethod
    def of(cls, outcome: Refined, loops: Loops, slide: bool, scaled: bool) -> "RefinedModel":
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
        (errors,) = loops.errors([whole])
        return cls(outcome.taken, outcome.guard, errors, found)

    def to_dict(self) -> dict[str, Any]:
        """As in report.json."""
        return {
            "taken": self.taken,
            "left_out_mae": {"before": self.guard[0], "after": self.guard[1]},
            "closed_loop_mae": self.loops.mae.to_dict(),
            "closed_loop_rms": self.loops.rms.to_dict(),
            "parameters": {name: x.to_dict() for name, x in self.parameters.items()},
        }
