"""Effects whose coefficient is tied to the load coefficient.

A gap transmits the torque of the whole link. A free coefficient would measure how well the motion
of the link can be predicted: if impacts scatter, least squares reduce the coefficient, and a model
with a part of a link has no physical meaning.
"""

from frictionjoint.arrays import Array
from frictionjoint.identify.layout import Layout


def with_load(X: Array, layout: Layout) -> Array:
    """Columns of effects tied to the load, added to the load's column if the gain is unknown.

    Args:
        X: by the parameters of the layout, or by its linear ones, shape (n, p).
    Returns:
        `X` itself if there are no such effects; else with zeros in their columns, shape (n, p).
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
    """A target minus the effects that are tied to a known load, shape (n,)."""
    at = _own(layout)
    return y - X[:, at].sum(axis=1) if at and "load" not in layout.base else y


def with_sizes(beta: Array, layout: Layout) -> Array:
    """Coefficients, with those of effects tied to the load set from the load's, shape (k,)."""
    at = _own(layout)
    if at:
        beta = beta.copy()
        beta[at] = beta[layout.base.index("load")] if "load" in layout.base else 1.0
    return beta


def _own(layout: Layout) -> list[int]:
    """Indices of the coefficients of effects tied to the load."""
    tied = (i for i, term in enumerate(layout.terms) if term.effect.of_load)
    return [k for i in tied for k in range(layout.linear.stop)[layout.coefficients(i)]]
