"""Effects tried with the law fitted from everywhere.

What a model lacks bends its law: a Stribeck curve takes up what a contact gains at rest, what
friction follows late, or how viscous friction curves; or another law, whose curves have room for
it, seems to be the joint's. The bent law is a valley of its own, which a search that starts there
does not leave when the effect is added. So before nothing is named, laws are fitted from all their
starts together with each effect on the friction level or on speed.
"""

from collections.abc import Sequence

from frictionjoint.diagnose.decisions import DISCREPANCY
from frictionjoint.diagnose.moves import Look, Move
from frictionjoint.diagnose.score import Scored
from frictionjoint.diagnose.state import compared
from frictionjoint.identify.clearly import CLEARLY
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.starts import ripened
from frictionjoint.identify.terms import EffectTerm, Term, Timing
from frictionjoint.threads import side_by_side

# further searches from where the first one led: each follows where the last was clearly nearer
_SEARCHES = 4


def unbent(prepared: Prepared, terms: tuple[Term, ...], laws: Sequence[Sequence[Shape]]) -> Fit:
    """These effects with the best of some laws, each fitted from everywhere in all its forms."""
    with side_by_side() as each:
        places = list(each(lambda forms: ripened(prepared, terms, forms)[0], laws))
    place = min(places, key=lambda place: place.cost)
    law, moved = place.search.split(place.x)
    found = compared(prepared, tuple(t for t in moved if not isinstance(t, Timing)), law)
    for _ in range(_SEARCHES):
        # one search moves an effect's numbers only so far
        last, found = found, compared(prepared, found.effects, found.shape)
        if found.drive_rms > (1.0 - CLEARLY) * last.drive_rms:
            break
    return found


def bends(term: Term) -> bool:
    """Whether a law may have bent for want of it: it acts on the friction level, or on speed."""
    return isinstance(term, EffectTerm) and (term.follows_law or term.effect.of_speed)


def worth_unbending(now: Scored, seen: Look, most: float) -> list[Move]:
    """The effects that a law bends for, where a law alone leaves enough for one.

    Args:
        now: the present model. most: p-value of those tried.
    """
    if now.fit.effects or now.above_noise < DISCREPANCY:
        return []
    rows = [r for r in seen.rows if bends(r.candidate.term) and r.p_value <= most]
    return [Move((r.candidate.term,), (r.candidate,), r.left) for r in rows]
