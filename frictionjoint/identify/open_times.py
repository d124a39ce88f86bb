"""Time offsets that logs leave open, as terms of a fit."""

from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.terms import Term
from frictionjoint.identify.timing import DampingAge, DriveTiming, TargetTiming, Timing, VelocityAge


def timed(prepared: Prepared, terms: tuple[Term, ...], law: Shape) -> tuple[Term, ...]:
    """The terms, and the sub-sample time offsets that the logs leave open.

    They are: the time of a measured drive relative to its position, or of a command relative to its
    target, unless an effect states it, because channels are read one after the other. For a target
    with a delay of its own, the offset is that of the controller's tick. The age of a velocity, in
    a controller's damping or in a simulation, is assumed to be zero while an inertia or a gain
    is searched for: logs cannot distinguish them.
    """
    if any(isinstance(t, Timing) for t in terms):
        return terms
    sample = min(s.sample for s in prepared.segments)
    found: list[Timing] = []
    effects = [t.effect for t in terms]
    if not any(e.delays for e in effects):
        of_target = prepared.commanded and not any(e.delays_target for e in effects)
        found.append(TargetTiming(sample) if of_target else DriveTiming(sample))
    if (prepared.damped or law.steps) and not any(
        e.is_inertia or e.of_inertia or e.scales for e in effects
    ):
        found.append(VelocityAge(sample) if prepared.damped else DampingAge(sample))
    return (*terms, *(t for t in found if t.name not in prepared.nothing))
