"""Multi-start fit: every form of a law, started from a linear fit.

Each form of a law has its own local minimum, and the starting values do not show which is best. So
the search runs for some steps from every form, and to the end from the best ones.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from frictionjoint.decisions import CLEARLY
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.law_basis import LawBasis
from frictionjoint.identify.law_start import LawStart
from frictionjoint.identify.rounding import best_of, in_order
from frictionjoint.identify.search import CLOSE, ROUGH, Place, Search, nearer, with_parts
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED, IntegratedShape, Shape
from frictionjoint.identify.start import settled
from frictionjoint.identify.terms import Term, Timing, VelocityAge, timed
from frictionjoint.identify.weights import errors_of, inverse_likelihood, reweighed, weighted_by
from frictionjoint.threads import one_thread, side_by_side

# samples that a coarse look is at
COARSE = 1500
# steps of a search that only compares
COMPARING_STEPS = 8


@one_thread
def fit(
    prepared: Prepared,
    terms: tuple[Term, ...] = (),
    forms: Sequence[Shape] = INTEGRATED,
    progress: Callable[[str], None] = lambda text: None,
) -> Fit:
    """Fit terms and a law in several forms, from several starts."""
    progress(f"fitting the friction law in {len(forms)} forms")
    followed = _followed(_screened(prepared, terms, forms))
    # the two best forms, if the second costs at most twice as much
    finalists = [p for p in followed if p.cost <= 2.0 * followed[0].cost][:2]
    final, steps = [], 15
    for place in finalists:
        shape, moved = place.search.split(place.x)
        search = Search(prepared, moved, nearer(prepared, moved, shape.last_choices()))
        final.append(search.run(search.start, steps, ROUGH))
    best = best_of(final, lambda place: place.cost)
    found = best.search.run(best.x, steps, CLOSE)
    return with_parts(prepared, found.search.result(found.x), steps, CLOSE)


def law_alone(
    prepared: Prepared,
    forms: Sequence[Shape] = INTEGRATED,
    progress: Callable[[str], None] = lambda text: None,
    open_times: tuple[type[Timing], ...] = (VelocityAge,),
) -> tuple[Prepared, Fit]:
    """First fit of a law alone, with the initial states of its logs; see `with_times`.

    Weights and fit depend on each other: where a law errs at rest, samples at rest count less, and
    a law fitted to them errs less there and more in sliding. So the fit begins once with the error
    at rest that a linear fit leaves, and, if the logs hold any rest, once with friction at rest
    unknown. The second fit is the result if fewer of its numbers are at an end of their range, or
    if it is clearly likelier.
    """

    def made(rest_unknown: bool) -> tuple[Prepared, Fit]:
        weighed, known = _first_look(prepared, forms, rest_unknown)
        found = with_times(weighed, partial(fit, forms=known, progress=progress), open_times)
        return reweighed(*settled(*reweighed(*found)))

    found = made(False)
    if not errors_of(*found).sticking:
        return found
    other = made(True)
    ended, its = found[1].ended, other[1].ended
    if ended != its:
        return found if ended < its else other
    likelier = inverse_likelihood(*other) < (1.0 - CLEARLY) * inverse_likelihood(*found)
    return other if likelier else found


def _first_look(
    prepared: Prepared, forms: Sequence[Shape], rest_unknown: bool
) -> tuple[Prepared, Sequence[Shape]]:
    """Logs weighted by linear fits of friction, and the forms to fit.

    Forms are damped if a linear fit with damping has less than half of the residual, because no
    search without damping approaches such a contact. Weaker damping is added later, see
    `base_fit.with_last_freedoms`.
    """
    basis, top = LawBasis(prepared), prepared.top_speed
    # each linear fit determines the weights for the next
    for _ in range(2):
        law = basis.fitted(forms[0], (), prepared.weight)
        parts = [law.sticking(s, top) for s in prepared.segments]
        fractions, stiffnesses = zip(*parts, strict=True)
        at_rest = law.level, law.residual, rest_unknown
        prepared = weighted_by(prepared, fractions, stiffnesses, *at_rest)
    damped, without = (basis.fitted(forms[0], (), prepared.weight, x) for x in (True, False))
    if damped.rms < 0.5 * without.rms:
        forms = [f.with_damping() if isinstance(f, IntegratedShape) else f for f in forms]
    return prepared, forms


def with_times(
    prepared: Prepared, made: Callable[[Prepared], Fit], open_times: tuple[type[Timing], ...]
) -> tuple[Prepared, Fit]:
    """Logs and a fit of them, without time offsets that reach the end of their range: they are no
    sampling offsets, but replace an inertia error too large for any offset within a sample."""
    found = made(prepared)
    ended = {t.name for t in found.terms if isinstance(t, open_times) and t.at_its_end}
    if ended:
        prepared = replace(prepared, nothing=prepared.nothing | ended)
        found = made(prepared)
    return prepared, found


@one_thread
def refined_starts(
    prepared: Prepared, terms: tuple[Term, ...], forms: Sequence[Shape]
) -> list[Place]:
    """Each form of a law after some steps of a coarse search, best first, with its costs."""
    return _followed(_screened(prepared.thinned(COARSE), terms, forms))


@one_thread
def _screened(prepared: Prepared, terms: tuple[Term, ...], forms: Sequence[Shape]) -> list[Place]:
    """The best start of each form of a law, with the solved coefficients, best first."""
    linear = LawBasis(prepared).fitted(forms[0], terms, prepared.weight)
    start = LawStart.of(linear.reaches, linear.levels, prepared.top_speed)
    terms = timed(prepared, terms, forms[0])

    def best(form: Shape) -> Place:
        places = []
        for law in form.started(start):
            search = Search(prepared, terms, law)
            places.append(Place(0.5 * search.squares(search.start), search, search.start))
        return best_of(places, lambda place: place.cost)

    with side_by_side() as each:
        return in_order(list(each(best, forms)), lambda place: place.cost)


def _followed(places: Sequence[Place]) -> list[Place]:
    """Results of some steps from each, best first."""
    with side_by_side() as each:
        found = list(each(lambda p: p.search.run(p.x, COMPARING_STEPS, ROUGH), places))
    return in_order(found, lambda place: place.cost)
