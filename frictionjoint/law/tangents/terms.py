"""Sums of tangents, as source.

The tangent of an expression is a linear combination of the tangents of its operands. Factors of one
and double signs are left to the compiler.
"""

import ast
from typing import Any

# factor of each tangent, by the source text of the tangent
Terms = dict[str, ast.expr]


def expression(source: str) -> Any:
    """Syntax tree of an expression's source."""
    return ast.parse(source, mode="eval").body


def text(node: ast.expr) -> str:
    """Source of a syntax tree."""
    return ast.unparse(ast.fix_missing_locations(node))


def alone(tangent: str) -> Terms:
    """The sum that consists of one tangent with factor 1."""
    return {tangent: ast.Constant(1.0)}


def times(terms: Terms, factor: ast.expr) -> Terms:
    """A sum with every factor multiplied by another factor."""
    return {tangent: ast.BinOp(factor, ast.Mult(), x) for tangent, x in terms.items()}


def opposite(terms: Terms) -> Terms:
    """A sum with the sign of every factor reversed."""
    return {tangent: ast.UnaryOp(ast.USub(), x) for tangent, x in terms.items()}


def added(a: Terms, b: Terms) -> Terms:
    """The total of two sums; the factors of a tangent that occurs in both are added."""
    both = dict(a)
    for tangent, x in b.items():
        both[tangent] = ast.BinOp(both[tangent], ast.Add(), x) if tangent in both else x
    return both


def combined(terms: Terms) -> str:
    """Source of a sum, as calls of functions in `frictionjoint.law.tangents.direction`."""
    if not terms:
        return "ZERO"
    factors = list(terms.items())
    if len(factors) == 1:
        ((tangent, x),) = factors
        return f"scaled({text(x)}, {tangent})"
    if len(factors) == 2:
        return f"sum2({', '.join(f'{text(x)}, {tangent}' for tangent, x in factors)})"
    first = 4 if len(factors) > 4 else 2
    parts = (combined(dict(some)) for some in (factors[:first], factors[first:]))
    return f"sum2(1.0, {', 1.0, '.join(parts)})"
