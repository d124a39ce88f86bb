"""The verdict: explained, partly explained, no effect found, or too short to tell."""

import numpy as np

from frictionjoint.decisions import AS_WHITE, AT_THE_FLOOR, LEAST_NOISE
from frictionjoint.diagnose.finding import Trace
from frictionjoint.identify.blocks import correlation_time
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rms import Rms
from frictionjoint.identify.segment import Prepared
from frictionjoint.report.joint_report import Verdict

# ratio of the noise of two logs beyond which one contains torque above its band; the noise of a
# short log is known to 10%
_SAME_NOISE = 1.5


def noise_floor(prepared: Prepared, gain: float) -> float:
    """Residual of a perfect model due to instrument noise in the torque band, N m.

    The torque's noise is estimated above the motion's band, where jerks and chatter of a stiff
    controller add to it. Logs share their instruments, so the quietest log determines the noise.
    """
    least = min((x for s in prepared.segments if (x := s.noise.torque) > 0.0), default=0.0)
    powers = []
    for s in prepared.segments:
        torque, position = s.noise.left(s.bandwidth_hz)
        if s.noise.torque > _SAME_NOISE * least:
            torque *= least / s.noise.torque
        powers.append(torque + position)
    return gain * float(np.sqrt(np.mean(powers)))


def verdict(
    found: Trace, before: tuple[Rms, Rms], after: tuple[Rms, Rms], diverges: bool
) -> Verdict:
    """`explained` requires a residual at the level of the instrument noise, or as white as noise
    where that level is unknown.

    It is not given if held-out logs or the replay contradict it or have more than twice the torque
    error, if the replay diverges, or if an added parameter reached the end of its range.

    Args:
        before, after: errors of torque and replay.
        diverges: whether a replay of the final model leaves the measured motion altogether.
    """
    if not found.findings and not found.unexplained:
        return "too-short-to-tell" if found.detection_limit.too_short else "no-effect-found"
    worse = diverges or any(a.worse_than(b) for b, a in zip(before, after, strict=True))
    contradicted = worse or after[0].only_fitted
    final = found.final
    own = (final.layout.of_term(i) for i in range(len(final.effects)))
    at_a_bound = any(bool(final.bound[at].any()) for at in own)
    if not found.findings or found.unexplained or contradicted or at_a_bound:
        return "partly-explained"
    noise, left = noise_floor(found.prepared, final.gain), final.rms_in_motion
    # an error far below an estimate of the noise contradicts the estimate
    if noise < LEAST_NOISE * final.target_rms or left < noise / AT_THE_FLOOR:
        as_noise = _is_white(final, found.prepared)
    else:
        as_noise = left <= AT_THE_FLOOR * noise
    return "explained" if as_noise else "partly-explained"


def _is_white(fitted: Fit, prepared: Prepared) -> bool:
    """Whether the correlation time of a residual is near that of filtered white noise."""
    e = fitted.residual * fitted.weight
    for i, s in enumerate(prepared.segments):
        filtered_noise = max(1.0, 1.0 / (2.0 * s.bandwidth_hz * s.dt * s.step))
        if correlation_time(e[fitted.log_index == i]) > AS_WHITE * filtered_noise:
            return False
    return True
