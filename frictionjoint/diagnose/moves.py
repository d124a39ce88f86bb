"""Changes of a model that are tried: add, drop, exchange, add two; all are screened, few refitted."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.blocks import Blocks
from frictionjoint.diagnose.gram import FLIPS, Columns, Screen, explained, screen
from frictionjoint.diagnose.library import Candidate
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.smooth import SmoothTerm
from frictionjoint.identify.terms import Term

# of each sort of move, how many are refitted
_ADDED, _UNNAMED, _PAIRS, _EXCHANGED = 4, 2, 1, 2
# named candidates of which pairs are looked at
_IN_PAIRS = 8


class Move(NamedTuple):
    """A change of a model.

    Attributes:
        terms: after it. added: candidates that come in. left: squares of each block that the
            screen expects, held out, shape (B,).
    """

    terms: tuple[Term, ...]
    added: tuple[Candidate, ...]
    left: Array

    @property
    def unnamed(self) -> bool:
        """Whether something without a name comes in."""
        return any(c.unnamed for c in self.added)


class Looked(NamedTuple):
    """A candidate of one kind, the best of its shapes.

    Attributes:
        left: squares of each block, the shape chosen without the block's fold, shape (B,).
        p_value: of no effect, over the whole family of candidates and shapes.
        frequency: how often it is the best on half of the data.
    """

    candidate: Candidate
    left: Array
    p_value: float
    frequency: float

    @property
    def name(self) -> str:
        """Of the effect, or of the quantity."""
        return self.candidate.term.name


class Look(NamedTuple):
    """All candidates against a fit: best first, and what the fit leaves without any, shape (B,)."""

    rows: tuple[Looked, ...]
    without: Array

    def gain(self, row: Looked) -> float:
        """Fraction of the held-out squares that a candidate takes away."""
        total = float(self.without.sum())
        return 1.0 - float(row.left.sum()) / total if total > 0.0 else 0.0

    def find(self, candidate: Candidate) -> Looked:
        """The row of a candidate's kind."""
        return next(r for r in self.rows if r.candidate.kind == candidate.kind)


def look(
    fitted: Fit, blocks: Blocks, candidates: Sequence[Candidate], rng: np.random.Generator
) -> tuple[Look, Screen]:
    """Every kind of candidate added to a fit, and how sure that is."""
    found = screen(fitted, blocks, candidates)
    without, _ = found.held_out(found.terms)
    kinds: dict[tuple[str, str], list[int]] = {}
    for i, candidate in enumerate(candidates):
        kinds.setdefault(candidate.kind, []).append(i)
    p_values = _p_values(found, rng)
    frequencies = _frequencies(found, list(kinds.values()), rng)
    rows = []
    for members, frequency in zip(kinds.values(), frequencies, strict=True):
        tried = [found.held_out([*found.terms, found.candidates[i]]) for i in members]
        squares = np.array([s for s, _ in tried])
        chosen = np.argmin(np.array([t for _, t in tried]), axis=0)
        best = members[int(np.argmin(squares.sum(axis=1)))]
        left = squares[chosen, np.arange(squares.shape[1])]
        p_value = float(min(p_values[i] for i in members))
        rows.append(Looked(candidates[best], left, p_value, frequency))
    rows.sort(key=lambda r: float(r.left.sum()))
    return Look(tuple(rows), without), found


def _p_values(found: Screen, rng: np.random.Generator) -> Array:
    """Of each candidate, the largest surprise of the family under flipped signs as its null.

    Scores of many coefficients and of single ones are put on one scale by the chi-square tail each
    would have (Westfall and Young 1993, with an approximate marginal: it weighs the candidates
    against each other, the flips alone make the p-value).
    """
    if not found.candidates:
        return np.zeros(0)
    count = found.blocks.count
    signs = np.vstack([np.ones(count), rng.choice([-1.0, 1.0], size=(FLIPS, count))])
    surprises = np.array([found.surprises(signs, at) for at in found.candidates])
    null = surprises[:, 1:].max(axis=0)
    return np.array([(1 + int(np.sum(null >= x))) / (FLIPS + 1) for x in surprises[:, 0]])


def _frequencies(
    found: Screen, kinds: Sequence[Sequence[int]], rng: np.random.Generator
) -> list[float]:
    """How often each kind explains most of a half of the blocks (Shah and Samworth 2013)."""
    halves = found.halves(rng)
    won = np.zeros(len(kinds))
    best = [max((explained(G, found.candidates[i]) for i in k), default=0.0) for G in halves[:1] for k in kinds]
    short = np.argsort(best)[::-1][:10]
    for G in halves:
        sizes = [max(explained(G, found.candidates[i]) for i in kinds[k]) for k in short]
        if sizes:
            won[short[int(np.argmax(sizes))]] += 1.0
    return list(won / max(1, len(halves)))


def moves(fitted: Fit, found: Look, screened: Screen, candidates: Sequence[Candidate]) -> list[Move]:
    """The most promising changes of a model, to be refitted."""
    place = {id(c): i for i, c in enumerate(candidates)}
    own = fitted.effects
    named = [r for r in found.rows if not r.candidate.unnamed]
    unnamed = [r for r in found.rows if r.candidate.unnamed]
    out = [Move((*own, r.candidate.term), (r.candidate,), r.left) for r in named[:_ADDED]]
    out += [Move((*own, r.candidate.term), (r.candidate,), r.left) for r in unnamed[:_UNNAMED]]
    pairs = []
    for a, b in itertools.combinations([r.candidate for r in named[:_IN_PAIRS]], 2):
        both = [screened.candidates[place[id(c)]] for c in (a, b)]
        left, _ = screened.held_out([*screened.terms, *both])
        pairs.append(Move((*own, a.term, b.term), (a, b), left))
    pairs.sort(key=lambda m: float(m.left.sum()))
    out += pairs[:_PAIRS]
    exchanges = []
    for i in range(len(own)):
        rest: list[Columns] = [at for k, at in enumerate(screened.terms) if k != i]
        for r in named:
            if r.name == own[i].name:
                continue
            left, _ = screened.held_out([*rest, screened.candidates[place[id(r.candidate)]]])
            terms = (*own[:i], r.candidate.term, *own[i + 1 :])
            exchanges.append(Move(terms, (r.candidate,), left))
    exchanges.sort(key=lambda m: float(m.left.sum()))
    return out + exchanges[:_EXCHANGED]


def is_unnamed(term: Term) -> bool:
    """Whether a term is a dependence without a physical name."""
    return isinstance(term, SmoothTerm)
