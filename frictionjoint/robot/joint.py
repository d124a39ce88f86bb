"""A joint of a robot in the search for shared causes: its torque balance, fitted and corrected."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.identify.early_checks import check_signs
from frictionjoint.identify.fit import Fit, unreached
from frictionjoint.identify.fixed_joints import Pose
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.start import settled
from frictionjoint.identify.starts import fit, law_alone, with_times
from frictionjoint.identify.terms import EffectTerm, TargetTiming, Timing, VelocityAge
from frictionjoint.identify.weights import reweighed
from frictionjoint.measured.log import JointLog
from frictionjoint.robot.corrected_torque import Along
from frictionjoint.robot.corrections import Corrections

# as free as the law may be: what any part of it explains speaks for no cause
_DAMPED = tuple(replace(form, damped=True) for form in INTEGRATED)
# times that, at the end of their sample, stand for a cause that is to be seen
_OPEN_TIMES = (TargetTiming, VelocityAge)


@dataclass(frozen=True)
class FittedJoint:
    """One joint with its law fitted, under the present corrections.

    Attributes:
        alongs: one per log. prepared: the logs with the corrected load, weighted. fit: of the law.
        shift: change of the load since the law was fitted, N m, on the kept samples; None: none.
        common_effects: fitted together with the law so that it is not biased; the residual still
            contains what they explain. levels: of the law with them, see `Fit.levels`.
        rms, left: rms residual of the law with them, N m, plain and weighted.
        unreached: part of the residual that vanishes to first order, see `fit.unreached`, (n,).
    """

    alongs: tuple[Along, ...]
    prepared: Prepared
    fit: Fit
    levels: tuple[float, float]
    rms: float
    left: float
    unreached: Array = field(repr=False)
    shift: Array | None = None
    common_effects: tuple[EffectTerm, ...] = ()

    @property
    def name(self) -> str:
        return self.prepared.joint

    @property
    def residual(self) -> Array:
        """Residual of the law as fitted, with the present corrections, N m, (n,)."""
        return self.fit.residual if self.shift is None else self.fit.residual - self.shift

    def columns(self, pairs: Sequence[tuple[Corrections, Corrections, float]]) -> Array:
        """Derivative of the torque by numbers, on the kept samples of all logs, shape (n, k), from
        corrections below and above each number's value, and their difference."""
        if not pairs:
            return np.zeros((len(self.fit.residual), 0))
        rows = [
            np.column_stack([along.linear(low, high) / apart for low, high, apart in pairs])
            for along in self.alongs
        ]
        return np.concatenate(rows)

    def corrected(self, state: Corrections) -> "FittedJoint":
        """The same logs with other corrections; the fit is unchanged."""
        alongs = tuple(a.corrected(state) for a in self.alongs)
        before = self.prepared.segments
        segments = tuple(a.segment(s) for a, s in zip(alongs, before, strict=True))
        for segment, along, own in zip(segments, self.alongs, before, strict=True):
            if along.state.linear_to(state):
                load = own.balanced_load + along.linear(along.state, state)
                segment.__dict__["balanced_load"] = load
        grown = np.concatenate(
            [a.balanced_load - b.balanced_load for a, b in zip(segments, before, strict=True)]
        )
        shift = grown if self.shift is None else self.shift + grown
        prepared = replace(self.prepared, segments=segments)
        return replace(self, alongs=alongs, prepared=prepared, shift=shift)

    def refitted(self, anew: bool = False) -> "FittedJoint":
        """The joint with the law fitted again, from its present shape or from all starts."""
        # a rotor's inertia is one with the age of a velocity to the logs
        rotor = self.name in self.alongs[0].state.armature
        nothing = frozenset({VelocityAge.name} if rotor else ())
        prepared = replace(self.prepared, nothing=nothing)
        shape, terms = self.fit.shape, self.common_effects
        if anew:
            prepared, found = with_times(prepared, lambda x: fit(x, terms, _DAMPED), _OPEN_TIMES)
            prepared, found = reweighed(*settled(*reweighed(prepared, found)))
        else:
            prepared, found = with_times(
                prepared, lambda x: refit(x, terms, shape, ROUGH), _OPEN_TIMES
            )
            prepared, found = reweighed(prepared, found, ROUGH)
        alone = found
        if terms:
            timing = tuple(t for t in found.terms if isinstance(t, Timing))
            alone = refit(prepared, timing, found.shape, steps=1)
        return FittedJoint(self.alongs, prepared, alone, *_size_of(found), common_effects=terms)


def first_fit(
    logs: Sequence[JointLog],
    model: str | Path,
    joint: str,
    fixed: Mapping[str, Pose] | None,
    controller: Controller | None = None,
) -> FittedJoint:
    """The law fitted to a joint's logs with the user's model; LogError: see `prepare` and
    `early_checks.check_signs`, for no cause of the robot produces a wrong sign."""
    body = RigidBody(model, joint, fixed)
    prepared = prepare(list(logs), body, controller=controller)
    check_signs(prepared)
    none = Corrections.none(body.model)
    alongs = tuple(Along(body, s, none) for s in prepared.segments)
    prepared, base = law_alone(prepared, _DAMPED, open_times=_OPEN_TIMES)
    return FittedJoint(alongs, prepared, base, *_size_of(base))


def _size_of(whole: Fit) -> tuple[tuple[float, float], float, float, Array]:
    """`levels`, `rms`, `left` and `unreached` of a joint, by the fit with its common effects."""
    return whole.levels, whole.rms, whole.drive_rms * whole.gain, unreached(whole)
