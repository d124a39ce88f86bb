"""What is left depends on: measured quantities beside the named effects, without a physical name.

An unnamed dependence is added to named effects and takes the place of none.
"""

from typing import NamedTuple

import numpy as np

from frictionjoint.diagnose.chance import FLIPS, over_family
from frictionjoint.diagnose.columns import columns_of
from frictionjoint.diagnose.library import unnamed_terms
from frictionjoint.diagnose.spectrum import wave_terms
from frictionjoint.identify.design import term_bounds
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.instruments import ExcessTerm
from frictionjoint.identify.terms import Term
from linear_search.columns import Column
from linear_search.decisions import APART, LEAST_TORQUE, NEEDED_PART, SIGNIFICANCE
from linear_search.evidence import Products
from linear_search.score import gain
from linear_search.sets import Set, Sets


class Dependence(NamedTuple):
    """A quantity that what is left depends on.

    Attributes:
        term: its curve. coefficients: of its columns, N m. share: of the squares left.
    """

    term: Term
    coefficients: tuple[float, ...]
    share: float


def dependences(sets: Sets, chosen: Set, fitted: Fit, seed: int) -> list[Dependence]:
    """Quantities that explain what a set leaves, the best and those not apart from it.

    Args:
        fitted: the parametric fit with these effects, of which some curves need the levels.
    """
    own = sets.experiment
    rng = np.random.default_rng(seed)
    signs = rng.choice([-1.0, 1.0], size=(FLIPS, len(own.blocks.edges)))
    log = own.blocks.log[own.blocks.edges]
    before = sets.score.held_out(chosen.models)
    rows, surprises = [], []
    in_time, _ = wave_terms(own.prepared, fitted)
    for term in [*unnamed_terms(own.prepared, fitted, own.signals), *in_time]:
        column = _column(sets, term)
        if column is None:
            continue
        products = Products.of(sets, chosen.models, column)
        surprises.append(products.surprise(signs, log))
        after = before - products.explained
        rows.append((term, products, after))
    if not rows:
        return []
    p_values = over_family(np.array(surprises))
    good = []
    for (term, products, after), p in zip(rows, p_values, strict=True):
        found = gain(before, after, own.friction)
        needed = found.part > NEEDED_PART and found.errors > 1.0 and found.torque > LEAST_TORQUE
        if needed and p <= SIGNIFICANCE:
            good.append((float(after.sum()), term, products, after, found.part))
    good.sort(key=lambda row: row[0])
    said: dict[str, Dependence] = {}
    for _, term, products, after, part in good:
        apart = gain(after, good[0][3], own.friction)
        if apart.errors > 1.0 and apart.part > APART:
            continue
        z = np.linalg.lstsq(products.total, products.moment.sum(axis=0), rcond=1e-9)[0]
        said.setdefault(term.name, Dependence(term, tuple(z.tolist()), part))
    return list(said.values())


def _column(sets: Sets, term: Term) -> Column | None:
    own = sets.experiment
    x = columns_of(own.prepared, own.signals, term)
    if isinstance(term, ExcessTerm) or not np.all(np.isfinite(x)) or not np.any(x):
        return None
    low, high = np.array(term_bounds(own.prepared, term), dtype=float).reshape(-1, 2).T
    out = own.out(x)
    whole = float(np.linalg.norm(x * own.weight[:, None]))
    return Column(x, out, float(np.linalg.norm(out)) / whole, low, high)
