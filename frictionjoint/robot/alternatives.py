"""Alternatives to each shared cause on the final model, and whether the logs agree on its size.

While causes are missing, many candidates look alike. A candidate that was as good as a cause when
it was accepted may be far worse together with all the others, or be in the model itself by then.
Another name of the same change of a body may be as good only with the final laws.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import SIGNIFICANCE, SMALLEST_GAIN
from frictionjoint.effects.catalogue import title
from frictionjoint.identify.rounding import EQUAL
from frictionjoint.recordings.between import Between
from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.choose import Choice
from frictionjoint.robot.compare import as_good
from frictionjoint.robot.screen import Screened, screen
from frictionjoint.robot.settle import Settled


def with_alternatives(settled: Settled, causes: Sequence[Cause]) -> tuple[Choice, ...]:
    """The evidence for each cause of a model, with the alternatives that remain on this model."""
    found, joints, single_effects = settled.found, settled.joints, settled.single_effects
    left = settled.squares_left()
    there = {c.label for c in found.causes} | single_effects
    kept = []
    for i, choice in enumerate(settled.choices):
        wanted = frozenset(choice.evidence.ties) - there
        own, rest = found.causes[i], settled.corrected(found.without(i))
        ties = dict.fromkeys(_renamed(rest, own, causes, left))
        if wanted:
            rivals = [c for c in causes if c.label in wanted and c.changed != own.changed]
            named, common = (single_effects | wanted).__contains__, joints[0].common_effects
            seen = screen(
                rest.joints, rest.clock, rest.found, [own, *rivals], named, common, joints
            )
            ties |= dict.fromkeys(_as_good(seen, own, wanted, left))
        kept.append(replace(choice, evidence=replace(choice.evidence, ties=tuple(ties))))
    return tuple(kept)


def _renamed(rest: Settled, own: Cause, causes: Sequence[Cause], left: Array) -> Iterator[str]:
    """Labels of other causes that change the same body as `own`, a cause of the model, with no more
    parameters and a residual as small as `left`, the model's; `rest` is the model without `own`."""
    for c in causes:
        other = c.changed == own.changed and c.label != own.label
        if other and len(c.start) <= len(own.start):
            # they are nonlinear far from the nominal parameters
            trial = rest.fitted_with([c])
            if as_good(trial.screened().stack, trial.squares_left(), left):
                yield c.label


def _as_good(seen: Screened, own: Cause, wanted: frozenset[str], left: Array) -> Iterator[str]:
    """Labels among `wanted` whose residual is as small as `left`, that of the model with `own`."""
    open_ones = [c for c in seen.candidates if c.label in wanted]
    itself = next(c for c in seen.candidates if c.cause == own)
    stand = [c for c in seen.candidates if c is not itself and c.label not in wanted]
    alone = float(seen.held_out((*stand, itself)).sum())
    for c in open_ones:
        # a column that adds nothing is the same cause under the name of a joint's effect
        both = float(seen.held_out((*stand, itself, c)).sum())
        same = abs(both - alone) <= EQUAL * alone
        if not same and as_good(seen.stack, seen.held_out((*stand, c)), left):
            yield c.label


def disagreements(shared: Settled) -> tuple[str, ...]:
    """A note for each cause of which single logs show different parts.

    The part that a log shows is found to first order, along the change of the cause's numbers,
    with the laws and the other causes common to all logs. Logs disagree if parts of their own
    remove as much of the residual as an effect that is named.
    """
    log, names = shared.clock.log, [name for name, _ in shared.clock.number]
    if len(names) < 2:
        return ()
    seen, notes, blocks = shared.screened(), [], np.bincount(log)
    left = dict(zip([j.name for j in seen.stack.joints], seen.stack.squares, strict=True))
    for own, choice, x in zip(seen.accepted, shared.choices, shared.found.numbers, strict=True):
        others = np.setdiff1d(seen.columns(seen.candidates), own.at)
        grams, scores = seen.stack.products(own.at, others)
        # of each block: squares of the torque that the cause moves, and product with the residual
        moved, along = np.einsum("i,bij,j->b", x, grams, x), scores @ x
        squares, product = (np.bincount(log, y) for y in (moved, along))
        acts = squares > 1e-3 * squares.max(initial=0.0)
        if acts.sum() < 2:
            continue
        part = np.divide(product, squares, out=np.zeros(len(names)), where=acts)[acts]
        missed = along[acts[log]] - np.repeat(part, blocks[acts]) * moved[acts[log]]
        variance = np.bincount(log[acts[log]], missed**2, len(names)) * blocks / (blocks - 1)
        error = np.sqrt(variance[acts]) / squares[acts]
        between = Between(part, error, float(np.sum(blocks[acts] - 1)))
        mean = squares[acts] @ part / squares[acts].sum()
        removed = squares[acts] @ (part - mean) ** 2
        if between.p_value > SIGNIFICANCE:
            continue
        if removed < SMALLEST_GAIN * sum(left[name].sum() for name in own.joints):
            continue
        pairs = zip(np.array(names)[acts], part, error, strict=True)
        each = ", ".join(f"{name} {1.0 + p:.2g} ± {e:.1g}" for name, p, e in pairs)
        notes.append(
            f"The logs disagree on {title(choice.candidate.label)}: of the stated change they show "
            f"{each} (1: all of it). If a load was changed between them, analyse those with one "
            "load together."
        )
    return tuple(notes)
