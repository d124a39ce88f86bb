"""Why each effect of a set is named: its gain, chance, how often it is chosen, and its rivals.

All of it is of the effect in its place: beside the other effects of its set, with the columns,
weights and folds that decided.
"""

from typing import NamedTuple

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.chance import FLIPS, over_family, surprise
from frictionjoint.diagnose.library import Candidate as Tested
from frictionjoint.diagnose.moves import Look, Looked
from frictionjoint.identify.blocks import halves
from frictionjoint.identify.terms import EffectTerm
from linear_search.columns import Candidate, Column, Models, causes, is_cause
from linear_search.score import held_out_of
from linear_search.sets import Set, Sets

# shapes of an effect among those that chance may choose from; lines of a spectrum that a wave is
# the strongest of
_SHAPES, _LINES = 6, 1000.0
_SINGULAR = 1e-9


class Member(NamedTuple):
    """An effect of a set, with all candidates in its place.

    Attributes:
        gain: part of the squares left without it that it takes away, held out.
    """

    candidate: Candidate
    look: Look
    row: Looked
    gain: float


def evidence(sets: Sets, chosen: Set, seed: int) -> list[Member]:
    """Of each effect of a set, in the order of what they explain."""
    found = []
    for candidate in causes(chosen.models):
        look = looked(sets, chosen, candidate, seed)
        row = next(r for r in look.rows if r.name == candidate.name)
        gain = sets.gain(sets.without(chosen, candidate), chosen).part
        found.append(Member(candidate, look, row, gain))
    return sorted(found, key=lambda m: -m.gain)


def looked(sets: Sets, chosen: Set, member: Candidate | None, seed: int) -> Look:
    """All candidates in the place of one effect of a set, or beside all of it, best first."""
    rest = tuple(c for c in chosen.models if c is not member)
    family = _family(sets, rest, member)
    own = sets.experiment
    rng = np.random.default_rng(seed)
    signs = rng.choice([-1.0, 1.0], size=(FLIPS, len(own.blocks.edges)))
    parts = halves(len(own.blocks.edges), rng)
    columns = [sets.columns.of((*rest, c))[-1] for c in family]
    products = [Products.of(sets, rest, x, _lines(c)) for c, x in zip(family, columns, strict=True)]
    log = own.blocks.log[own.blocks.edges]
    surprises = np.array([p.surprise(signs, log) for p in products])
    p_values = over_family(surprises)
    chance = float(np.quantile(surprises[:, 1:].max(axis=0), 0.95))

    names = list(dict.fromkeys(c.name for c in family))
    worth = {name: np.full(len(parts), -np.inf) for name in names}
    for candidate, p in zip(family, products, strict=True):
        worth[candidate.name] = np.maximum(worth[candidate.name], p.worth(parts))
    first = np.argmax([worth[name] for name in names], axis=0)
    won = np.bincount(first, minlength=len(names)) / len(parts)
    rows = []
    for k, name in enumerate(names):
        at = [i for i, c in enumerate(family) if c.name == name]
        squares = [sets.score.held_out((*rest, family[i])) for i in at]
        best = min(range(len(at)), key=lambda i: float(squares[i].sum()))
        candidate = family[at[best]]
        p_value = float(min(p_values[i] for i in at))
        tested = Tested(candidate, columns[at[best]].torque)
        rows.append(Looked(tested, squares[best], p_value, float(won[k])))
    without = sets.score.held_out(rest)
    rows.sort(key=lambda r: float(r.left.sum()))
    return Look(tuple(rows), without, chance)


def _family(sets: Sets, rest: Models, member: Candidate | None) -> list[Candidate]:
    """Effects that may take a place: shapes of the grid, those refined beside the rest, itself."""
    found = [c for group in sets.by_name.values() for c in group[:_SHAPES] if is_cause(c)]
    for known in sets.known.values():
        others = [c for c in known.models if c.name not in {r.name for r in rest}]
        if len(known.models) == len(rest) + 1 and len(others) == 1 and is_cause(others[0]):
            found.append(others[0])
    if member is not None:
        found.insert(0, member)
    taken = {c.name for c in rest} - {"position-periodic"}
    return [c for c in found if c.name not in taken]


def _lines(candidate: Candidate) -> float:
    """Lines of a spectrum that a candidate is the strongest of."""
    wave = isinstance(candidate, EffectTerm) and candidate.effect.proposed_by == "spectrum"
    return _LINES if wave else 1.0


class Products(NamedTuple):
    """Of a candidate's columns beside a set, and of these with what the set leaves, by block.

    Attributes:
        gram: shape (B, k, k). moment: shape (B, k). elsewhere: coefficients of each block, fitted
            to other folds, shape (B, k). total: of all blocks, with the prior's rows, (k, k).
        low, high: range of the coefficients. lines: of a spectrum that it is the strongest of.
    """

    gram: Array
    moment: Array
    elsewhere: Array
    total: Array
    low: Array
    high: Array
    lines: float

    @classmethod
    def of(cls, sets: Sets, rest: Models, column: Column, lines: float = 1.0) -> "Products":
        """Of some columns beside a set."""
        own, blocks = sets.experiment, sets.experiment.blocks
        n = len(own.target)
        x, r = column.out, own.residual
        if rest:
            Q, _ = np.linalg.qr(sets.score.stacked(rest)[0])
            x = x - Q @ (Q.T @ x)
            r = sets.score.solve(rest).left
        length = np.linalg.norm(x, axis=0)
        length[length == 0.0] = 1.0
        x = x / length
        gram = blocks.sums(x[:n, :, None] * x[:n, None, :])
        moment = blocks.sums(x[:n] * r[:n, None])
        low, high = column.low * length, column.high * length
        total = x.T @ x
        elsewhere = held_out_of(gram, moment, total, x.T @ r, blocks.fold, low, high)
        return cls(gram, moment, elsewhere, total, low, high, lines)

    @property
    def explained(self) -> Array:
        """Squares of each block that coefficients fitted to other folds explain, shape (B,)."""
        z = self.elsewhere
        quadratic = np.einsum("bij,bi,bj->b", self.gram, z, z)
        return np.asarray(2.0 * np.sum(self.moment * z, 1) - quadratic)

    def surprise(self, signs: Array, log: Array) -> Array:
        """Of the candidate, and by chance, see `chance.surprise`; shape (1 + flips,)."""
        ranges = self.low, self.high
        found = surprise(self.gram, self.moment, self.elsewhere, self.total, ranges, signs, log)
        return found - np.log(self.lines)

    def worth(self, parts: Array) -> Array:
        """Squares that it explains of some of the blocks, shape (parts,)."""
        grams = np.tensordot(parts, self.gram, 1)
        moments = parts @ self.moment
        grams += _SINGULAR * np.eye(self.moment.shape[1])
        z = np.linalg.solve(grams, moments[..., None])[..., 0]
        z = np.clip(z, self.low, self.high)
        return np.asarray(2.0 * np.sum(moments * z, 1) - np.einsum("pij,pi,pj->p", grams, z, z))
