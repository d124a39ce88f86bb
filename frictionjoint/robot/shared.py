"""What a robot's joints show together: the search for shared causes, as its definition reads.

fit every joint's law; repeat: screen every shared cause over all joints, take what is
justified, fit causes and laws together, leave out what is no longer needed; until none comes.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from frictionjoint.identify.gate import scale_is_determined
from frictionjoint.robot.causes.catalogue import catalogue
from frictionjoint.robot.choose import Choice, choose, idle
from frictionjoint.robot.corrections import Corrections
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.screen import Found, screen
from frictionjoint.robot.settle import Each, Settled, numbers_of, settle

_MOST_ROUNDS = 10


@dataclass(frozen=True)
class Shared:
    """Outcome of the search.

    Attributes:
        settled: causes with their numbers and the joints under them. choices: one a cause.
    """

    settled: Settled
    choices: tuple[Choice, ...]


def shared_causes(
    joints: Sequence[FittedJoint],
    moving: Sequence[str],
    each: Each[FittedJoint, FittedJoint],
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
) -> Shared:
    """Run the search.

    Joints whose torque is known only up to a gain that their logs do not determine take no part.

    Args:
        joints: with their laws fitted under the model as it is. moving: joints whose motion the
            logs hold. each: a `map`, perhaps of processes.
        seed: of flips and halves; equal seeds give equal results.
        progress: called with what is being done.
    """
    rng = np.random.default_rng(seed)
    model = joints[0].alongs[0].model
    none = Found(Corrections.none(model))
    known = [j for j in joints if scale_is_determined(j.prepared, j.fit)]
    if not known:
        return Shared(settle(joints, none, each), ())
    causes = catalogue(model, [j.name for j in known], moving)
    now = settle(known, none, each)
    choices: list[Choice] = []
    beside: frozenset[str] = frozenset()
    for turn in range(1, _MOST_ROUNDS + 1):
        progress(f"shared causes, round {turn}: trying candidates")
        open_ones = [c for c in causes if c not in now.found.causes]
        seen = choose(screen(now.joints, now.clock, now.found, open_ones), rng)
        own = frozenset(c.candidate.label for c in seen if c.candidate.cause is None)
        new = [c for c in seen if c.candidate.cause is not None]
        if not new:
            break
        progress(f"round {turn}: {', '.join(c.candidate.label for c in new)}")
        # effects of single joints were found under causes that have changed since
        beside = own
        found, choices = _with(now.found, choices, new)
        now = settle(now.joints, found, each, beside, any(c.bends for c in new))
        now, choices = _without_idle(now, choices, each, beside)
    return Shared(now, tuple(choices))


def _with(found: Found, choices: list[Choice], new: Sequence[Choice]) -> tuple[Found, list[Choice]]:
    """With causes that come in; a richer form of one goes in the simpler one's place."""
    for choice in new:
        cause = choice.candidate.cause
        assert cause is not None
        at = [i for i, c in enumerate(choices) if c.candidate.label == choice.candidate.label]
        for i in at:
            found, choices = found.without(i), choices[:i] + choices[i + 1 :]
        numbers = numbers_of(choice.candidate, choice.numbers, cause.start)
        found, choices = found.with_cause(cause, numbers), [*choices, choice]
    return found, choices


def _without_idle(
    now: Settled,
    choices: list[Choice],
    each: Each[FittedJoint, FittedJoint],
    beside: frozenset[str],
) -> tuple[Settled, list[Choice]]:
    """Leave out, one by one, causes without which the robot is predicted as well."""
    while now.found.causes:
        seen = screen(now.joints, now.clock, now.found, (), lambda label: label in beside)
        i = idle(seen, now.found.numbers)
        if i is None:
            break
        choices = choices[:i] + choices[i + 1 :]
        now = settle(now.joints, now.found.without(i), each, beside)
    return now, choices
