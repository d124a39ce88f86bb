"""Joint multi-start fit of the law and a candidate effect.

A missing effect biases the fitted law: its Stribeck curve imitates a contact that strengthens at
rest, friction that lags, or curved viscous friction; or another law fits better because it can
imitate the effect. The biased fit is a separate local minimum, which a search does not leave when
the effect is added. It can even hide the effect: in a joint with little friction and few reversals,
a wide hysteresis imitates an offset. So before the search ends without a finding, laws are fitted
from all their starts together with each effect on the friction level or on speed, and with effects
that explain much more at such a start than the best fit of the law alone.
"""

from collections.abc import Sequence

from frictionjoint.decisions import CLEARLY, LEAST_MOVED, SIGNIFICANCE, SMALLEST_GAIN
from frictionjoint.diagnose.moves import LEADERS, Look, Looked, Move
from frictionjoint.diagnose.other_laws import OtherLaws, forms_like
from frictionjoint.diagnose.score import Scored
from frictionjoint.diagnose.state import compared
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rounding import best_of, in_order
from frictionjoint.identify.search import Place
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.starts import COARSE, ripened, screened_starts
from frictionjoint.identify.terms import EffectTerm, Term
from frictionjoint.identify.timing import Timing
from frictionjoint.threads import side_by_side


def unbent(prepared: Prepared, terms: tuple[Term, ...], laws: Sequence[Sequence[Shape]]) -> Fit:
    """Effects fitted jointly with the best of some laws, in all forms, from all starting values."""
    with side_by_side() as each:
        ripe = [
            p for some in each(lambda forms: ripened(prepared, terms, forms), laws) for p in some
        ]
    # the best forms after some steps may yet change places
    leaders = in_order(ripe, lambda place: place.cost)[:3]

    def at_its_end(place: Place) -> Fit:
        law, moved = place.search.split(place.x)
        return compared(prepared, tuple(t for t in moved if not isinstance(t, Timing)), law)

    with side_by_side() as each:
        found: Fit = best_of(list(each(at_its_end, leaders)), lambda f: f.drive_rms)
    for _ in range(4):
        # one search moves an effect's numbers only so far
        last, found = found, compared(prepared, found.effects, found.shape)
        if found.drive_rms > (1.0 - CLEARLY) * last.drive_rms:
            break
    return found


def bends(term: Term) -> bool:
    """Whether omitting this effect biases the law parameters (it acts on friction level or
    speed)."""
    return isinstance(term, EffectTerm) and (term.follows_law or term.effect.of_speed)


def candidates_to_refit_jointly(
    now: Scored, seen: Look, prepared: Prepared, laws: OtherLaws
) -> list[tuple[Move, list[Sequence[Shape]]]]:
    """Effects to refit jointly with a law, each with the laws to use.

    For every form of the law: effects whose omission biases any law, unless the present law rules
    them out. For the present law: effects that at one of its unbiased starts leave a smaller
    residual than the best fit of the law alone.

    Args:
        now: the present model. seen: its candidates.
    """
    if now.fit.effects or now.above_noise < LEAST_MOVED:
        return []
    own, coarse = forms_like(now.fit.shape), prepared.thinned(COARSE)
    alone = ripened(prepared, (), own)[0].cost
    named = [r for r in seen.rows if not r.candidate.unnamed]
    asked, rest = (
        [r for r in named if (bends(r.candidate.term) and r.p_value <= SIGNIFICANCE) == wanted]
        for wanted in (True, False)
    )

    def at_a_start(row: Looked) -> float:
        return screened_starts(coarse, (row.candidate.term,), own)[0].cost

    with side_by_side() as each:
        left = list(each(at_a_start, rest))
    most = (1.0 - SMALLEST_GAIN) * alone
    hidden = [rest[k] for k in in_order(range(len(rest)), lambda k: left[k]) if left[k] <= most]
    tried = [*((r, laws.own_forms) for r in asked), *((r, [own]) for r in hidden[:LEADERS])]
    return [(Move((r.candidate.term,), (r.candidate,), r.left, seen), forms) for r, forms in tried]
