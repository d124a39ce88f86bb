"""Whole logs simulated in closed loop by several models."""

from collections.abc import Sequence
from dataclasses import dataclass

from frictionjoint.control.controller import Controller
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rms import Rms
from frictionjoint.measured.log import JointLog
from frictionjoint.replay.closed_loop import ClosedLoop, Course, closed_loop, courses_of
from frictionjoint.replay.free_runs import Replay


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

    def figures(self) -> dict[str, Rms]:
        """Both errors by their keys in report.json."""
        return {"closed_loop_mae": self.mae, "closed_loop_rms": self.rms}

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
        cls, pairs: Sequence[tuple[Sequence[JointLog], Sequence[RigidBody]]], controller: Controller
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
