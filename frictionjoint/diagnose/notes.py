"""Notes on a result: one or two sentences each."""

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.decisions import CLEARLY, MOSTLY, SURELY
from frictionjoint.diagnose.determined import offset_instead
from frictionjoint.diagnose.finding import Trace
from frictionjoint.effects.signals import TIME, Q
from frictionjoint.identify.early_checks import SURE
from frictionjoint.identify.notes import assumed_note, inertia_note
from frictionjoint.identify.result import scale_note, term_estimates, units_of
from frictionjoint.identify.rival_shape import ConstraintShape

REFINED = (
    "The parameters were refined by simulation. The position errors are those of the refined "
    "parameters, the torque errors those before refinement."
)
DIVERGES = (
    "The simulation diverges: driven as logged, it leaves the logged motion by more than the whole "
    "travel, so no position error is stated. Check masses, gravity and signs of the MJCF, and the "
    "units of the logs."
)
EVENT_S = 0.5  # window in which an event is looked for
NO_LOAD = (
    "The drive does not grow with the load of the MJCF. Check signs and zeros of this joint and of "
    "the joints after it, unless the load is too small to measure."
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
        *_duration_note(found),
        *scale_note(found.final, found.prepared.slide),
        *inertia_note(found.prepared, found.final),
        *(() if load_shows else (NO_LOAD,)),
        *_motor_constant_note(found, cov),
        *_offset_note(found, cov),
        *_event_note(found),
        *_limit_note(found),
        *found.hints,
        *assumed_note(found.prepared, found.final),
        *_constraint_note(found),
        *_rest_note(found),
        *_laws_note(found),
    )


def _motor_constant_note(found: Trace, cov: Array) -> tuple[str, ...]:
    """Note that a wrong motor constant leaves friction in the unit of the logged torque."""
    slide = found.prepared.slide
    gains = [
        term_estimates(found.final, cov, i, slide)["gain"]
        for i, term in enumerate(found.final.terms)
        if term.effect.scales
    ]
    drive = "force" if slide else "torque"
    return tuple(
        f"By this fit the logged {drive} is {1.0 + x.value:.4g}"
        + (f" ± {x.stderr:.2g}" if x.stderr else "")
        + " times the true one. Friction is stated in the unit of the log, and model.xml requires "
        f"its {drive} in that unit too: divide both by {1.0 + x.value:.4g} for true values, or "
        "correct the log and repeat the analysis."
        for x in gains
    )


def _offset_note(found: Trace, cov: Array) -> tuple[str, ...]:
    """Note that an encoder zero may be off instead of a mass."""
    prepared = found.prepared
    terms = range(len(found.findings))
    each = (term_estimates(found.final, cov, i, prepared.slide) for i in terms)
    offsets = [x for own in each if (x := offset_instead(prepared, own)) is not None]
    return tuple(
        f"An encoder that reads {x:.3g} rad too much explains the logs equally well as a wrong "
        "mass: compare its zero with that of the MJCF."
        for x in offsets
    )


def _event_note(found: Trace) -> tuple[str, ...]:
    """Note on half a second that contains most of the squared error."""
    segments = found.prepared.segments
    time = found.prepared.at_kept(TIME)
    name = np.repeat(np.arange(len(segments)), [int(s.kept.sum()) for s in segments])
    squares = found.final.in_motion * found.final.residual**2
    _, window = np.unique(np.column_stack([name, time // EVENT_S]), axis=0, return_inverse=True)
    sums = np.bincount(window, squares)
    worst = np.argmax(sums)
    share = sums[worst] / (sums.sum() or 1.0)
    # one of many windows, and more than all others together; an error below 1% of the torque is
    # that of a good model
    small = found.final.rms_in_motion < 0.01 * found.final.target_rms
    if small or len(sums) < 20 or share < 0.5:
        return ()
    at = int(np.argmax(squares * (window == worst)))
    return (
        f"{segments[name[at]].name}: {share:.0%} of the squared error lies in {EVENT_S:g} s, at "
        f"{time[at]:.4g} s. Look there for a collision, a wrong reading, a torque that the drive "
        "did not deliver, or motion too fast for the sample rate.",
    )


def _limit_note(found: Trace) -> tuple[str, ...]:
    """Note that a measured drive often stands at its largest value, if no finding says so."""
    prepared = found.prepared
    at_limit = [s.at_kept(s.saturated) != 0.0 for s in prepared.segments if s.saturated is not None]
    if prepared.band.sensor_saturates or not at_limit:
        return ()
    share = sum(x.sum() for x in at_limit) / len(found.final.residual)
    if share < 0.01:
        return ()
    return (
        f"In {share:.0%} of the samples the {prepared.drive} is at its largest value. That is "
        "correct if the drive was at its limit. If the sensor saturated, leave these samples out, "
        "because the missing torque resembles other effects.",
    )


def _laws_note(found: Trace) -> tuple[str, ...]:
    """Note that another friction law leaves clearly less with the same effects, if one does."""
    unit, _ = units_of(found.final, found.prepared.slide)
    own = found.final.rms_in_motion
    law, least = min(found.other_laws.errors, key=lambda x: x[1], default=("", own))
    if least >= (1.0 - CLEARLY) * own:
        return ()
    return (
        f"The friction law {law} fits these logs better: with the same effects its error in motion "
        f"is {least:.3g} {unit} instead of {own:.3g} {unit}. To use it, give --law {law}.",
    )


def _constraint_note(found: Trace) -> tuple[str, ...]:
    shape = found.final.shape
    if not isinstance(shape, ConstraintShape):
        return ()
    drive, late = "torque", ""
    if found.prepared.commanded:
        drive, late = "target", ", or the controller file lacks a delay"
    return (
        f"Friction changes direction {1e3 * shape.lead:.2g} ms before the velocity does. MuJoCo's "
        f"frictionloss does that, a real joint does not. If the log is of a real joint, {drive} "
        f"and position were sampled at different times{late}.",
    )


def _rest_note(found: Trace) -> tuple[str, ...]:
    """Note on samples at rest, if they are most of the logs or more than friction holds them."""
    rest = ~found.final.in_motion
    if not rest.any():
        return ()
    unit, _ = units_of(found.final, found.prepared.slide)
    error = root_mean_square(found.final.residual[rest])
    held = _held_note(found, rest, error)
    if rest.mean() < MOSTLY and not held:
        return ()
    return (
        f"In {rest.mean():.0%} of the samples the joint sticks or reverses, where the position "
        "barely determines the torque. They have little weight in the fit, and their error, "
        f"{error:.3g} {unit} rms, is not included in the torque errors above.",
        *held,
    )


def _held_note(found: Trace, rest: NDArray[np.bool_], error: float) -> tuple[str, ...]:
    """Note that something other than friction also holds the joint at rest, and where."""
    fitted = found.final
    level = float(np.max(np.abs(fitted.friction)))
    # what the model leaves in motion it may leave at rest too
    if error <= level + SURELY * fitted.rms_in_motion:
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
        f"That is more than friction holds, {level:.2g} {unit}: a stop, a brake or a contact also "
        f"holds the joint, at {' and '.join(where)}. Add the joint's range to the MJCF, or leave "
        "that part of the log out.",
    )


def _duration_note(found: Trace) -> tuple[str, ...]:
    """Note that the logs are too short to show an effect."""
    limit, unit = found.detection_limit, units_of(found.final, found.prepared.slide)[0]
    if not limit.too_short or found.findings or found.unexplained:
        return ()
    return (
        f"These {limit.duration:.3g} s are too short to show an effect below {limit.torque:.2g} "
        f"{unit} rms. About {limit.needed:.2g} s of such motion are needed.",
    )
