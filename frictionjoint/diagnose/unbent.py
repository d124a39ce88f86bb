"""Effects tried with the law fitted from everywhere.

What a model lacks bends its law: a Stribeck curve takes up what a contact gains at rest, or what
friction follows late. The bent law is a valley of its own, which a search that starts there does
not leave when the effect is added. So the law is fitted from all its starts together with an effect
on the friction level, where the present law with it is not enough to decide.
"""

from frictionjoint.diagnose.decisions import DISCREPANCY
from frictionjoint.diagnose.laws import LAW_FORMS
from frictionjoint.diagnose.library import Candidate
from frictionjoint.diagnose.moves import Look, Move
from frictionjoint.diagnose.score import Scored
from frictionjoint.diagnose.state import compared
from frictionjoint.identify.clearly import CLEARLY
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.starts import ripened
from frictionjoint.identify.terms import Term, Timing

# effects that are tried, those that promise most at the present law
MOST = 2
# further searches from where the first one led: each follows where the last was clearly nearer
_SEARCHES = 4


def unbent(prepared: Prepared, terms: tuple[Term, ...], fitted: Fit) -> Fit:
    """These effects with the law of a fit, in all its forms, fitted from everywhere."""
    place = ripened(prepared, terms, LAW_FORMS[fitted.shape.variables])[0]
    law, moved = place.search.split(place.x)
    found = compared(prepared, tuple(t for t in moved if not isinstance(t, Timing)), law)
    for _ in range(_SEARCHES):
        # one search moves an effect's numbers only so far
        last, found = found, compared(prepared, found.effects, found.shape)
        if found.drive_rms > (1.0 - CLEARLY) * last.drive_rms:
            break
    return found


def bends(candidate: Candidate) -> bool:
    """Whether it acts on the friction level, so that a law may have bent for want of it."""
    return not candidate.unnamed and candidate.term.follows_law


def worth_unbending(now: Scored, seen: Look, most: float) -> list[Move]:
    """The most promising effects on the friction level, where a law alone leaves enough for one.

    Args:
        now: the present model. most: p-value of those tried.
    """
    if now.fit.effects or now.above_noise < DISCREPANCY:
        return []
    rows = [r for r in seen.rows if bends(r.candidate) and r.p_value <= most][:MOST]
    return [Move((r.candidate.term,), (r.candidate,), r.left) for r in rows]
