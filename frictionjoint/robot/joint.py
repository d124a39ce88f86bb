"""A joint of a robot as the search for shared causes sees it: its balance, fitted and corrected."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.identify.design import kept
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.gate import check_signs
from frictionjoint.identify.held import Pose
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.reach import unreached
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.start import settled
from frictionjoint.identify.starts import fit, law_alone, with_times
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.identify.timing import TargetTiming, Timing, VelocityAge
from frictionjoint.identify.weights import reweighed
from frictionjoint.measured.log import JointLog
from frictionjoint.robot.along import Along
from frictionjoint.robot.corrections import Corrections

# as free as the law may be: what any part of it explains speaks for no cause
_DAMPED = tuple(replace(form, damped=True) for form in INTEGRATED)
# times that, at the end of their sample, stand for a cause that is to be seen
_OPEN_TIMES = (TargetTiming, VelocityAge)


@dataclass(frozen=True)
class FittedJoint:
    """One joint with the law fitted under the corrections that hold now.

    Attributes:
        alongs: one a log. prepared: the logs with the corrected load, weighted. fit: of the law.
        shift: what the load grew by since the law was fitted, N m, on the kept samples; None:
            nothing.
        beside: effects that the law was fitted beside, so that they do not bend it; what they
            explain is in the residual still. levels: of the law beside them, see `Fit.levels`.
        rms, left: of what the law leaves with them, N m, plain and weighted.
        unreached: what of that it need not leave to first order, see `reach.unreached`, (n,).
    """

    alongs: tuple[Along, ...]
    prepared: Prepared
    fit: Fit
    levels: tuple[float, float]
    rms: float
    left: float
    unreached: Array = field(repr=False)
    shift: Array | None = None
    beside: tuple[EffectTerm, ...] = ()

    @property
    def name(self) -> str:
        """Of the joint."""
        return self.prepared.joint

    @property
    def residual(self) -> Array:
        """What the law as it was fitted leaves under the corrections that hold now, N m, (n,)."""
        return self.fit.residual if self.shift is None else self.fit.residual - self.shift

    def columns(self, pairs: Sequence[tuple[Corrections, Corrections, float]]) -> Array:
        """Derivative of the torque by numbers, on the kept samples of all logs, shape (n, k).

        Args:
            pairs: the model's state below and above each number's own value, and how far apart.
        """
        if not pairs:
            return np.zeros((len(self.fit.residual), 0))
        rows = []
        for along, segment in zip(self.alongs, self.prepared.segments, strict=True):
            found = np.zeros((len(segment.signals), len(pairs)))
            for k, (low, high, apart) in enumerate(pairs):
                found[:, k] = along.linear(low, high) / apart
            rows.append(kept(segment, found))
        return np.concatenate(rows)

    def corrected(self, state: Corrections) -> "FittedJoint":
        """The same logs under other corrections; the fit is still the old one."""
        alongs = tuple(a.corrected(state) for a in self.alongs)
        before = self.prepared.segments
        segments = tuple(a.segment(s) for a, s in zip(alongs, before, strict=True))
        grown = np.concatenate(
            [a.balanced_load - b.balanced_load for a, b in zip(segments, before, strict=True)]
        )
        shift = grown if self.shift is None else self.shift + grown
        prepared = replace(self.prepared, segments=segments)
        return replace(self, alongs=alongs, prepared=prepared, shift=shift)

    def refitted(self, anew: bool = False) -> "FittedJoint":
        """With the law fitted again, from where it is or from everywhere."""
        # a rotor's inertia is one with the age of a velocity to the logs
        rotor = self.name in self.alongs[0].state.armature
        nothing = frozenset({VelocityAge.name} if rotor else ())
        prepared = replace(self.prepared, nothing=nothing)
        if anew:
            prepared, found = with_times(
                prepared, lambda own: fit(own, self.beside, _DAMPED), _OPEN_TIMES
            )
            prepared, found = reweighed(prepared, found)
            prepared, found = reweighed(*settled(prepared, found))
        else:
            shape = self.fit.shape
            prepared, found = with_times(
                prepared, lambda own: refit(own, self.beside, shape, ROUGH), _OPEN_TIMES
            )
            prepared, found = reweighed(prepared, found, ROUGH)
        levels, rms, left = found.levels, found.rms, found.drive_rms * found.gain
        beyond = unreached(found)
        if self.beside:
            timing = tuple(t for t in found.terms if isinstance(t, Timing))
            found = refit(prepared, timing, found.shape, steps=1)
        return replace(
            self,
            prepared=prepared,
            fit=found,
            levels=levels,
            rms=rms,
            left=left,
            unreached=beyond,
            shift=None,
        )


def first_fit(
    logs: Sequence[JointLog],
    model: str | Path,
    joint: str,
    fixed: Mapping[str, Pose] | None,
    controller: Controller | None = None,
) -> FittedJoint:
    """The law fitted to a joint's logs under the model as it is.

    Raises:
        LogError: see `prepare` and `gate.check_signs`: a wrong sign is no cause of the robot.
    """
    body = RigidBody(model, joint, fixed)
    prepared = prepare(list(logs), body, controller=controller)
    check_signs(prepared)
    none = Corrections.none(body.model)
    alongs = tuple(Along(body, s, none) for s in prepared.segments)
    prepared, base = law_alone(prepared, _DAMPED, open_times=_OPEN_TIMES)
    left = base.drive_rms * base.gain
    return FittedJoint(alongs, prepared, base, base.levels, base.rms, left, unreached(base))
