"""Notes on a result: one or two sentences each."""

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.diagnose.finding import Trace
from frictionjoint.effects.signals import GX, GY, LOAD, A, Q
from frictionjoint.identify.constraint_shape import ConstraintShape
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.gate import SURE
from frictionjoint.identify.result import law_parameters, scale_note, units_of
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.timing import Timing

# standard errors, or rms errors, beyond which something is more than chance
_BEYOND = 2.0
# part of the samples that is worth naming
_SOME = 0.01
REFINED = (
    "The parameters are refined by simulation: position errors are those of the refined "
    "parameters, torque errors those of the fit to torque."
)
DIVERGES = (
    "The simulation diverges: restarted from the log and driven as it says, it leaves the logged "
    "motion by more than all its travel, so no position error is stated. Check masses, gravity and "
    "signs of the MJCF, and the units of the logs."
)
NO_LOAD = (
    "The drive does not grow with the load of the MJCF: check signs and zeros of this joint and of "
    "those beyond it, or the load is too small to show."
)


def gain_note(error: float) -> tuple[str, ...]:
    """Note that a gain determined from simulated motion is uncertain, if it is."""
    if error < 1.0 / SURE:
        return ()
    return (
        f"The torque scale is uncertain by {error:.0%}: all torques scale together, the simulated "
        "motion does not change. Record motion with a payload of known mass to determine it.",
    )


def notes(found: Trace, cov: Array, load_shows: bool) -> tuple[str, ...]:
    """All notes on a result, those that a reader may have to act on first.

    Args:
        cov: of all parameters of the final fit. load_shows: whether its drive grows with the load.
    """
    return (
        *scale_note(found.final, found.prepared.slide),
        *inertia_note(found.prepared, found.final),
        *(() if load_shows else (NO_LOAD,)),
        *found.hints,
        *stiffness_note(found.final, found.prepared.slide),
        *_constraint_note(found),
        *timing_note(found.final, cov),
        *_rest_note(found),
        *_sight_note(found),
        *_laws_note(found),
        *_hold_note(found),
    )


def inertia_note(prepared: Prepared, fitted: Fit) -> tuple[str, ...]:
    """Note that the torque scale depends on the inertia in the MJCF, if gravity is too small."""
    if "load" not in fitted.names or fitted.in_drive_units:
        return ()
    signals = np.concatenate([s.at_kept(s.signals) for s in prepared.segments])
    # of a slide gravity is one force, of a hinge it turns with the link
    pull = np.ones((len(signals), 1)) if prepared.slide else signals[:, [GX, GY]]
    both = np.column_stack([signals[:, A], pull])
    gravity = pull @ np.linalg.lstsq(both, signals[:, LOAD], rcond=1e-6)[0][1:]
    per_torque = float(fitted.beta[fitted.names.index("load")])
    if per_torque * np.sqrt(np.mean(gravity**2)) > fitted.rms:
        return ()
    return (
        "Gravity hardly loads this joint, so the torque scale comes from the MJCF's inertia alone: "
        "if that inertia is wrong by a factor, so are all torques. Give --gain, or record motion "
        "with a payload of known mass that gravity loads.",
    )


def other_drive_note(*logs: Prepared | None) -> tuple[str, ...]:
    """Note on parts of logs that are left out because another drive turns the joint."""
    return tuple(
        f"{segment.name}: {begin:.4g} to {end:.4g} s are left out: the drive is exactly 0 while "
        "the joint moves, and it does not slow as its friction would slow it, so another drive "
        "turns it."
        for prepared in logs
        if prepared
        for segment in prepared.segments
        for begin, end in segment.turned_by_another
    )


def timing_note(fitted: Fit, cov: Array) -> tuple[str, ...]:
    """Sub-sample time offsets that differ clearly from zero."""
    said = []
    for i, term in enumerate(fitted.terms):
        if isinstance(term, Timing):
            (time,), k = term.shape, fitted.layout.numbers(i).start
            error = float(np.sqrt(max(0.0, cov[k, k])))
            if abs(time) > _BEYOND * error:
                said.append(term.says(f"{1e3 * abs(time):.2g} ± {1e3 * error:.1g} ms"))
    return tuple(said)


def _hold_note(found: Trace) -> tuple[str, ...]:
    """Note that the drive is constant between samples."""
    if not found.prepared.band.zero_order_hold:
        return ()
    return ("The torque is held from one sample to the next. The fit accounts for it.",)


def _laws_note(found: Trace) -> tuple[str, ...]:
    """Errors of the other laws with the same effects, for comparison."""
    if not found.other_laws:
        return ()
    unit, _ = units_of(found.final, found.prepared.slide)
    own, mine = law_parameters(found.final).law, found.final.rms_in_motion
    others = ", ".join(f"{law} {left:.3g}" for law, left in found.other_laws)
    return (
        f"Error in motion on fitted logs with each friction law and the same effects, {unit}: "
        f"{own} {mine:.3g} (used), {others}.",
    )


def stiffness_note(fitted: Fit, slide: bool) -> tuple[str, ...]:
    """Note that the stiffness is assumed, or that the law has no Coulomb friction."""
    if not fitted.has_level:
        return (
            "These logs show no Coulomb friction: its fitted value is zero. So the model does "
            "not hold the joint at rest. Record "
            "slow constant velocities in both directions, where viscous friction is small.",
        )
    if not fitted.shape.assumed:
        return ()
    return (
        "The presliding stiffness is assumed: these logs do not determine it. It is as high as the "
        "encoder's resolution and the time step allow, so that the joint sticks.",
    )


def _constraint_note(found: Trace) -> tuple[str, ...]:
    """Note that friction acts like a constraint of MuJoCo's solver."""
    shape = found.final.shape
    if not isinstance(shape, ConstraintShape):
        return ()
    lead = f"{1e3 * shape.lead:.2g} ms"
    if found.prepared.commanded:
        return (
            f"Friction changes direction {lead} before the logged velocity does: probably target "
            "and position are sampled at different times, or the controller file lacks a delay.",
        )
    return (
        f"Torque leads position by {lead}: probably the two signals are sampled at different "
        "times. A log simulated with MuJoCo's own frictionloss looks the same.",
    )


def _rest_note(found: Trace) -> tuple[str, ...]:
    """Error on samples whose torque the position does not determine."""
    rest = ~found.final.in_motion
    if not rest.any():
        return ()
    unit, _ = units_of(found.final, found.prepared.slide)
    error = root_mean_square(found.final.residual[rest])
    return (
        f"In {rest.mean():.0%} of the samples the joint sticks or reverses, where the position "
        f"hardly determines the torque. They count little in the fit; their error, {error:.3g} "
        f"{unit} rms, is not part of the torque errors above, which are those of the motion.",
        *_held_note(found, rest, error),
    )


def _held_note(found: Trace, rest: NDArray[np.bool_], error: float) -> tuple[str, ...]:
    """Note that something other than friction also holds the joint at rest, and where."""
    fitted = found.final
    level = float(np.max(np.abs(fitted.friction)))
    # what the model leaves in motion it may leave at rest too
    if error <= level + _BEYOND * fitted.rms_in_motion:
        return ()
    unit, of_position = units_of(fitted, found.prepared.slide)
    position = found.prepared.at_kept(Q)
    sides = (
        ("forward", rest & (fitted.residual > level)),
        ("back", rest & (fitted.residual < -level)),
    )
    where = [
        f"{np.median(position[held]):.3g} {of_position} (pressed {side})"
        for side, held in sides
        if held.any()
    ]
    return (
        f"That is more than friction can hold, {level:.2g} {unit}: a stop, a brake or a contact "
        f"holds the joint at {' and '.join(where)}. Give the joint's range in the MJCF, or leave "
        "that part of the log out.",
    )


def _sight_note(found: Trace) -> tuple[str, ...]:
    """Note on the smallest detectable effect, if no effect was found."""
    if found.findings or found.unexplained:
        return ()
    sight = found.sight
    unit, _ = units_of(found.final, found.prepared.slide)
    size = f"{sight.torque:.2g} {unit} rms"
    rest = 1.0 - float(np.mean(found.final.in_motion))
    if not sight.too_short:
        where = (
            f" in motion; the search leaves out the {rest:.0%} of the samples in which the joint "
            "sticks or reverses"
            if rest >= _SOME
            else ""
        )
        return (f"The smallest effect that these logs would have shown is {size}{where}.",)
    return (
        f"These {sight.duration:.3g} s are too short: the smallest effect that they would have "
        f"shown is {size}. About {sight.needed:.2g} s of such motion are needed.",
    )
