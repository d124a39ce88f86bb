"""What a reader must know of a result beside its figures, a sentence or two each."""

from frictionjoint.arrays import Array
from frictionjoint.diagnose.loop import Trace
from frictionjoint.diagnose.timing import Delay, timing_of
from frictionjoint.identify.prepare import Prepared
from frictionjoint.identify.result import law_parameters


def notes(found: Trace, prepared: Prepared, cov: Array) -> tuple[str, ...]:
    """All that there is to say.

    Args:
        prepared: the logs with all their samples. cov: of all parameters of the final fit.
    """
    return (
        *_rest_note(prepared, found.prepared),
        *timing_note(timing_of(found.final, cov)),
        *_law_note(found),
    )


def timing_note(delay: Delay | None) -> tuple[str, ...]:
    """What the fit made of the clocks of its channels."""
    if not delay:
        return ()
    of_two, first = ("torque", "position") if delay.value > 0.0 else ("position", "torque")
    return (
        f"In these logs a {first} belongs to the {of_two} logged {1e3 * abs(delay.value):.2g} ms "
        f"earlier (standard error {1e3 * delay.stderr:.1g} ms): less than a sample, as where a "
        "controller holds its torque from one tick to the next. The final fit allows for it.",
    )


def _law_note(found: Trace) -> tuple[str, ...]:
    """Which friction law is better and what that means, where it is not the one of the base fit."""
    if not found.other:
        return ()
    own, final, other = (law_parameters(f).law for f in (found.base, found.final, found.other))
    unit = "N" if found.prepared.slide else "N m"
    left = f"{found.final.rms:.3g} {unit} on fitted logs, {other} {found.other.rms:.3g} {unit}"
    if own != final:
        return (
            f"The friction law {final} takes the place of {own}: with the same effects it leaves "
            f"{left}. --law {own} keeps {own}.",
        )
    return (
        f"The effects were looked for with the law {other} and then added to {final}, which "
        f"leaves {left}. --law {other} reports and simulates that law.",
    )


def _rest_note(prepared: Prepared, moving: Prepared) -> tuple[str, ...]:
    """What a reader must know of the samples behind the figures."""
    if moving.rest_speed == 0.0:
        return ()
    share = 1.0 - moving.samples / prepared.samples
    unit = "m/s" if prepared.slide else "rad/s"
    return (
        f"Below {moving.rest_speed:.2g} {unit} the measured position does not tell the torque: no "
        f"presliding is resolved there. These samples and those that the filter mixes with them "
        f"({share:.0%}) are in neither the fits nor the torque errors.",
    )
