"""Changes of a model: add, exchange, or add two effects; all are screened, few are refitted."""

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.candidate import Candidate, kind_of
from frictionjoint.diagnose.chance import p_values
from frictionjoint.diagnose.gram import Columns, Screen, screen
from frictionjoint.identify.blocks import Blocks, halves
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rounding import EQUAL, first_least, in_order
from frictionjoint.identify.terms import Term, in_place
from frictionjoint.threads import side_by_side

# the most promising effects, and alternatives to one or without a name, that are refitted
LEADERS, ALTERNATIVES = 4, 2

Kind = tuple[tuple[str, tuple[float, ...]], ...]


class Move(NamedTuple):
    """A change of a model."""

    terms: tuple[Term, ...]  # after the change
    added: tuple[Candidate, ...]
    left: Array  # expected held-out sum of squares of each block, shape (B,)
    seen: "Look"  # all candidates of the step that proposed it

    @property
    def unnamed(self) -> bool:
        """Whether an unnamed dependence is added."""
        return any(c.unnamed for c in self.added)

    @property
    def kind(self) -> Kind:
        """What it shares with changes to the same effects from other starting shapes; waves of
        other lengths are other effects."""
        return tuple((t.name, t.free_shape if t.effect.is_wave else ()) for t in self.terms)


class Looked(NamedTuple):
    """The best shape of one kind of candidate."""

    candidate: Candidate
    left: Array  # sum of squares of each block, with the shape chosen without its fold, shape (B,)
    p_value: float  # of no effect, over the whole family of candidates and shapes
    # how often it is the best effect on random halves of the data; 0 for unnamed dependences, which
    # adapt to the data
    frequency: float

    @property
    def name(self) -> str:
        """Name of the effect or of the quantity."""
        return self.candidate.term.name


class Look(NamedTuple):
    """All candidates for a fit, best first."""

    rows: tuple[Looked, ...]
    without: Array  # sum of squares of each block without a candidate, shape (B,)
    chance: float  # score that the best of the family exceeds by chance in one case of twenty

    def gain(self, row: Looked | Move) -> float:
        """Fraction of the held-out sum of squares that a candidate, or a change, removes."""
        total = float(self.without.sum())
        return 1.0 - float(row.left.sum()) / total if total > 0.0 else 0.0

    def holds(self, term: Term) -> bool:
        """Whether a term's kind was tried."""
        return any(kind_of(r.candidate.term) == kind_of(term) for r in self.rows)

    def find(self, term: Term) -> Looked:
        """The row of a term's kind."""
        return next(r for r in self.rows if kind_of(r.candidate.term) == kind_of(term))


def look(
    fitted: Fit, blocks: Blocks, candidates: Sequence[Candidate], rng: np.random.Generator
) -> tuple[Look, Screen]:
    """Add every kind of candidate to a fit, with evidence."""
    found = screen(fitted, blocks, candidates)
    without, _ = found.held_out(found.terms)
    kinds: dict[tuple[str, str], list[int]] = {}
    for i, candidate in enumerate(candidates):
        kinds.setdefault(kind_of(candidate.term), []).append(i)
    found_p, chance = p_values(found, [c.among for c in candidates], rng)
    named = {kind: at for kind, at in kinds.items() if not candidates[at[0]].unnamed}
    frequencies = dict(zip(named, _frequencies(found, list(named.values()), rng), strict=True))

    def held_out(i: int) -> tuple[Array, Array]:
        return found.held_out([*found.terms, found.candidates[i]])

    with side_by_side() as each:
        tests = list(each(held_out, range(len(candidates))))
    rows = []
    for kind, members in kinds.items():
        tried = [tests[i] for i in members]
        squares = np.array([s for s, _ in tried])
        chosen = first_least(np.array([t for _, t in tried]))
        best = members[int(first_least(squares.sum(axis=1)[:, None])[0])]
        left = squares[chosen, np.arange(squares.shape[1])]
        p_value = float(min(found_p[i] for i in members))
        rows.append(Looked(candidates[best], left, p_value, frequencies.get(kind, 0.0)))
    ordered = in_order(rows, lambda r: float(r.left.sum()))
    return Look(tuple(ordered), without, chance), found


def _frequencies(
    found: Screen, kinds: Sequence[Sequence[int]], rng: np.random.Generator
) -> list[float]:
    """Fraction of random halves of the blocks on which each kind explains most."""
    if not kinds:
        return []
    whole = np.ones((1, found.blocks.count))
    half_of_blocks = halves(found.blocks.count, rng)

    def most(parts: Array, members: Sequence[int]) -> Array:
        sizes = [found.worth(parts, found.candidates[i]) for i in members]
        return np.asarray(np.max(sizes, axis=0))

    sizes = [float(most(whole, members)[0]) for members in kinds]
    # the ten that explain most of all data
    leading = in_order(range(len(kinds)), lambda k: max(sizes) - sizes[k])[:10]
    explained = np.array([most(half_of_blocks, kinds[k]) for k in leading])
    best = explained.max(axis=0)
    won = np.zeros(len(kinds))
    # kinds that are one in all but name are best together
    won[leading] = np.mean(explained >= best - EQUAL * np.abs(best), axis=1)
    return [float(x) for x in won]


def promising(
    fitted: Fit, seen: Look, screened: Screen, candidates: Sequence[Candidate]
) -> list[Move]:
    """The most promising changes of a model of each sort, to be refitted."""
    own = fitted.effects
    place = {id(c): at for c, at in zip(candidates, screened.candidates, strict=True)}
    named = [r.candidate for r in seen.rows if not r.candidate.unnamed]
    unnamed = [r.candidate for r in seen.rows if r.candidate.unnamed]

    def added(some: Sequence[Candidate]) -> list[Move]:
        return [Move((*own, c.term), (c,), seen.find(c.term).left, seen) for c in some]

    def move(terms: tuple[Term, ...], rest: Sequence[Columns], *candidates: Candidate) -> Move:
        left, _ = screened.held_out([*rest, *(place[id(c)] for c in candidates)])
        return Move(terms, candidates, left, seen)

    pairs = [
        move((*own, a.term, b.term), screened.terms, a, b)
        for a, b in itertools.combinations(named[:8], 2)
    ]
    exchanges = [
        move(in_place(own, i, c.term), [*screened.terms[:i], *screened.terms[i + 1 :]], c)
        for i, term in enumerate(own)
        for c in named
        if c.term.name != term.name
    ]
    sorts = (
        (added(named), LEADERS),
        (added(unnamed), ALTERNATIVES),
        (pairs, ALTERNATIVES),
        (exchanges, ALTERNATIVES),
    )
    return [
        m for found, most in sorts for m in in_order(found, lambda m: float(m.left.sum()))[:most]
    ]
