"""Alternatives to each shared cause, recomputed on the final model.

While causes are missing, many candidates look alike. A candidate that was as good as a cause when
it was accepted may be far worse together with all the others, or be in the model itself by then.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from frictionjoint.arrays import Array
from frictionjoint.identify.rounding import EQUAL
from frictionjoint.robot.candidate import Candidate, columns_of
from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.choose import Choice
from frictionjoint.robot.clock import Clock
from frictionjoint.robot.compare import as_much
from frictionjoint.robot.found import Found
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.screen import Screened, screen
from frictionjoint.robot.settle import squares_left


def restated(
    joints: Sequence[FittedJoint],
    clock: Clock,
    found: Found,
    choices: Sequence[Choice],
    causes: Sequence[Cause],
    single_effects: frozenset[str],
) -> tuple[Choice, ...]:
    """The evidence of the causes, with the ties that remain.

    Args:
        joints: with their laws fitted under `found`. choices: of its causes, with their earlier
            ties.
        causes: all candidates. single_effects: labels of effects of single joints in the model.
    """
    left = squares_left(joints, clock, found, single_effects)
    there = {c.label for c in found.causes} | single_effects
    kept = []
    for i, choice in enumerate(choices):
        wanted = frozenset(choice.evidence.ties) - there
        ties: tuple[str, ...] = ()
        if wanted:
            own, rest = found.causes[i], found.without(i)
            rivals = [c for c in causes if c.label in wanted and c.changed != own.changed]
            at = [j.corrected(rest.state) for j in joints]
            named, here = (single_effects | wanted).__contains__, joints[0].common_effects
            seen = screen(at, clock, rest, [own, *rivals], named, here, joints)
            ties = tuple(c.label for c in _as_good(seen, own, wanted, left))
        evidence = replace(choice.evidence, ties=tuple(dict.fromkeys(ties)))
        kept.append(replace(choice, evidence=evidence))
    return tuple(kept)


def _as_good(
    seen: Screened, own: Cause, wanted: frozenset[str], left: Array
) -> Iterator[Candidate]:
    """Those `wanted` whose residual is as small as `left`, the model's with its `own` cause."""
    open_ones = [c for c in seen.candidates if c.label in wanted]
    itself = next(c for c in seen.candidates if c.cause == own)
    stand = [c for c in seen.candidates if c is not itself and c.label not in wanted]

    def squares(*several: Candidate) -> Array:
        return seen.stack.held_out(columns_of((*seen.accepted, *stand, *several)))

    alone = float(squares(itself).sum())
    for c in open_ones:
        # a column that adds nothing is the same cause under the name of a joint's effect
        same = abs(float(squares(itself, c).sum()) - alone) <= EQUAL * alone
        if not same and as_much(seen.stack, squares(c), left):
            yield c
