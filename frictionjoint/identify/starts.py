"""The only search among many starts: forms of the law, speeds and lengths it may have.

A coarse look at the logs tries all; the best few of each law ripen there, and the best of those are
refined on all samples.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rounding import best_of, in_order
from frictionjoint.identify.search import CLOSE, ROUGH, Place, Search, nearer, timed, with_parts
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED, Shape
from frictionjoint.identify.start import settled
from frictionjoint.identify.terms import Term
from frictionjoint.identify.timing import Timing, VelocityAge
from frictionjoint.identify.weights import reweighed
from frictionjoint.threads import one_thread, side_by_side

# samples that the coarse look is at
_COARSE = 1500
# starts of a law that ripen, for each of its forms and at most: the best two of a form come to the
# same minimum as all others, but for a few thousandths of the squares
_OF_A_FORM, _RIPENING = 2, 4
# steps for which they do, and for which the best do on all samples
_STEPS, _FEW = 10, 4
# cost over the best one's up to which a start is tried on all samples
_NEAR_BEST, _FINALISTS = 1.3, 2


@one_thread
def fit(
    prepared: Prepared,
    terms: tuple[Term, ...] = (),
    forms: Sequence[Shape] = INTEGRATED,
    progress: Callable[[str], None] = lambda text: None,
) -> Fit:
    """Fit a law and terms from many starts.

    Args:
        forms: of the law, each tried from its own grid.
    """
    ripe = ripened(prepared, terms, forms, progress)
    finalists = [p for p in ripe if p.cost <= _NEAR_BEST * ripe[0].cost][:_FINALISTS]
    final = []
    for i, place in enumerate(finalists):
        progress(f"fitting the friction law to all samples, {i + 1} of {len(finalists)}")
        shape, moved = place.search.split(place.x)
        search = Search(prepared, moved, nearer(prepared, moved, shape.last_choices()))
        final.append(search.run(search.start, _FEW, ROUGH))
    best = best_of(final, lambda place: place.cost)
    found = best.search.run(best.x, _STEPS, CLOSE)
    return with_parts(prepared, found.search.result(found.x), _STEPS, CLOSE)


def law_alone(
    prepared: Prepared,
    forms: Sequence[Shape] = INTEGRATED,
    progress: Callable[[str], None] = lambda text: None,
    open_times: tuple[type[Timing], ...] = (VelocityAge,),
) -> tuple[Prepared, Fit]:
    """Fit a law alone for the first time, with what its logs held when they began.

    Args:
        open_times: see `with_times`.
    """

    def made(own: Prepared) -> Fit:
        return fit(own, forms=forms, progress=progress)

    prepared, found = with_times(prepared, made, open_times)
    return reweighed(*settled(*reweighed(prepared, found)))


def with_times(
    prepared: Prepared, made: Callable[[Prepared], Fit], open_times: tuple[type[Timing], ...]
) -> tuple[Prepared, Fit]:
    """Logs and a fit of them, without those of some times that come to the end of their sample.

    They are none of sampling: the inertia is wrong by more than such a time may stand for.
    """
    found = made(prepared)
    ended = {t.name for t in found.terms if isinstance(t, open_times) and t.at_its_end}
    if ended:
        prepared = replace(prepared, nothing=prepared.nothing | ended)
        found = made(prepared)
    return prepared, found


@one_thread
def ripened(
    prepared: Prepared,
    terms: tuple[Term, ...],
    forms: Sequence[Shape],
    progress: Callable[[str], None] = lambda text: None,
) -> list[Place]:
    """The best places of a coarse look, best first; costs are those of the coarse look."""
    places = unripe(prepared, terms, forms, progress)
    best = places[: min(_OF_A_FORM * len(forms), _RIPENING)]
    with side_by_side() as each:
        ripe = list(each(lambda p: p.search.run(p.x, _STEPS, ROUGH), best))
    return in_order(ripe, lambda place: place.cost)


@one_thread
def unripe(
    prepared: Prepared,
    terms: tuple[Term, ...],
    forms: Sequence[Shape],
    progress: Callable[[str], None] = lambda text: None,
) -> list[Place]:
    """All starts of a law in a coarse look, with what the rest comes to there, best first."""
    terms = timed(prepared, terms, forms[0])
    coarse = prepared.thinned(_COARSE)

    def tried(form: Shape) -> list[Place]:
        search = Search(coarse, terms, form)
        starts = [search.vector(law) for law in form.grid(search.vmax, search.balance.span)]
        return [Place(0.5 * float(np.sum(search.residual(x) ** 2)), search, x) for x in starts]

    places: list[Place] = []
    with side_by_side() as each:
        for i, found in enumerate(each(tried, forms)):
            progress(f"fitting the friction law, {i + 1} of {len(forms)}")
            places += found
    return in_order(places, lambda place: place.cost)
