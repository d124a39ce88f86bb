"""Whether the logs agree on the size of a shared cause: a payload may have changed between them."""

import numpy as np

from frictionjoint.decisions import SIGNIFICANCE, SMALLEST_GAIN
from frictionjoint.effects.catalogue import title
from frictionjoint.recordings.between import Between
from frictionjoint.robot.settle import Settled


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
