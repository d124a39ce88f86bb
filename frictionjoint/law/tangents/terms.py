"""Sums of tangents, as source.

The tangent of an expression is a linear combination of the tangents of its operands. Factors of one
and double signs are left to the compiler.
"""

# source of the factor of each tangent, by the source of the tangent
Terms = dict[str, str]


def times(terms: Terms, factor: str) -> Terms:
    """A sum with every factor multiplied by another factor."""
    return {tangent: f"({factor}) * ({x})" for tangent, x in terms.items()}


def opposite(terms: Terms) -> Terms:
    """A sum with the sign of every factor reversed."""
    return {tangent: f"-({x})" for tangent, x in terms.items()}


def added(a: Terms, b: Terms) -> Terms:
    """The total of two sums; the factors of a tangent that occurs in both are added."""
    both = {tangent: f"({a[tangent]}) + ({x})" if tangent in a else x for tangent, x in b.items()}
    return a | both


def combined(terms: Terms) -> str:
    """Source of a sum, as calls of functions in `frictionjoint.law.tangents.direction`."""
    if not terms:
        return "ZERO"
    factors = list(terms.items())
    if len(factors) == 1:
        ((tangent, x),) = factors
        return f"scaled({x}, {tangent})"
    if len(factors) == 2:
        return f"sum2({', '.join(f'{x}, {tangent}' for tangent, x in factors)})"
    first = 4 if len(factors) > 4 else 2
    parts = (combined(dict(some)) for some in (factors[:first], factors[first:]))
    return f"sum2(1.0, {', 1.0, '.join(parts)})"
