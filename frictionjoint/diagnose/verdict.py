"""What a result amounts to: explained, in part, or nothing found."""

from frictionjoint.diagnose.blocks import correlation_time
from frictionjoint.diagnose.floor import AT_THE_FLOOR
from frictionjoint.diagnose.loop import Trace
from frictionjoint.diagnose.report_data import Rms, Verdict
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.prepare import Prepared

# times the correlation of filtered white noise up to which a residual is as white
_WHITE = 3.0


def verdict(
    found: Trace, unexplained: bool, prepared: Prepared, floor: float, before: Rms, after: Rms
) -> Verdict:
    """Explained is said only of a residual down to the torque's noise, or as white as noise.

    Nor is it said where held-out logs contradict.

    Args:
        unexplained: the residual still depends on a measured quantity.
        floor: noise of the torque, N m. before, after: errors of the torque.
    """
    if not found.steps and not unexplained:
        return "no-effect-found"
    if not found.steps or unexplained or after.worse_than(before):
        return "partly-explained"
    at_floor = found.final.rms <= AT_THE_FLOOR * floor
    return "explained" if at_floor or _is_white(found.final, prepared) else "partly-explained"


def _is_white(fitted: Fit, prepared: Prepared) -> bool:
    """Whether a residual is correlated hardly longer than filtered white noise is."""
    for i, s in enumerate(prepared.segments):
        filtered_noise = max(1.0, 1.0 / (2.0 * s.bandwidth_hz * s.dt * s.step))
        if correlation_time(fitted.residual[fitted.log_index == i]) > _WHITE * filtered_noise:
            return False
    return True
