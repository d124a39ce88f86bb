"""Notes on a result: one or two sentences each."""

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.decisions import SURELY
from frictionjoint.diagnose.encoder_zero import offset_instead
from frictionjoint.diagnose.finding import Trace
from frictionjoint.diagnose.sight import Smallest
from frictionjoint.effects.signals import TIME, Q
from frictionjoint.identify.constraint_shape import ConstraintShape
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.gate import SURE
from frictionjoint.identify.notes import assumed_note, inertia_note
from frictionjoint.identify.result import law_parameters, scale_note, term_estimates, units_of
from frictionjoint.identify.timing import Timing

REFINED = (
    "The parameters are refined by simulation: position errors are those of the refined "
    "parameters, torque errors those of the fit to torque."
)
DIVERGES = (
    "The simulation diverges: restarted from the log and driven as it says, it leaves the logged "
    "motion by more than all its travel, so no position error is stated. Check masses, gravity and "
    "signs of the MJCF, and the units of the logs."
)
# s, of the window in which an event is looked for
EVENT_S = 0.5
HELD = "The torque is held from one sample to the next. The fit accounts for it."
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
    sight, too_short = _sight_note(found), found.sight.too_short
    return (
        *(sight if too_short else ()),
        *scale_note(found.final, found.prepared.slide),
        *inertia_note(found.prepared, found.final),
        *(() if load_shows else (NO_LOAD,)),
        *_offset_note(found, cov),
        *_event_note(found),
        *_limit_note(found),
        *found.hints,
        *assumed_note(found.final, found.prepared.slide),
        *_constraint_note(found),
        *timing_note(found.final, cov),
        *_rest_note(found),
        *_laws_note(found),
        *((HELD,) if found.prepared.band.zero_order_hold else ()),
        *(() if too_short else sight),
    )


def _offset_note(found: Trace, cov: Array) -> tuple[str, ...]:
    """Note that an encoder zero may be off instead of a mass."""
    prepared = found.prepared
    terms = range(len(found.findings))
    each = (term_estimates(found.final, cov, i, prepared.slide) for i in terms)
    offsets = [x for own in each if (x := offset_instead(prepared, own)) is not None]
    return tuple(
        f"An encoder that reads {x:.3g} rad too much explains the logs as well as a wrong mass: "
        "compare its zero with that of the MJCF."
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
        f"{time[at]:.4g} s: look there for a knock, a wrong reading, or a motion that is too fast "
        "for the sample rate.",
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
        f"In {share:.0%} of the samples the {prepared.drive} stands at its largest value. That is "
        "right if the drive was at its limit. If the sensor was, leave these samples out: what it "
        "hides resembles other effects.",
    )


def timing_note(fitted: Fit, cov: Array) -> tuple[str, ...]:
    """Sub-sample time offsets that differ clearly from zero."""
    said = []
    for i, term in enumerate(fitted.terms):
        if isinstance(term, Timing):
            (time,), k = term.shape, fitted.layout.numbers(i).start
            error = float(np.sqrt(max(0.0, cov[k, k])))
            if abs(time) > SURELY * error:
                said.append(term.says(f"{1e3 * abs(time):.2g} ± {1e3 * error:.1g} ms"))
    return tuple(said)


def _laws_note(found: Trace) -> tuple[str, ...]:
    if not found.other_laws.errors:
        return ()
    unit, _ = units_of(found.final, found.prepared.slide)
    own, mine = law_parameters(found.final).law, found.final.rms_in_motion
    others = ", ".join(f"{law} {left:.3g}" for law, left in found.other_laws.errors)
    return (
        f"Error in motion on fitted logs with each friction law and the same effects, {unit}: "
        f"{own} {mine:.3g} (used), {others}.",
    )


def _constraint_note(found: Trace) -> tuple[str, ...]:
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
        f"That is more than friction can hold, {level:.2g} {unit}: a stop, a brake or a contact "
        f"holds the joint at {' and '.join(where)}. Give the joint's range in the MJCF, or leave "
        "that part of the log out.",
    )


def _sight_note(found: Trace) -> tuple[str, ...]:
    sight, unit = found.sight, units_of(found.final, found.prepared.slide)[0]
    if sight.too_short:
        if found.findings or found.unexplained:
            return ()
        return (
            f"These {sight.duration:.3g} s are too short: the smallest effect that they would have "
            f"shown is {sight.torque:.2g} {unit} rms. About {sight.needed:.2g} s of such motion "
            "are needed.",
        )
    if not sight.of_each:
        return ()
    each = ", ".join(_smallest(x) for x in sight.of_each)
    lead = "The smallest further effect" if found.findings else "The smallest effect"
    return (
        f"{lead} that these logs would have shown, rms of its torque in {unit} (two numbers: of "
        f"the shape that shows best and of the one that shows worst): {each}.",
    )


def _smallest(x: Smallest) -> str:
    if not np.isfinite(x.most):  # the model can imitate it
        return f"{x.name} " + (f"{x.least:.2g} or more" if np.isfinite(x.least) else "at no size")
    least, most = f"{x.least:.2g}", f"{x.most:.2g}"
    return f"{x.name} {least}" if least == most else f"{x.name} {least} to {most}"
