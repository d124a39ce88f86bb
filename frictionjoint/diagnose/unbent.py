"""Effects tried with the law fitted from everywhere.

What a model lacks bends its law: a Stribeck curve takes up what a contact gains at rest, what
friction follows late, or how viscous friction curves; or another law, whose curves have room for
it, seems to be the joint's. The bent law is a valley of its own, which a search that starts there
does not leave when the effect is added. It may even say that the effect is not there: where a joint
hardly rubs and turns round seldom, a wide hysteresis stands in for an offset. So before nothing is
named, laws are fitted from all their starts together with each effect on the friction level or on
speed, and with those that explain much more at such a start than the law alone at its best.
"""

from collections.abc import Sequence

from frictionjoint.diagnose.decisions import DISCREPANCY, SIGNIFICANCE, SMALLEST_GAIN
from frictionjoint.diagnose.moves import Look, Looked, Move
from frictionjoint.diagnose.other_laws import OtherLaws, forms_like
from frictionjoint.diagnose.score import Scored
from frictionjoint.diagnose.state import compared
from frictionjoint.identify.clearly import CLEARLY
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rounding import best_of, in_order
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.starts import ripened, unripe
from frictionjoint.identify.terms import EffectTerm, Term
from frictionjoint.identify.timing import Timing
from frictionjoint.threads import side_by_side

# further searches from where the first one led: each follows where the last was clearly nearer
_SEARCHES = 4
# effects that are tried because they leave less where nothing has bent the law, the best first
_MOST = 4


def unbent(prepared: Prepared, terms: tuple[Term, ...], laws: Sequence[Sequence[Shape]]) -> Fit:
    """These effects with the best of some laws, each fitted from everywhere in all its forms."""
    with side_by_side() as each:
        places = list(each(lambda forms: ripened(prepared, terms, forms)[0], laws))
    place = best_of(places, lambda place: place.cost)
    law, moved = place.search.split(place.x)
    found = compared(prepared, tuple(t for t in moved if not isinstance(t, Timing)), law)
    for _ in range(_SEARCHES):
        # one search moves an effect's numbers only so far
        last, found = found, compared(prepared, found.effects, found.shape)
        if found.drive_rms > (1.0 - CLEARLY) * last.drive_rms:
            break
    return found


def bends(term: Term) -> bool:
    """Whether any law is apt to bend for want of it: it acts on the friction level, or on speed."""
    return isinstance(term, EffectTerm) and (term.follows_law or term.effect.of_speed)


def worth_unbending(
    now: Scored, seen: Look, prepared: Prepared, laws: OtherLaws
) -> list[tuple[Move, list[Sequence[Shape]]]]:
    """Effects for want of which a law alone may have bent, each with the laws to fit beside it.

    With every form of the law those that any is apt to bend for, unless the law as it is denies
    them; with the law as it is those that leave less at one of its starts, where nothing has bent
    it yet, than it does alone at its best.

    Args:
        now: the present model. seen: the candidates beside it.
    """
    if now.fit.effects or now.above_noise < DISCREPANCY:
        return []
    own = forms_like(now.fit.shape)
    alone = ripened(prepared, (), own)[0].cost
    named = [r for r in seen.rows if not r.candidate.unnamed]
    asked, rest = (
        [r for r in named if (bends(r.candidate.term) and r.p_value <= SIGNIFICANCE) == wanted]
        for wanted in (True, False)
    )

    def at_a_start(row: Looked) -> float:
        return unripe(prepared, (row.candidate.term,), own)[0].cost

    with side_by_side() as each:
        left = list(each(at_a_start, rest))
    most = (1.0 - SMALLEST_GAIN) * alone
    hidden = [rest[k] for k in in_order(range(len(rest)), lambda k: left[k]) if left[k] <= most]
    tried = [*((r, laws.own_forms) for r in asked), *((r, [own]) for r in hidden[:_MOST])]
    return [(Move((r.candidate.term,), (r.candidate,), r.left), forms) for r, forms in tried]
