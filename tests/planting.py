"""Logs to which the torque of an effect is added, along the motion that they hold."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.diagnose.candidate import Candidate, signals_of
from frictionjoint.diagnose.finding import Trace
from frictionjoint.effects.signals import TIME
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.measured.log import JointLog


def planted(
    found: Trace,
    logs: Sequence[JointLog],
    candidate: Candidate,
    rms: float,
    rng: np.random.Generator,
) -> list[JointLog]:
    """The logs with an effect of random signs.

    Args:
        found: the search in the logs, which hide nothing. rms: of its torque over all logs, N m.
    """
    term = candidate.term
    assert isinstance(term, EffectTerm)
    bounds = term.effect.bounds or ((-np.inf, np.inf),) * len(term.coefficients)
    way = np.array([1.0 if low >= 0.0 else rng.choice([-1.0, 1.0]) for low, _ in bounds])
    size = rms / float(np.sqrt(np.mean((candidate.columns @ way) ** 2)))
    changed = []
    pairs = zip(logs, found.prepared.segments, signals_of(found.prepared, found.final), strict=True)
    for log, segment, signals in pairs:
        torque = term.columns(segment, signals) @ way * size
        time = segment.signals[:, TIME] + log.time[0]
        assert log.torque is not None
        changed.append(replace(log, torque=log.torque + np.interp(log.time, time, torque)))
    return changed
