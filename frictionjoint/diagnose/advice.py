"""The next motion to record: the one that would resolve what these logs cannot determine."""

from collections.abc import Iterable, Mapping

from frictionjoint.effects.catalogue import title
from frictionjoint.effects.effect import Effect
from frictionjoint.identify.result import Estimate, is_without_level
from frictionjoint.parameter_meanings import meanings
from frictionjoint.report.wording import quantity

_BREAKAWAY = "constant velocities from very slow to fast, in both directions"
_PRESLIDING = "slow motion that reverses before the joint slides"
# Which motion determines which parameters of the law.
_DETERMINED_BY = {
    _BREAKAWAY: ("Fs_pos", "Vs_pos", "delta_pos", "sigma2_pos"),
    _PRESLIDING: ("stiffness",),
}
_SHOWN_BY = {
    "position": "the whole range at two slow speeds, in both directions",
    "velocity": "constant velocities over the whole range of speed, in both directions",
    "acceleration": "one path at a speed and at twice that: accelerations are four times as large",
    "load": "one motion with two payloads",
    "torque": "one motion at growing payloads, up to the largest torque of the drive",
    "time": "one motion repeated for long, with temperature_c in the log",
    "temperature_c": "one motion with the joint cold and warm",
    "log": "the same motion in every log, with temperature_c in it",
}


def what_to_record(
    ties: Iterable[tuple[Effect, str]],
    forms: Iterable[tuple[Effect, Effect]],
    unexplained: Mapping[str, str],
    law: Mapping[str, Estimate],
    held_out: bool,
    computed: Mapping[tuple[str, ...], str],
) -> tuple[str, ...]:
    """One sentence for each question that the logs leave undetermined, most important first.

    A computed answer replaces the general one to the same question.

    Args:
        ties: an added effect and the name of another that explains as much.
        forms: an added effect and a form of it that explains as much.
        unexplained: quantities the residual still depends on, each with its cause; empty: unknown.
        law: the final estimates by name.
        held_out: whether a log was kept from fit and choice.
        computed: see `computed_proposals`.
    """
    found: dict[tuple[str, ...], str] = {
        (effect.name, other): f"To distinguish {title(effect.name)} from {title(other)}: "
        f"{effect.separating_motion}."
        for effect, other in ties
    }
    for own, other in forms:
        found[own.name, own.form, other.form] = (
            f"To determine which form of {title(own.name)} acts, '{own.form}' or '{other.form}', "
            f"which explain the logs equally well: {own.separating_motion}."
        )
    for variable, cause in unexplained.items():
        if cause:
            again = "the same motion, once its cause is corrected"
            if variable == "torque":
                again = (
                    "a motion below the torque that saturates, or the torque that acts in the log"
                )
            found[(variable,)] = f"To find what else depends on {quantity(variable)}: {again}."
            continue
        motion = "one motion at low and at high values of it"
        if variable.endswith((".position", ".velocity", ".acceleration")):
            motion = "this joint alone with the others held, then the others"
        motion = _SHOWN_BY.get(variable, motion)
        found[(variable,)] = f"To find what depends on {quantity(variable)}: {motion}."
    for motion, names in loose_parameters(law):
        found[names] = f"To determine {meanings(names)}: {motion}."
    if not held_out:
        found[("held-out",)] = (
            "To know the error on held-out data: one more log, given with --held-out."
        )
    return tuple(dict.fromkeys({**found, **computed}.values()))


def loose_parameters(law: Mapping[str, Estimate]) -> list[tuple[str, tuple[str, ...]]]:
    """Parameters of the law that the logs barely determine, grouped by the motion that would."""
    if is_without_level(law):
        return [(_BREAKAWAY, ("Fc_pos",))]
    found = []
    for motion, names in _DETERMINED_BY.items():
        loose = tuple(name for name in names if name in law and law[name].is_loose)
        if loose:
            found.append((motion, loose))
    return found
