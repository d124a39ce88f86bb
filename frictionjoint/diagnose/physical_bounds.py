"""Effects with parameters that the logs push past their physical bounds."""

import math
from collections.abc import Iterator

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import LEAST_MOVED, SURELY, TIE
from frictionjoint.identify.basis import lengths, without
from frictionjoint.identify.blocks import Blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.smooth import EncoderTerm
from frictionjoint.identify.terms import DriveTerm, EffectTerm, Term

# smallest fraction of the drive's rms that effects of the drive may leave
LEAST_ACTING = 0.01


def impossible(fitted: Fit, blocks: Blocks) -> frozenset[str]:
    """Names of effects that would leave the physical range of one of their numbers.

    A number past its bound by more than its standard error, and by more torque than the usual error
    of a law, shows that the cause is another one. Bounds at zero and infinity do not count, because
    the effect vanishes there or has another form; nor do discontinuous effects, whose derivatives
    say too little. An effect is impossible too if friction would supply energy, if no drive
    remains although the joint moves, or if an encoder would count backwards.
    """
    if fitted.acting < LEAST_ACTING:
        return frozenset(t.name for t in fitted.terms if isinstance(t, DriveTerm))
    beyond = frozenset(
        term.name
        for i, term in enumerate(fitted.terms)
        if isinstance(term, EffectTerm) and not term.effect.leaps
        for k, outward in _at_ends(fitted, i, term)
        if _would_exceed_bound(fitted, blocks, k, outward)
    )
    backwards = frozenset(
        term.name
        for i, term in enumerate(fitted.terms)
        if isinstance(term, EncoderTerm)
        and term.order * np.hypot(*fitted.term_coefficients(i)) >= 1.0
    )
    return beyond.union(backwards, _below_zero_friction(fitted, blocks))


def _below_zero_friction(fitted: Fit, blocks: Blocks) -> Iterator[str]:
    """Names of effects on the friction level with which friction supplies energy in some blocks.

    Friction may return the elastic energy of its bristles, as the law alone does, but no more.
    """
    scaling = [i for i, t in enumerate(fitted.terms) if t.follows_law]
    if not scaling or "sigma2" not in fitted.names:
        return
    # torque per viscosity: the speed, behind the filter of the balance
    speed = fitted.jacobian[:, fitted.names.index("sigma2")]

    def work(torque: Array) -> Array:
        return np.asarray(np.bincount(blocks.of_sample, torque * speed, blocks.count), float)

    alone = work(fitted.friction)
    changes = {i: work(fitted.term_torque(i)) for i in scaling}
    whole = alone + np.sum(list(changes.values()), axis=0)
    turned = (alone > 0.0) & (whole < 0.0)
    given, taken = -whole[turned], whole[whole > 0.0]
    if given.sum() > max(SURELY * np.linalg.norm(given), TIE * taken.sum()):
        yield from (fitted.terms[i].name for i, w in changes.items() if w[turned].sum() < 0.0)


def exceeding_friction(fitted: Fit) -> Iterator[Term]:
    """Effects that are a part of friction, and larger than all friction in the logs.

    Only a small part of such an effect acts in the logs. Where friction falls faster than they
    resolve, the error has the form of a lag, too short and many times too large. During a search it
    may stand for what is still to be found, so only a result must not contain it.
    """
    scaling = [i for i, t in enumerate(fitted.terms) if t.follows_law]
    whole = fitted.friction + sum(fitted.term_torque(i) for i in scaling)
    for i in scaling:
        effect = fitted.terms[i].effect
        parts = zip(effect.units, effect.bounds, fitted.term_coefficients(i), strict=False)
        if any(u == "T" and low == 0.0 and c > np.max(np.abs(whole)) for u, (low, _), c in parts):
            yield fitted.terms[i]


def _at_ends(fitted: Fit, i: int, term: EffectTerm) -> Iterator[tuple[int, float]]:
    """Numbers of term i on a finite, nonzero bound, with the sign of the direction beyond it."""
    first = fitted.layout.numbers(i).start
    for k, (x, limits) in enumerate(zip(term.free_shape, term.limits, strict=True), first):
        for limit, outward in zip(limits, (-1.0, 1.0), strict=True):
            physical = math.isfinite(limit) and limit != 0.0
            if physical and fitted.bound[k] and abs(x - limit) <= 1e-3 * abs(limit):
                yield k, outward


def _would_exceed_bound(fitted: Fit, blocks: Blocks, k: int, outward: float) -> bool:
    """Whether parameter k would move past its bound if the free parameters were refitted.

    The refit is to first order. The standard error comes from the spread over blocks of time (White
    1980).
    """
    w = fitted.weight
    free = fitted.free_jacobian * w[:, None]
    column = without(fitted.jacobian[:, k] * w, free / lengths(free))
    products = np.bincount(blocks.of_sample, column * fitted.residual * w, blocks.count)
    total, error = outward * products.sum(), np.linalg.norm(products)
    moved = total / max(np.linalg.norm(column), 1e-300)
    least = LEAST_MOVED * np.linalg.norm(fitted.friction * w)
    return bool(total > SURELY * error and moved > least)
