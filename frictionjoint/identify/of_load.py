"""Effects that change what the load asks of the motor: they have no size of their own.

The torque that a link asks for through a gap is that of the whole link, or there is no gap. Left
free, the coefficient of its column says how well the link can be followed: where impacts scatter,
least squares take less of the column, and a model with a part of a link would be no joint at all.
"""

from frictionjoint.arrays import Array
from frictionjoint.identify.layout import Layout
from frictionjoint.identify.terms import EffectTerm


def with_load(X: Array, layout: Layout) -> Array:
    """Columns with those of such effects where the load is: in its column, if the gain is unknown.

    Args:
        X: by the parameters of the layout, or its linear ones, shape (n, p).
    Returns:
        `X` itself where there are none; else theirs are zero, shape (n, p).
    """
    at = _own(layout)
    if not at:
        return X
    found = X.copy()
    if "load" in layout.base:
        found[:, layout.base.index("load")] += X[:, at].sum(axis=1)
    found[:, at] = 0.0
    return found


def less_load(X: Array, y: Array, layout: Layout) -> Array:
    """A target less what such effects make of a load that is known, shape (n,)."""
    at = _own(layout)
    return y - X[:, at].sum(axis=1) if at and "load" not in layout.base else y


def with_sizes(beta: Array, layout: Layout) -> Array:
    """Coefficients with those of such effects: as much as the load's, shape (k,)."""
    at = _own(layout)
    if at:
        beta = beta.copy()
        beta[at] = beta[layout.base.index("load")] if "load" in layout.base else 1.0
    return beta


def _own(layout: Layout) -> list[int]:
    """Places of their coefficients."""
    return [
        k
        for i, term in enumerate(layout.terms)
        if isinstance(term, EffectTerm) and term.effect.of_load
        for k in range(layout.coefficients(i).start, layout.coefficients(i).stop)
    ]
