"""Sliding distance between two ratios r of the transition equation, by Gauss-Legendre panels.

Over a stretch where Fd is linear (slope K) and D = S - Fb is constant, ds = K dx / D obeys
dr/ds = 1 - sgn(r) |r|**n. All functions here are in r and s, without units.
"""

import math

import numpy as np
from scipy.optimize import brentq

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_LEAST_GAP = 1e-15  # closer to r = 1 than this counts as arrived


def _panels(f, edges: np.ndarray) -> float:
    half = np.diff(edges) / 2
    x = (edges[:-1] + half)[:, None] + half[:, None] * _NODES
    return float(np.sum(half[:, None] * _WEIGHTS * f(x)))


def _below_zero(r0: float, r1: float, n: float) -> float:
    inner = -np.exp(np.arange(-36, 37, 2) / n)
    cuts = inner[(inner > r0) & (inner < r1)]
    edges = np.sort(np.concatenate(([r0, r1], cuts)))
    with np.errstate(over="ignore"):
        return _panels(lambda r: 1 / (1 + np.abs(r) ** n), edges)


def _gap(gap0: float, gap1: float, n: float, side: float) -> float:
    """From |1 - r| = gap0 down to gap1; `side` -1 below r = 1, +1 above. In w = -log(gap)."""
    w0, w1 = -math.log(gap0), -math.log(max(gap1, _LEAST_GAP))
    if w1 <= w0:
        return 0.0

    def f(w):
        u = np.exp(-w)
        with np.errstate(over="ignore", divide="ignore"):
            return u / np.abs(np.expm1(n * np.log1p(side * u)))

    return _panels(f, np.linspace(w0, w1, 2 + int(2 * (w1 - w0))))


def span(r0: float, r1: float, n: float) -> float:
    """s from r0 to r1; r1 lies between r0 and 1 (inclusive)."""
    if r0 == r1:
        return 0.0
    if r0 > 1:
        return _gap(r0 - 1, r1 - 1, n, 1.0)
    s = 0.0
    if r0 < 0:
        s += _below_zero(r0, min(r1, 0.0), n)
        r0 = 0.0
    return s + (_gap(1 - r0, 1 - r1, n, -1.0) if r1 > r0 else 0.0)


def advance(r0: float, s: float, n: float) -> float:
    """r after s from r0: the inverse of `span`, r0 != 1 is followed towards 1."""
    if s <= 0 or abs(1 - r0) <= _LEAST_GAP:
        return r0
    if span(r0, 1.0, n) <= s:
        return 1.0
    if r0 < 0:
        to_zero = span(r0, 0.0, n)
        if s <= to_zero:
            return brentq(lambda r: span(r0, r, n) - s, r0, 0.0, xtol=1e-16, rtol=1e-14)
        r0, s = 0.0, s - to_zero
    side = 1.0 if r0 > 1 else -1.0
    w0, w1 = -math.log(abs(1 - r0)), -math.log(_LEAST_GAP)
    w = brentq(lambda w: _gap(abs(1 - r0), math.exp(-w), n, side) - s, w0, w1, xtol=1e-13)
    return 1 + side * math.exp(-w)
